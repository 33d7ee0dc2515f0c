"""The language in which users say what they want: ``3*narrow(handle) + convex_parts``.

::

    expression = ["+" | "-"] term { ("+" | "-") term }
    term       = [number "*"] name [ "(" [ argument { "," argument } ] ")" ] [ "@" word ]
    name       = word | word ":" word
    argument   = label | glob | key "=" number

Text goes through :mod:`~moseg_core.language.tokens` (characters to tokens with positions) and
:mod:`~moseg_core.language.parser` (tokens to :mod:`~moseg_core.language.terms`), and back again
with ``str``. What the names mean is decided by :mod:`moseg_core.problem.problem`.
"""

from moseg_core.language.parser import parse, parse_call, parse_constraint
from moseg_core.language.terms import Argument, Expression, Term

__all__ = ["Argument", "Expression", "Term", "parse", "parse_call", "parse_constraint"]
