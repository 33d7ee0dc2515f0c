"""A TOML document as a table, of which nothing is too large, too deep or too long.

``tomllib`` of the standard library reads a document recursively, and takes time that grows with the
square of the number of points in a key. A recipe needs neither, so a text is looked at before it is
parsed: its strings and comments taken away, what is left are keys, numbers and brackets. Behind the
parser all values are looked at once more, so that nobody who is given the table can be surprised:
whole numbers have 64 bits, as the specification says (TOML v1.0, "Integer"), and tables in tables
end somewhere.
"""

from __future__ import annotations

import itertools
import re
import tomllib
from typing import Any

from moseg_core.errors import UsageError

MOST_BYTES = 2**20
"""A recipe is a page of text; of a larger file nothing is read."""

_DEEPEST = 64
"""Tables and lists in each other, and words with points between them in a key."""

_INTEGERS = range(-(2**63), 2**63)
# Strings of four kinds, which may not end, and comments.
_QUIET = re.compile(
    r'"""(?:[^"\\]|\\.|"(?!""))*(?:"""|\Z)'
    r"|'''(?:[^']|'(?!''))*(?:'''|\Z)"
    r'|"[^"\\\n]*(?:\\.[^"\\\n]*)*"?'
    r"|'[^'\n]*'?"
    r"|\#[^\n]*",
    re.DOTALL,
)
_BETWEEN = re.compile(r"[=,\[\]{}\n]")


def read_table(text: str, name: str) -> dict[str, Any]:
    r"""The table that a TOML text holds.

    Parameters
    ----------
    text : str
    name : str
        Of the recipe, for messages.

    Raises
    ------
    UsageError
        It is not TOML, too long or too deep, or has a number that is too large.

    Examples
    --------
    >>> read_table('labels = ["a"]\nrestarts = 3', "mine")
    {'labels': ['a'], 'restarts': 3}
    >>> read_table("labels = " + 2000 * "[" + 2000 * "]", "mine")
    Traceback (most recent call last):
        ...
    moseg_core.errors.UsageError: recipe 'mine': lists and tables are nested more than 64 deep
    """
    if len(text) > MOST_BYTES:
        raise UsageError(f"recipe '{name}' has more than {MOST_BYTES} characters, the most allowed")
    _check_text(text, name)
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"recipe '{name}' is not valid TOML: {error}") from error
    except (ValueError, OverflowError) as error:  # a number of thousands of digits, a year 0
        raise UsageError(
            f"recipe '{name}' has a value that is too large or no value at all: {error}"
        ) from error
    _check_values(table, name)
    return table


def _check_text(text: str, name: str) -> None:
    """Refuse what would take the parser too deep."""
    bare = _QUIET.sub("x", text)
    steps = (1 if c in "[{" else -1 for c in bare if c in "[]{}")
    if max(itertools.accumulate(steps), default=0) > _DEEPEST:
        raise _too_deep(name)
    if any(piece.count(".") > _DEEPEST for piece in _BETWEEN.split(bare)):
        raise UsageError(f"recipe '{name}': a key has more than {_DEEPEST} points in it")


def _check_values(table: dict[str, Any], name: str) -> None:
    """Refuse what is nested too deep, and whole numbers that TOML does not know."""
    level: list[object] = [table]
    for _ in range(_DEEPEST + 1):
        below: list[object] = []
        for value in level:
            if isinstance(value, dict):
                below += value.values()
            elif isinstance(value, list):
                below += value
            elif isinstance(value, int) and value not in _INTEGERS:
                raise UsageError(
                    f"recipe '{name}' has a whole number that is too large; they have 64 bits"
                )
        level = below
    if level:
        raise _too_deep(name)


def _too_deep(name: str) -> UsageError:
    return UsageError(f"recipe '{name}': lists and tables are nested more than {_DEEPEST} deep")
