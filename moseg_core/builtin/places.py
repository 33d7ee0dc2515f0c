"""Where centres may go: a few elements spread over the shape, its tips and its middles first.

Of 2,000 elements most are as good a centre as their neighbours, and choosing among all of them
spends a search's evaluations on differences that do not matter. Places are *furthest points*:
each is the element furthest, along the surface, from those chosen before (Gonzalez 1985,
doi:10.1016/0304-3975(85)90224-5; along the surface: Eldar, Lindenbaum, Porat, Zeevi 1997,
doi:10.1109/83.623193). The first is an extremity: the element furthest from the one in the middle.
So ears, feet and tails come early, whatever their size.

Distances are shortest paths over the adjacency, each step as long as the two elements are apart
(Dijkstra). Pieces that no path joins, and points without neighbours, are as far from each other as
they are in space.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import cKDTree

from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray

#: How many other places are near to a place.
NEAR = 8


@dataclass(frozen=True, eq=False, kw_only=True)
class Places:
    """Elements to choose centres from.

    Parameters
    ----------
    elements : (s,) int
        Different elements of the shape.
    near : (s, k) int
        For each place the numbers of the places nearest to it, itself left out; at most
        :data:`NEAR` of them, nearest first.
    """

    elements: IntArray
    near: IntArray

    def __len__(self) -> int:
        return len(self.elements)

    @classmethod
    def spread(cls, shape: Shape, count: int) -> Places:
        """Furthest points, or all elements where there are no more than asked for.

        Parameters
        ----------
        shape : Shape
        count : int

        Examples
        --------
        >>> row = [[x, 0, 0] for x in range(9)]
        >>> Places.spread(Shape.from_points(row), 3).elements.tolist()
        [0, 8, 4]
        """
        count = min(count, shape.n_elements)
        distances = distances_on(shape)
        middle = int(((shape.points - shape.points.mean(axis=0)) ** 2).sum(axis=1).argmin())
        chosen = [int(distances(middle).argmax())]
        rows = [distances(chosen[0])]
        nearest = rows[0].copy()
        while len(chosen) < count:
            nearest[chosen] = -1.0  # elements in one point are chosen all the same, each once
            chosen.append(int(nearest.argmax()))
            rows.append(distances(chosen[-1]))
            np.minimum(nearest, rows[-1], out=nearest)
        apart = np.stack([row[chosen] for row in rows])
        np.fill_diagonal(apart, -1.0)
        near = np.argsort(apart, axis=1, kind="stable")[:, 1 : 1 + NEAR]
        return cls(elements=np.array(chosen), near=near)

    @classmethod
    def everywhere(cls, shape: Shape) -> Places:
        """All elements; near are those that are near in space."""
        count = min(NEAR + 1, shape.n_elements)
        _, near = cKDTree(shape.points).query(shape.points, k=count)
        near = near.reshape(shape.n_elements, count)
        # Of several elements in one point, an element need not be the first to be found.
        own = near == np.arange(shape.n_elements)[:, None]
        own[~own.any(axis=1), -1] = True
        return cls(
            elements=np.arange(shape.n_elements),
            near=near[~own].reshape(shape.n_elements, count - 1).astype(np.int64),
        )


def distances_on(shape: Shape) -> Callable[[int], FloatArray]:
    """A function from an element to its (F,) distances to all, model units, along the surface.

    Examples
    --------
    >>> corner = Shape.from_points([[0, 0, 0], [3, 0, 0], [3, 4, 0]])
    >>> distances_on(corner)(0).tolist()
    [0.0, 3.0, 5.0]
    """
    points, adjacency = shape.points, shape.adjacency

    def straight(element: int) -> FloatArray:
        found: FloatArray = np.sqrt(((points - points[element]) ** 2).sum(axis=1))
        return found

    if adjacency is None:
        return straight
    ends = adjacency.pairs
    lengths = np.sqrt(((points[ends[:, 0]] - points[ends[:, 1]]) ** 2).sum(axis=1))
    # A step of no length would be no step at all to a sparse matrix.
    lengths = np.maximum(lengths, 1e-12 * shape.frame.scale)
    size = shape.n_elements
    graph = sparse.csr_array((lengths, adjacency.indices, adjacency.indptr), shape=(size, size))

    def along(element: int) -> FloatArray:
        found: FloatArray = csgraph.dijkstra(graph, directed=True, indices=[element])[0]
        return np.where(np.isfinite(found), found, straight(element))

    return along
