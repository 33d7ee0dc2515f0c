r"""Names of labels as a file has them, made safe to print, draw and write.

In a problem a label is a word of ASCII letters, digits and ``_``, of at most
:data:`~moseg_core.problem.statement.LONGEST_LABEL` characters, and anything else is refused. A file
of labels was written by somebody else, for whom a label may be any text; refusing it would keep
people from their data. So its names are read as they are but for characters that do something
instead of being seen (controls, marks of direction, line breaks, halves of pairs), which are shown
as Python escapes them, ``\x1b``, and for names that nobody could read, of which the middle is left
out. Different names stay different.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

from moseg_core.problem.statement import LONGEST_LABEL
from moseg_core.untrusted.terminal import escaped

# Joiners, without which words of some scripts are spelt wrongly.
_JOINERS = frozenset("\u200c\u200d")


def safe_names(names: Sequence[str]) -> tuple[str, ...]:
    r"""Names of which none does anything, and none is longer than a label may be.

    Parameters
    ----------
    names : sequence of str

    Returns
    -------
    tuple of str
        A good name stays as it is; equal names stay equal, and different ones different.

    Examples
    --------
    >>> safe_names(["upper arm", "\x1b[2Jleg"])
    ('upper arm', '\\x1b[2Jleg')
    >>> len(safe_names([10_000 * "a"])[0])
    200
    """
    safe = {name: name for name in names if _is_good(name)}
    taken = set(safe)
    for name in names:
        if name in safe:
            continue
        plain = _cut("".join(c if _is_seen(c) else escaped(c) for c in _cut(name, 4)), 1)
        new, number = plain, 1
        while new in taken:
            number += 1
            end = f" ({number})"
            new = plain[: LONGEST_LABEL - len(end)] + end
        safe[name] = new
        taken.add(new)
    return tuple(safe[name] for name in names)


def _is_good(name: str) -> bool:
    return len(name) <= LONGEST_LABEL and (name.isprintable() or all(map(_is_seen, name)))


def _is_seen(character: str) -> bool:
    """Whether a character can be seen, or is a blank or what joins others."""
    if character.isprintable() or character in _JOINERS:
        return True
    return unicodedata.category(character) == "Zs"


def _cut(name: str, times: int) -> str:
    """A name of at most so many times the length of a label, the middle left out."""
    most = times * LONGEST_LABEL
    if len(name) <= most:
        return name
    tail = most // 3
    return f"{name[: most - tail - 3]}...{name[-tail:]}"
