"""A listing: the labels that a file gives, before it is known what to.

What all forms have in common stands here: which numbers are labels (whole ones, however they are
written; -1 and what is not a number say that there is none), and how words become numbered names.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from moseg_core.io.labels.properties import plain
from moseg_core.io.read.checked import file_error
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.io.read.text_rows import word
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import UNLABELLED, FloatArray, IntArray

NO_LABEL = frozenset(
    ["", "nan", "null", "none", "(null)", "n/a", "-1", "unlabelled", "unlabeled", "undefined"]
)
"""Words that say, in small letters, that there is no label."""

Of = Literal["elements", "vertices", "unsaid"]

BEARERS: dict[str, Of] = {
    "vertex": "vertices",
    "vertice": "vertices",
    "vert": "vertices",
    "point": "vertices",
    "face": "elements",
    "triangle": "elements",
    "polygon": "elements",
    "element": "elements",
}
"""What bears labels, as :func:`~moseg_core.io.labels.properties.plain` writes it, and is it."""

_OF_LABELS = re.compile(r"(?:label|segment|seg|part|class)$")
_LARGEST = 2.0**53  # up to which every whole number is a float of its own


@dataclass(frozen=True, eq=False, kw_only=True)
class Wanted:
    """What a file's labels are for.

    Parameters
    ----------
    n_elements : int
        Of the shape.
    n_vertices : int or None
        None where it is not known.
    noun : str
        What an element is called: face, point, cell.
    properties : tuple of str
        Names of the property, column, array or member that holds the labels, the first that a file
        has; empty to go by usual names.
    grid : VoxelGrid or None
        The cells that are elements, where the shape is a voxel grid.
    bearer : {"elements", "vertices", "unsaid"}
        What the file says that it labels.
    limits : ReadLimits
        How much a shape that bears the labels may become.
    """

    n_elements: int
    n_vertices: int | None = None
    noun: str = "element"
    properties: tuple[str, ...] = ()
    grid: VoxelGrid | None = None
    bearer: Of = "unsaid"
    limits: ReadLimits = LIMITS

    @classmethod
    def of(
        cls, shape: Shape | int, properties: Sequence[str] = (), *, limits: ReadLimits = LIMITS
    ) -> Wanted:
        """For a shape, or for so many elements of which nothing more is known."""
        if isinstance(shape, int | np.integer):
            return cls(n_elements=int(shape), properties=tuple(properties), limits=limits)
        return cls(
            n_elements=shape.n_elements,
            n_vertices=len(shape.geometry.vertices),
            noun=shape.noun,
            properties=tuple(properties),
            grid=shape.geometry if isinstance(shape.geometry, VoxelGrid) else None,
            limits=limits,
        )

    def told(self, name: str) -> Wanted:
        """With what a header or key says that it labels, if it says so.

        The points of a cloud are its elements, and so are they where only a number is known.

        Examples
        --------
        >>> wanted = Wanted(n_elements=4, n_vertices=4)
        >>> [wanted.told(name).bearer for name in ("Vertex_IDs", "face_labels", "id")]
        ['vertices', 'elements', 'unsaid']
        """
        word = plain(name)
        word = _OF_LABELS.sub("", word) or word
        of = BEARERS.get(word, "unsaid")
        if of == "unsaid" or (word == "point" and self.n_vertices is None):
            return self
        return replace(self, bearer="elements" if self.noun == "point" else of)

    def bearers(self, path: Path, ids: IntArray) -> tuple[int, str]:
        """How many there are of what ids count, and what it is called.

        Where the file does not say it these are vertices if they all are there.

        Raises
        ------
        ShapeError
            They are vertices, and how many there are is not known.
        """
        if self.bearer == "vertices" and self.n_vertices is None:
            raise file_error(path, "labels vertices, of which it is not known how many there are")
        all_there = len(np.unique(ids)) == self.n_vertices != self.n_elements
        if self.n_vertices is not None and (
            self.bearer == "vertices" or (self.bearer == "unsaid" and all_there)
        ):
            return self.n_vertices, "vertex"
        return self.n_elements, self.noun


@dataclass(frozen=True, eq=False, kw_only=True)
class Listing:
    """Labels as a file lists them.

    Parameters
    ----------
    labels : (n,) int
        From 0; -1 where there is none.
    names : tuple of str or None
        Of the labels.
    of : {"elements", "vertices", "unsaid"}
        What they are the labels of; where a file does not say, their number does.
    notes : tuple of str
    places : (n, 3) float or None
        Middle of the corners of each, where the file has a shape of its own.
    source : (n,) int or None
        The element of another shape that each is a piece of, and by `weights` how much of it.
    weights : (n,) float or None
    """

    labels: IntArray
    names: tuple[str, ...] | None = None
    of: Of = "unsaid"
    notes: tuple[str, ...] = ()
    places: FloatArray | None = None
    source: IntArray | None = None
    weights: FloatArray | None = None


def middles(mesh: Geometry) -> FloatArray:
    """(F, 3) float: the middle of the corners of each element, by which a face is known again."""
    sizes = np.diff(mesh.offsets)
    summed: FloatArray = np.add.reduceat(mesh.vertices[mesh.corners], mesh.offsets[:-1])
    return summed / sizes[:, None]


def whole_labels(
    path: Path,
    values: npt.NDArray[np.generic],
    *,
    noun: str = "element",
    line_of: Callable[[int], int] | None = None,
) -> IntArray:
    """Labels from numbers.

    Parameters
    ----------
    path : Path
        For messages.
    values : (n,) bool, int or float
        Whole, however they are stored; -1, what is not a number, and the greatest of an unsigned
        type of 32 or 64 bits, which is what -1 becomes there, say that there is no label.
    noun : str
        What bears a label.
    line_of : callable, optional
        The line on which label ``i`` stands, where the file has lines.

    Raises
    ------
    ShapeError
        A number that is no label; says which.

    Examples
    --------
    >>> whole_labels(Path("a.npy"), np.array([1.0, np.nan, 0.0])).tolist()
    [1, -1, 0]
    >>> whole_labels(Path("a.npy"), np.array([True, False])).tolist()
    [1, 0]
    """
    if values.dtype.kind not in "biuf":
        raise file_error(path, f"holds {values.dtype} instead of whole numbers; labels are such")

    def refused(wrong: npt.NDArray[np.bool_], what: str) -> None:
        if not wrong.any():
            return
        index = int(np.argmax(wrong))
        number = values[index].item()
        if line_of is None:
            raise file_error(path, f"gives {noun} {index} the label {number}; {what}")
        raise file_error(path, f"the label {number} {what}", line=line_of(index))

    from_zero = "labels count from 0, and -1 stands where there is none"
    if line_of is not None:
        from_zero = f"is negative; {from_zero}"
    whole = "is not a whole number" if line_of is not None else "labels are whole numbers"
    if values.dtype.kind == "f":
        numbers = values.astype(np.float64)
        numbers = np.where(np.isnan(numbers), UNLABELLED, numbers)
        refused((np.floor(numbers) != numbers) | (np.abs(numbers) > _LARGEST), whole)
        labels = numbers.astype(np.int64)
    elif values.dtype.kind == "u" and values.dtype.itemsize >= 4:
        unsigned = values.astype(np.uint64)
        none = unsigned == 2 ** (8 * values.dtype.itemsize) - 1
        refused(~none & (unsigned >= 2**63), "labels are below 2**63")
        labels = np.where(none, 0, unsigned).astype(np.int64)
        labels[none] = UNLABELLED
    else:
        labels = values.astype(np.int64)
    refused(labels < UNLABELLED, from_zero)
    return labels


def numbered_names(words: Iterable[str | None]) -> tuple[IntArray, tuple[str, ...]]:
    """Labels from a word for each, numbered in the order of their first appearance.

    Parameters
    ----------
    words : iterable of str or None
        None, and a word of :data:`NO_LABEL`, say that there is no label.

    Examples
    --------
    >>> labels, names = numbered_names(["leg", "body", None, "leg"])
    >>> labels.tolist(), names
    ([0, 1, -1, 0], ('leg', 'body'))
    """
    numbers: dict[str, int] = {}
    labels = [
        UNLABELLED
        if name is None or name.lower() in NO_LABEL
        else numbers.setdefault(name, len(numbers))
        for name in (None if said is None else said.strip() for said in words)
    ]
    return np.array(labels, np.int64), tuple(numbers)


def labels_of_ids(
    path: Path, groups: Sequence[tuple[int, str, IntArray]], n: int, *, noun: str
) -> tuple[IntArray, tuple[str, ...]]:
    """Labels from the ids of what bears each, counted from 0, or from 1 where that must be.

    Parameters
    ----------
    path : Path
        For messages.
    groups : sequence of (int, str, (k,) int)
        Number of a label, what it is called in messages, the ids of those that bear it.
    n : int
        How many there are of what bears labels.
    noun : str
        What bears labels.

    Returns
    -------
    labels : (n,) int
        -1 for what is in no group.
    notes : tuple of str
        Says so where ids count from 1: there is an id `n` and none is 0.

    Raises
    ------
    ShapeError
        An id out of range, or one that stands twice.

    Examples
    --------
    >>> groups = [(0, "body", np.array([1, 3])), (1, "leg", np.array([2]))]
    >>> labels_of_ids(Path("a.json"), groups, 3, noun="face")
    (array([0, 1, 0]), ('a.json counts faces from 1',))
    """
    ids = np.concatenate([np.empty(0, np.int64), *(group for _, _, group in groups)])
    owner = np.repeat(np.arange(len(groups)), [len(group) for _, _, group in groups])
    first = int(ids.size > 0 and ids.max() == n and ids.min() >= 1)
    outside = (ids < first) | (ids >= n + first)
    if outside.any():
        wrong = int(np.argmax(outside))
        raise file_error(
            path,
            f"gives the label {word(groups[owner[wrong]][1])} to {noun} {ids[wrong]}, but"
            f" there are {n}, counted from {first}; give the labels of this very shape",
        )
    order = np.argsort(ids, kind="stable")
    twice = np.flatnonzero(ids[order][1:] == ids[order][:-1])
    if twice.size:
        one, other = (groups[owner[order[twice[0] + k]]][1] for k in (0, 1))
        raise file_error(
            path,
            f"gives {noun} {ids[order[twice[0]]]} the label {word(one)} and the label"
            f" {word(other)}; a {noun} has one label",
        )
    labels = np.full(n, UNLABELLED, np.int64)
    labels[ids - first] = np.array([number for number, _, _ in groups], np.int64)[owner]
    nouns = "vertices" if noun == "vertex" else f"{noun}s"
    notes = (f"{path.name} counts {nouns} from 1",) if first else ()
    return labels, notes
