"""The parts of an example: connected pieces of what bears one name.

A person labels kinds: all four legs are ``leg``. A recipe cuts parts, and so each connected piece
of the elements of one name is a part of its own. What was numbered by hand, ``leg1`` beside
``leg2``, stays apart though it may touch. Where it is not known which elements touch, each name is
one part.

Labels that are drawn or cut leave scraps: a few faces of a leg on the other side of a crease. A
piece of less than 0.2 % of the area is given to the piece with which it has the longest
boundary, unless it is the largest of its name. Elements without a label are in no piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from moseg_core import Example, Part, Segmentation, Shape, coarsen
from moseg_learn.names import kind_of

SCRAP = 0.002
"""A piece of less than this share of the area is no part."""

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Pieces:
    """A shape cut into parts, each of a kind.

    Parameters
    ----------
    shape : Shape
        The example's, or a coarse version of it.
    labels : (F of `shape`,) int
        Number of the part of each element, from 0; -1 for one in none.
    kinds : tuple of str
        Of each part; larger parts of a kind come first.
    """

    shape: Shape
    labels: IntArray
    kinds: tuple[str, ...]

    @property
    def segmentation(self) -> Segmentation:
        """The same as a segmentation, for its parts to be measured.

        What is in no piece makes one more part, the last.
        """
        n = len(self.kinds)
        rest = self.labels < 0
        labels = np.where(rest, n, self.labels)
        return Segmentation.from_labels(self.shape, labels, n + bool(rest.any()))

    @property
    def parts(self) -> Sequence[Part]:
        """The parts of :attr:`segmentation` that are pieces."""
        return self.segmentation.parts[: len(self.kinds)]

    def counts(self) -> dict[str, int]:
        """How many parts there are of each kind, kinds in alphabetical order."""
        return {kind: self.kinds.count(kind) for kind in sorted(set(self.kinds))}

    def described(self) -> str:
        """The parts in words, after the name of the shape.

        Examples
        --------
        >>> tile = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]],
        ...                        [[0, 1, 2], [1, 3, 2]], name="tile")
        >>> pieces_of(Example(tile, [0, 1], ["side1", "side2"])).described()
        'tile: 2 side'
        """
        words = [f"{n} {kind}" if n > 1 else kind for kind, n in self.counts().items()]
        return f"{self.shape.input.name}: {', '.join(words)}"

    def as_kinds(self) -> Example:
        """The same as an example, each element named by the kind of its part."""
        kinds = sorted(set(self.kinds))
        number = np.array([kinds.index(kind) for kind in self.kinds])
        labels = np.where(self.labels < 0, -1, number[self.labels])
        return Example(self.shape, labels, tuple(kinds))

    def at(self, resolution: int) -> Pieces:
        """The same on super-elements, each of the part that has most of its area.

        Parameters
        ----------
        resolution : int
            How many super-elements; 0 for the elements as they are. A shape of few elements, or one
            on which a part would have none, stays as it is.
        """
        if not resolution or self.shape.n_elements <= 1.5 * resolution:
            return self
        level = coarsen(self.shape, resolution)
        assert level.members is not None  # a coarse shape has them
        n = len(self.kinds)
        # No piece is one more choice, the last.
        code = np.asarray(level.members) * (n + 1) + np.where(self.labels < 0, n, self.labels)
        areas = np.bincount(code, self.shape.areas, level.n_elements * (n + 1))
        labels = areas.reshape(-1, n + 1).argmax(axis=1)
        labels[labels == n] = -1
        if len(np.unique(labels[labels >= 0])) < n:
            return self
        return Pieces(shape=level, labels=labels, kinds=self.kinds)


def pieces_of(example: Example, *, numbers: str = "alike", scrap: float = SCRAP) -> Pieces:
    """Cut an example into parts.

    Parameters
    ----------
    example : Example
    numbers : {"alike", "different"}
        Whether names that differ in their numbers name one kind.
    scrap : float
        Share of the area below which a piece is no part.
    """
    shape = example.shape
    piece, names = _connected(shape, example.labels)
    small = _scraps(_areas(piece, shape, len(names)), names, scrap * shape.area)
    if small.any():
        piece, names = _rejoined(_without(small, piece, shape), names, shape)
    kinds = [kind_of(example.names[name], numbers=numbers) for name in names]
    areas = _areas(piece, shape, len(names))
    order = sorted(range(len(kinds)), key=lambda k: (kinds[k], -areas[k], k))
    number = np.empty(len(order), np.int64)
    number[order] = np.arange(len(order))
    labels = np.where(piece < 0, -1, number[piece])
    return Pieces(shape=shape, labels=labels, kinds=tuple(kinds[k] for k in order))


def _areas(piece: IntArray, shape: Shape, n: int) -> FloatArray:
    """(n,) float: the area of each piece."""
    known = piece >= 0
    areas: FloatArray = np.bincount(piece[known], shape.areas[known], n).astype(np.float64)
    return areas


def _scraps(areas: FloatArray, names: IntArray, least: float) -> npt.NDArray[np.bool_]:
    """Which pieces are smaller than parts are, and not the largest of their name."""
    small = areas < least
    largest = {int(names[k]): int(k) for k in np.argsort(areas, kind="stable")}
    small[list(largest.values())] = False
    return small


def _connected(shape: Shape, labels: IntArray) -> tuple[IntArray, IntArray]:
    """(F,) number of the connected piece of each element, and the label of each piece.

    -1 for an element in none.
    """
    piece, names = np.full(len(labels), -1, np.int64), list[int]()
    for label in np.unique(labels[labels >= 0]).tolist():
        elements = np.flatnonzero(labels == label)
        if shape.adjacency is None:
            count, own = 1, np.zeros(len(elements), np.int64)
        else:
            count, own = shape.adjacency.components(elements)
        piece[elements] = own + len(names)
        names += [label] * count
    return piece, np.array(names, np.int64)


def _rejoined(piece: IntArray, names: IntArray, shape: Shape) -> tuple[IntArray, IntArray]:
    """The pieces that are left, numbered anew: one again where only a scrap had parted them."""
    one, other, _ = _ends(piece, shape)
    same = names[one] == names[other]
    n = len(names)
    graph = sparse.coo_array((np.ones(same.sum()), (one[same], other[same])), shape=(n, n))
    whole = csgraph.connected_components(graph, directed=False)[1]
    known = piece >= 0
    left, number = np.unique(whole[piece[known]], return_inverse=True)
    first = np.array([np.flatnonzero(whole == k)[0] for k in left])
    joined = np.full(len(piece), -1, np.int64)
    joined[known] = number.reshape(-1)
    return joined, names[first]


def _ends(piece: IntArray, shape: Shape) -> tuple[IntArray, IntArray, FloatArray]:
    """The pieces at both ends of each link between two of them, and its length."""
    links = shape.links
    one, other = piece[links.first], piece[links.second]
    known = (one >= 0) & (other >= 0)
    return one[known], other[known], links.lengths[known]


def _without(small: npt.NDArray[np.bool_], piece: IntArray, shape: Shape) -> IntArray:
    """The pieces with the small ones given away, each to the one that it has most boundary with.

    A small piece that touches nothing, as a speck of a scan does, goes to the nearest element's.
    """
    n = len(small)
    none = piece < 0
    while True:
        one, other, length = _ends(piece, shape)
        ends = np.concatenate([np.stack([one, other], 1), np.stack([other, one], 1)])
        lengths = np.tile(length, 2)
        wanted = small[ends[:, 0]] & ~small[ends[:, 1]]
        if not wanted.any():
            break
        code, at = np.unique(ends[wanted] @ [n, 1], return_inverse=True)
        shared = np.bincount(at, lengths[wanted])
        goes = np.arange(n)
        for k in np.argsort(shared, kind="stable").tolist():  # the longest boundary comes last
            goes[code[k] // n] = code[k] % n
        piece = np.where(none, -1, goes[piece])
    left = small[piece] & ~none
    if left.any():
        there = ~left & ~none
        nearest = cKDTree(shape.points[there]).query(shape.points[left])[1]
        piece[left] = piece[there][nearest]
    return piece
