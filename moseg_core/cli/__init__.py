"""The command ``moseg``: reading arguments, printing, exit codes. Nothing imports it.

Data goes to stdout; messages, warnings and progress to stderr. What a command needs is imported
when it runs, so that ``moseg --help`` starts at once.
"""

from moseg_core.cli.entry import main

__all__ = ["main"]
