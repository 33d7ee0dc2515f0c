"""Which of several properties, columns, arrays or members hold labels: by their names.

There is no standard. ScanNet writes ``label`` and ``objectId``, CloudCompare ``scalar_Label`` and
``scalar_Classification``, SAM-based tools ``segment_id``, PartNet ``part_id``, and so on. They are
compared without case, signs between words, ``scalar_`` in front, and what only says that a number
follows (``id``, ``index``). Where several are there the first in the list is meant, and which was
taken is said.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Sequence
from pathlib import Path

from moseg_core.errors import nearest
from moseg_core.io.read.checked import file_error

_FAMILIAR = (
    *("label", "facelabel", "vertexlabel", "pointlabel", "gtlabel", "truelabel", "predlabel"),
    *("partlabel", "semanticlabel", "semantic", "semanticseg", "segmentation", "segment", "seg"),
    *("facesegment", "part", "facepart", "object", "instance", "instancelabel", "class"),
    *("semanticclass", "classification", "category", "cluster", "region", "patch", "group", "tag"),
    *("annotation", "gt", "pred", "prediction"),
)
"""Names of labels, as :func:`plain` writes them, the surest first."""

_NAMES = frozenset(["name", "labelname", "class", "classname", "category", "partname"])

# An s behind anything but an s, as in class, and es behind what would hiss otherwise.
_PLURAL = re.compile(r"(?<=ss|sh|ch)es$|(?<=x)es$|(?<!s)s$")
_TAIL = re.compile(r"(ids?|index|indices|idx|numbers?)$")


def plain(name: str) -> str:
    """A name without what is written differently everywhere.

    Examples
    --------
    >>> plain("scalar_Label"), plain("objectId"), plain("Segment_IDs"), plain("id")
    ('label', 'object', 'segment', 'id')
    """
    word = re.sub(r"[^a-z0-9]", "", name.lower().removeprefix("scalar_"))
    word = _TAIL.sub("", word) or word
    return _PLURAL.sub("", word[:-3] + "y" if word.endswith("ies") else word)


def familiar(names: Iterable[str]) -> list[str]:
    """The names that are usual for labels, the surest first.

    Examples
    --------
    >>> familiar(["x", "objectId", "quality", "label"])
    ['label', 'objectId']
    """
    known = [name for name in names if _rank(name) < len(_FAMILIAR)]
    return sorted(known, key=_rank)


def names_labels(name: str, count: int, counts: Container[int | None]) -> bool:
    """Whether a list says what labels are called, and not which label there is.

    Parameters
    ----------
    name : str
        Of the list.
    count : int
        How many texts it holds.
    counts : container of int
        How many there are of what may bear labels.

    Examples
    --------
    >>> names_labels("class_names", 4, [252]), names_labels("classes", 252, [252])
    (True, False)
    """
    return plain(name) in _NAMES and count not in counts


def _rank(name: str) -> int:
    word = plain(name)
    return _FAMILIAR.index(word) if word in _FAMILIAR else len(_FAMILIAR)


def chosen(
    path: Path, kind: str, names: Sequence[str], wanted: Sequence[str]
) -> tuple[str | None, tuple[str, ...]]:
    """The property that holds the labels.

    Parameters
    ----------
    path : Path
        For messages.
    kind : str
        What they are: "property", "array".
    names : sequence of str
        Those that could hold labels.
    wanted : sequence of str
        The first of these that there is; empty to go by usual names.

    Returns
    -------
    name : str or None
        None where no name is a usual one.
    notes : tuple of str
        What else there was.

    Raises
    ------
    ShapeError
        There is none of those that are wanted.

    Examples
    --------
    >>> name, notes = chosen(Path("a.ply"), "property", ["label", "objectId"], [])
    >>> name, notes[0]
    ('label', "a.ply: labels are its property 'label', not 'objectId'; --label-property says which")
    """
    for name in wanted:
        if name in names:
            return name, ()
        alike = [other for other in names if plain(other) == plain(name)]
        if len(alike) == 1:
            return alike[0], ()
    if wanted:
        guess = nearest(wanted[0], names)
        hint = f"; did you mean '{guess}'?" if guess is not None else ""
        there = f"it has {', '.join(names)}" if names else "it has none that could hold labels"
        raise file_error(path, f"has no {kind} '{wanted[0]}'{hint or '; ' + there}")
    found = familiar(names)
    if not found:
        return None, ()
    others = " or ".join(f"'{name}'" for name in found[1:])
    said = f"{path.name}: labels are its {kind} '{found[0]}', not {others};"
    return found[0], (f"{said} --label-property says which",) if others else ()
