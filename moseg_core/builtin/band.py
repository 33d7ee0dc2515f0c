"""The band on both sides of the boundaries of a labelling: what may change its part, and how far.

An element is as far from a boundary as the shortest way there from element to element, links
crossed in the middle. In the band are the elements that are no further from some boundary than its
width. Each may go to the parts that are as near as that. What is deep inside of its part stays,
however wide the band: beyond half the depth of the part's deepest element, so that small parts
keep their inner half.

:mod:`moseg_core.builtin.graph_cut` divides the band anew.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.shape.pins import Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray

#: Ways of no length would count as none.
_LEAST = 1e-12


@dataclass(frozen=True, eq=False, kw_only=True)
class Band:
    """The elements near the boundaries of a labelling, and those that they touch.

    Parameters
    ----------
    elements : (k,) int
        Their numbers in the shape, ascending.
    distances : (k, n) float, diagonals
        How far each is from each part, 0 from its own; infinite where it may not go there.
    links : (E,) int
        Numbers of the shape's links between them.
    first, second : (E,) int
        The two ends of each link, as indices into `elements`.
    """

    elements: IntArray
    distances: FloatArray
    links: IntArray
    first: IntArray
    second: IntArray

    @classmethod
    def of(
        cls, shape: Shape, labels: Int32Array, n_parts: int, *, width: float, pins: Pins
    ) -> Band:
        """The band of a labelling.

        Parameters
        ----------
        shape : Shape
            It is known which elements touch.
        labels : (F,) int
        n_parts : int
        width : float, diagonals
        pins : Pins
            These elements stay.

        Examples
        --------
        Of ten squares in a row the first four are a part. The width is that of a square and a half.

        >>> corners = [[x, y, 0] for x in range(11) for y in (0, 1)]
        >>> row = Shape.from_mesh(corners, [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1]
        ...                                 for k in range(10)])
        >>> from moseg_core.shape.pins import NO_PINS
        >>> band = Band.of(row, np.array([0] * 4 + [1] * 6), 2, width=1.5 / row.frame.scale,
        ...                pins=NO_PINS)
        >>> (band.distances * row.frame.scale).round(6).tolist()
        [[0.0, inf], [0.0, 1.5], [0.0, 0.5], [0.5, 0.0], [1.5, 0.0], [inf, 0.0]]
        """
        first, second, apart, cut = links = _links(shape, labels)
        depth = _depths(shape.n_elements, *links, limit=2 * width)
        free = (depth <= width) & _outer_half(labels, depth, shape.areas > 0, n_parts)
        free[pins.elements] = False

        near = depth <= width
        inside = near.copy()
        inside[first[near[second]]] = True
        inside[second[near[first]]] = True
        elements = np.flatnonzero(inside)
        number = np.full(shape.n_elements, -1)
        number[elements] = np.arange(len(elements))
        kept = np.flatnonzero(inside[first] & inside[second])
        first, second, apart, cut = (
            number[first[kept]],
            number[second[kept]],
            apart[kept],
            cut[kept],
        )
        own = labels[elements]
        distances = np.full((len(elements), n_parts), np.inf)
        for label in np.unique(own):
            entered = cut & ((own[first] == label) | (own[second] == label))
            ways = _ways(len(elements), first, second, apart, entered, own != label)
            distances[:, label] = _from_outside(ways, width)
        distances[~free[elements]] = np.inf
        distances[np.arange(len(elements)), own] = 0.0
        return cls(elements=elements, distances=distances, links=kept, first=first, second=second)


def depths(shape: Shape, labels: Int32Array, limit: float) -> FloatArray:
    """How deep each element lies in its part: how far it is from the nearest boundary.

    Parameters
    ----------
    shape : Shape
        It is known which elements touch.
    labels : (F,) int
    limit : float, diagonals

    Returns
    -------
    (F,) float, diagonals
        Infinite beyond the limit.
    """
    return _depths(shape.n_elements, *_links(shape, labels), limit=limit)


def _depths(
    size: int,
    first: IntArray,
    second: IntArray,
    apart: FloatArray,
    cut: BoolArray,
    *,
    limit: float,
) -> FloatArray:
    """See :func:`depths`; links as for :func:`_ways`."""
    ways = _ways(size, first, second, apart, cut, np.ones(size, np.bool_))
    return _from_outside(ways, limit)


def _links(shape: Shape, labels: Int32Array) -> tuple[IntArray, IntArray, FloatArray, BoolArray]:
    """Both ends of each link, how far these are from each other, and whether labels differ."""
    first, second = shape.links.first.astype(np.int64), shape.links.second.astype(np.int64)
    apart = np.linalg.norm(shape.points[first] - shape.points[second], axis=1)
    return (
        first,
        second,
        np.maximum(apart / shape.frame.scale, _LEAST),
        labels[first] != labels[second],
    )


def _ways(
    size: int,
    first: IntArray,
    second: IntArray,
    apart: FloatArray,
    cut: BoolArray,
    reached: BoolArray,
) -> sparse.csr_array:
    """Ways between elements, and from one more, the outside, to those at a cut link.

    Parameters
    ----------
    size : int
        Number of elements.
    first, second, apart, cut
        For each link its ends, how far these are from each other, and whether the way begins there.
    reached : (size,) bool
        The elements to which a way from the outside may lead.
    """
    ends = np.concatenate([first[cut], second[cut]])
    half = np.concatenate([apart[cut], apart[cut]]) / 2
    allowed = reached[ends]
    start = np.full(size, np.inf)
    np.minimum.at(start, ends[allowed], half[allowed])
    begun = np.flatnonzero(np.isfinite(start))
    rows = np.concatenate([first, second, np.full(len(begun), size)])
    columns = np.concatenate([second, first, begun])
    values = np.concatenate([apart, apart, start[begun]])
    return sparse.csr_array((values, (rows, columns)), shape=(size + 1, size + 1))


def _from_outside(ways: sparse.csr_array, limit: float) -> FloatArray:
    """(size,) float: the shortest way to each element from the outside; infinite beyond a limit."""
    last = ways.shape[0] - 1
    found: FloatArray = csgraph.dijkstra(ways, directed=True, indices=[last], limit=limit)
    return found[0, :last]


def _outer_half(labels: Int32Array, depth: FloatArray, area: BoolArray, n_parts: int) -> BoolArray:
    """(F,) bool: elements no deeper in their part than half of its deepest one that has an area."""
    deepest = np.zeros(n_parts)
    np.maximum.at(deepest, labels[area], depth[area])
    outer: BoolArray = depth <= deepest[labels] / 2
    return outer
