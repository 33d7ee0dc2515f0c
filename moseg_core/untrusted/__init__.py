"""What is not to be trusted: a file before it is read, and a text before it is shown.

:mod:`~moseg_core.untrusted.regular_file` reads no device and no pipe, and not more than makes
sense. :mod:`~moseg_core.untrusted.terminal` shows the characters of a text that a terminal would
obey. Both stand below all else, since every message and every reader needs them; what the bytes of
a format may hold is the business of its reader.
"""
