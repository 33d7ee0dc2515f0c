r"""The language in which users say what they want: ``3*narrow(handle) + convex_parts``.

There is one grammar, of which every option, recipe and result uses as much as it needs::

    expression = ["+" | "-"] term { ("+" | "-") term }
    term       = [number "*"] call [ "@" word ]
    call       = name [ "(" [ argument { "," argument } ] ")" ]
    name       = word [ ":" word ]
    argument   = label | glob | key "=" value
    value      = ["+" | "-"] number [ ("+-" | "±") number ] | word { "." word } | quoted
    quoted     = '"' { character | '\"' | '\\' } '"'

- A *word*, and so a key, is made of ASCII letters, digits and ``_`` and begins with no digit; a
  *label* may begin with one; a *glob* is a label with ``*`` for any letters.
- Words with other characters stand in quotes: ``order="head,body"``. Without quotes ``true``,
  ``false`` and ``none`` mean themselves, and so do numbers; ``"none"`` and ``"1.5"`` are words.
- Two numbers with ``+-`` or ``±`` between them are a *target*
  (:mod:`~moseg_core.language.target`): a typical value and how far from it is still usual.
- Words with points between them are the path of a table in a table: ``given=looks.leg``. The key
  ``given`` takes parameters from a table (:mod:`~moseg_core.language.table`).
- Labels and globs come first, parameters after them, each key once.

What stands where:

=====================================  ===========  ======================================
text                                   is read by
=====================================  ===========  ======================================
what to minimise                       `parse`      a whole *expression*
a constraint, ``mirror(leg2, leg1)``   `parse_call` a *call* about labels
a component, ``greedy(order=head)``    `parse_call` a *call* with parameters only
=====================================  ===========  ======================================

Whether a parameter takes a number, a word or a target is not a matter of grammar: the component
that it is for declares it (:mod:`moseg_core.components.parameters`).

Text goes through :mod:`~moseg_core.language.tokens` (characters to tokens with positions) and
:mod:`~moseg_core.language.parser` (tokens to :mod:`~moseg_core.language.terms`), and back again
with ``str``: whatever is printed, into messages, results and recipes, reads back as what it was.
What the names mean is decided by :mod:`moseg_core.problem.problem`.
"""

from moseg_core.language.parser import parse, parse_call, parse_target
from moseg_core.language.table import Table
from moseg_core.language.target import Target
from moseg_core.language.terms import Argument, Expression, Term

__all__ = [
    "Argument",
    "Expression",
    "Table",
    "Target",
    "Term",
    "parse",
    "parse_call",
    "parse_target",
]
