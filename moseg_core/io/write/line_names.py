"""Names of parts as they can stand on a line of text, or in an attribute of XML.

Labels are words, but whoever makes a result in Python may call a part anything: two lines, a NUL,
half of a surrogate pair, nothing. Here such names become ones that every text format can hold, and
that stay apart. Names of files are another matter: letters that no path may have are harmless here.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence

#: Controls, halves of pairs, and what ends a line or paragraph (Unicode general categories).
_NOT_ON_A_LINE = frozenset(("Cc", "Cs", "Zl", "Zp"))
_NONCHARACTERS = frozenset("\ufffe\uffff")  # which XML 1.0 forbids


def line_names(names: Sequence[str], *, also: Iterable[str] = ()) -> list[str]:
    r"""One printable name for each, on one line, no two alike.

    Parameters
    ----------
    names : sequence of str
        All different.
    also : iterable of str
        Characters that the format cannot hold in a name.

    Returns
    -------
    list of str
        Names that are good stay as they are. In others each character that cannot stand there is
        "_", and where that makes two alike the later ones are numbered.

    Examples
    --------
    >>> line_names(["left arm", "a\nb", "a_b", ""])
    ['left arm', 'a_b_2', 'a_b', 'part']
    """
    wrong = frozenset(also) | _NONCHARACTERS
    good = {name for name in names if name and _plain(name, wrong) == name}
    taken, found = set(good), []
    for name in names:
        new = name
        if name not in good:
            plain = _plain(name, wrong) or "part"
            number, new = 1, plain
            while new in taken:
                number += 1
                new = f"{plain}_{number}"
            taken.add(new)
        found.append(new)
    return found


def _plain(name: str, wrong: frozenset[str]) -> str:
    return "".join(
        "_" if letter in wrong or unicodedata.category(letter) in _NOT_ON_A_LINE else letter
        for letter in name.strip()
    )
