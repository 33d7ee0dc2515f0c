"""Labels as named lines: a line with a name, a line with the ids of the faces that bear it.

The form of the labelled Princeton benchmark (Kalogerakis, Hertzmann and Singh 2010,
doi:10.1145/1778765.1778839). Faces count from 1. A name may come again, with more faces; one that
no face bears is followed by an empty line. A face that stands nowhere has no label.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from moseg_core.io.labels.listing import Listing, Wanted
from moseg_core.io.read.checked import file_error
from moseg_core.io.read.text_rows import integers, word
from moseg_core.types import UNLABELLED, IntArray

FACE_ID = re.compile(r"[+-]?[0-9]+(\s|$)")
"""What a name must not begin with, so that it cannot be taken for a line of face ids."""

# Possessive: else digits could be split in ever more ways before a line is given up.
_IDS = re.compile(r"\s*+(?:[+-]?[0-9]++\s*+)*+$")


def are_named_lines(text: str) -> bool:
    r"""Whether a text has the form: names and lines of ids take turns.

    Examples
    --------
    >>> are_named_lines("body\n1 3\nleg\n2\n"), are_named_lines("label\n0\n1\n0\n")
    (True, False)
    """
    named, pairs = False, 0
    for line in text.splitlines():
        if not named:
            if not line.strip():
                continue
            if FACE_ID.match(line.strip()):
                return False
        elif _IDS.fullmatch(line):
            pairs += 1
        else:
            return False
        named = not named
    return pairs > 0


def read_named_lines(path: Path, text: str, wanted: Wanted) -> Listing:
    r"""Read named lines.

    Parameters
    ----------
    path : Path
        For messages.
    text : str
        What is in the file.
    wanted : Wanted

    Raises
    ------
    ShapeError
        A face that the shape does not have, or that stands twice; or the text has another form.
        Says where.

    Examples
    --------
    >>> found = read_named_lines(Path("a.txt"), "body\n1 3\nleg\n2\n", Wanted(n_elements=4))
    >>> found.labels.tolist(), found.names
    ([0, 1, 0, -1], ('body', 'leg'))
    """
    numbers: dict[str, int] = {}  # of names, in the order of their first appearance
    n = wanted.n_elements
    labels = np.full(n, UNLABELLED, np.int64)
    origin = np.zeros(n, np.int64)  # the line on which each face stands
    name: str | None = None
    for line, raw in enumerate(text.splitlines(), 1):
        if name is None:
            if raw.strip():
                name = _name(path, raw.strip(), line)
                numbers.setdefault(name, len(numbers))
            continue
        # The line behind a name is its faces even when blank: no face bears the name.
        label, name = numbers[name], None
        faces = _face_ids(path, raw.encode().split(), line, n)
        taken = labels[faces] >= 0
        if taken.any():
            face = int(faces[np.argmax(taken)])
            raise file_error(
                path,
                f"face {face + 1} stands on line {origin[face]} already; remove one",
                line=line,
            )
        labels[faces] = label
        origin[faces] = line
    if name is not None:
        raise file_error(path, f"ends behind the name '{name}', without its faces; it is cut off")
    return Listing(labels=labels, names=tuple(numbers), of="elements")


def _name(path: Path, name: str, line: int) -> str:
    if FACE_ID.match(name):
        raise file_error(
            path,
            f"expected the name of a label, found {word(name)};"
            " all faces of a label stand on the one line behind its name",
            line=line,
        )
    return name


def _face_ids(path: Path, tokens: list[bytes], line: int, n_elements: int) -> IntArray:
    """Zero-based faces from one line of ids."""
    ids = integers(path, tokens, lambda _: line)
    outside = (ids < 1) | (ids > n_elements)
    if outside.any():
        what = f"face {ids[np.argmax(outside)]} is none of the shape's faces, 1 to {n_elements}"
        raise file_error(path, f"{what}; give the labels of this very shape", line=line)
    ordered = np.sort(ids)
    twice = ordered[1:] == ordered[:-1]
    if twice.any():
        face = ordered[1:][np.argmax(twice)]
        raise file_error(path, f"face {face} stands twice on this line; remove one", line=line)
    return ids - 1
