"""From a file and the options on how to read it to a shape; the same for all commands."""

from __future__ import annotations

import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.waiting import waiting
from moseg_core.errors import UsageError, unknown
from moseg_core.io import Labelling
from moseg_core.io.read.limits import ReadLimits
from moseg_core.io.reading import Reading
from moseg_core.shape.shape import Shape
from moseg_core.types import IntArray


def read_label_property(text: str | None) -> tuple[str, ...]:
    """Names of the property that holds labels, separated by commas; the first that a file has.

    Examples
    --------
    >>> read_label_property("label, objectId")
    ('label', 'objectId')
    """
    return () if text is None else tuple(name.strip() for name in text.split(",") if name.strip())


def read_pitch(text: str) -> list[float]:
    """The sides of a cell: three numbers separated by commas, or one of a cube.

    Raises
    ------
    UsageError
        It is neither, or a number is not positive.

    Examples
    --------
    >>> read_pitch("0.5, 0.5, 1"), read_pitch("2")
    ([0.5, 0.5, 1.0], [2.0, 2.0, 2.0])
    """
    try:
        sides = [float(word) for word in text.split(",")]
    except ValueError:
        sides = []
    if len(sides) not in (1, 3) or not all(0 < side < math.inf for side in sides):
        raise UsageError(
            f"--pitch is one positive number or three, such as 0.5 or 0.5,0.5,3, not '{text}'"
        )
    return sides if len(sides) == 3 else 3 * sides


def read_shape(path: Path, flags: ShapeFlags, *, quiet: bool = False) -> Shape:
    """Read a shape and estimate what it does not know of itself, as far as that is asked for.

    Parameters
    ----------
    path : Path
    flags : ShapeFlags
        Which cells of a voxel grid are elements says nothing to other shapes, nor does how near
        vertices are joined to what is no mesh.
    quiet : bool
        Whether a terminal is not told that the shape is being read.

    Raises
    ------
    ShapeError
        The file cannot be read, or its volume not be estimated; a pitch is given for what is no
        voxel grid.
    UsageError
        A pitch or a limit that is not understood.
    """
    with waiting(f"reading {path.name}", quiet=quiet):
        return reading_of(flags).read(path)


def reading_of(flags: ShapeFlags) -> Reading:
    """What the options say of how to read a shape, read themselves.

    Raises
    ------
    UsageError
        A pitch or a limit that is not understood.
    """
    given: Any = {field.name: getattr(flags, field.name) for field in fields(flags)}
    pitch = None if flags.pitch is None else tuple(read_pitch(flags.pitch))
    limit = tuple(flags.limit or ())
    limits_of(flags)  # refused now, and not file by file
    return Reading(**{**given, "pitch": pitch, "limit": limit})


def limits_of(flags: ShapeFlags) -> ReadLimits:
    """How much a file may become, also one that bears labels.

    Raises
    ------
    UsageError
        A limit that is not understood.
    """
    return ReadLimits.read(flags.limit or ())


def matched_labels(labelling: Labelling, names: tuple[str, ...], path: Path) -> IntArray:
    """Labels as indices into the names of a problem: by name where the file has names.

    Parameters
    ----------
    labelling : Labelling
    names : tuple of str
    path : Path
        Of the file, for messages.

    Raises
    ------
    UsageError
        A name that is none of the problem's.
    """
    if labelling.names is None:
        return labelling.labels
    used = sorted(set(labelling.labels.tolist()))
    for label in used:
        if labelling.names[label] not in names:
            raise UsageError(f"'{path}': {unknown('label', labelling.names[label], names)}")
    index = np.zeros(len(labelling.names), np.int64)
    for label in used:
        index[label] = names.index(labelling.names[label])
    return index[labelling.labels]


def named_labels(labelling: Labelling, *, before: str = "") -> tuple[IntArray, tuple[str, ...]]:
    """Labels and their names: the file's, or the numbers that occur, which may leave some out.

    Parameters
    ----------
    labelling : Labelling
    before : str
        What stands in front of a number.

    Returns
    -------
    labels : (F,) int
        Index into the names; -1 where there is no label.
    names : tuple of str

    Examples
    --------
    >>> numbers = Labelling(labels=np.array([5, -1, 2, 5]), names=None)
    >>> labels, names = named_labels(numbers, before="label ")
    >>> labels.tolist(), names
    ([1, -1, 0, 1], ('label 2', 'label 5'))
    """
    if labelling.names is not None:
        return labelling.labels, labelling.names
    used, labels = np.unique(labelling.labels, return_inverse=True)
    names = tuple(f"{before}{number}" for number in used[used >= 0])
    return labels - np.count_nonzero(used < 0), names
