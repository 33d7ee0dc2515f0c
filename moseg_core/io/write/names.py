"""Labels as names of files: safe on every system, readable, and all different.

A label is any text that somebody called a part. As a file name it must lead into no other folder,
name no device and show what it is: letters, digits and marks of any script stay, and ``_ - . +``;
blanks become ``_``, everything else a hyphen. So slashes, colons, control characters and those that
turn the direction of writing are gone, and what a shell or XML would read otherwise. Windows keeps
some names for devices, whatever the suffix (Microsoft, "Naming Files, Paths, and Namespaces"), and
tells no capitals from small letters; nor does macOS.

Files per part have such names (:mod:`moseg_core.io.part_files`), and what else stands for a part
in a file that must not be broken by a name.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable

LONGEST = 100
"""Bytes of a name in UTF-8: with a prefix, a suffix and a number it stays below 255."""

#: What stands for a label of which nothing is left.
_NAMELESS = "part"

_KEPT = set("_-.+")
_DEVICES = {
    *("con", "prn", "aux", "nul", "conin", "conout", "clock"),
    *(f"{port}{number}" for port in ("com", "lpt") for number in range(10)),
}


def safe_file_name(label: str) -> str:
    """A label as a file name without a suffix.

    Parameters
    ----------
    label : str
        Any text.

    Returns
    -------
    str
        Not empty, of at most 100 bytes in UTF-8. A safe name is its own.

    Examples
    --------
    >>> safe_file_name("head/ear1"), safe_file_name("upper arm"), safe_file_name("../../x")
    ('head-ear1', 'upper_arm', 'x')
    >>> safe_file_name("con"), safe_file_name("???")
    ('_con', 'part')
    """
    text = unicodedata.normalize("NFC", label.strip())
    kept = "".join(map(_safe_character, text))
    name = _trimmed(re.sub("-{2,}", "-", kept))
    # A device is meant whatever follows the first dot.
    if _folded(name.partition(".")[0]) in _DEVICES:
        name = f"_{name}"
    short = name.encode()[:LONGEST].decode(errors="ignore")
    return _trimmed(short) or _NAMELESS


def safe_file_names(labels: Iterable[str]) -> tuple[str, ...]:
    """Labels as file names, all different, also where capitals are not told from small letters.

    Parameters
    ----------
    labels : iterable of str

    Returns
    -------
    tuple of str
        One for each label. Labels that come to one name get numbers, ``x``, ``x-2``, ``x-3``; who
        is called so already keeps the name.

    Examples
    --------
    >>> safe_file_names(["leg 1", "leg?1", "leg_1", "Leg_1"])
    ('leg_1-2', 'leg-1', 'leg_1', 'Leg_1-3')
    """
    wanted = list(labels)
    safe = [safe_file_name(label) for label in wanted]
    names: dict[int, str] = {}
    taken: set[str] = set()
    for place, name in enumerate(safe):
        if name == wanted[place] and _folded(name) not in taken:
            names[place] = name
            taken.add(_folded(name))
    for place, stem in enumerate(safe):
        if place in names:
            continue
        candidates = (stem, *(f"{stem}-{number}" for number in range(2, len(wanted) + 2)))
        names[place] = next(name for name in candidates if _folded(name) not in taken)
        taken.add(_folded(names[place]))
    return tuple(names[place] for place in range(len(wanted)))


def _safe_character(character: str) -> str:
    if character.isspace():
        return "_"
    # Letters, marks and numbers of any script.
    return character if unicodedata.category(character)[0] in "LMN" or character in _KEPT else "-"


def _trimmed(name: str) -> str:
    """A name that begins with no dot or hyphen, which hide it or make it an option, nor ends so."""
    return name.strip("-.")


def _folded(name: str) -> str:
    """What two names have in common that a file system takes for one."""
    return unicodedata.normalize("NFKC", name).casefold()
