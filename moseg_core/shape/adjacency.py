"""Which surface elements touch which: the graph that keeps segments connected (Sec. 4).

Adjacency is a CSR pair as in ``scipy.sparse``: the neighbours of element ``f`` are
``indices[indptr[f]:indptr[f + 1]]``, ascending, without ``f`` itself. Two polygons are
neighbours when they share an edge by position. Around an edge that more than three share, each is
the neighbour of the next by angle on either side, with nothing but space between: a ring, as long
as the number of polygons, where pairs of all with all would be its square; of three it has all
pairs. A ring does not depend on the order of the file, but for polygons at one angle, such as
copies, which follow each other in it. Cells of a solid grid are neighbours when they share a face,
and those of its surface when they share an edge: along a slope the cells of a staircase touch in no
more than that.

Points have no neighbours, nor have polygons of a soup. Where the user asks for it, elements that
are *mutually* among each other's nearest count as neighbours: one-sided nearness would bridge the
gap between two sheets as soon as one of them is sampled more sparsely.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse

from moseg_core.shape.compiled import kernel
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.nearest import nearest_points
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen

#: Below this angle, in radians, two polygons at an edge are taken to be at the same.
_SAME = 1e-6

#: Stands for the component of an element that is not asked for.
_OUTSIDE = -2

NEAREST = 10
"""How many nearest elements may be neighbours, unless the user says otherwise."""


@dataclass(frozen=True, eq=False)
class Adjacency:
    """The element graph, in CSR form.

    Parameters
    ----------
    indptr : (F + 1,) int32
    indices : (E,) int32
        Each undirected edge stands twice, once from either side.
    """

    indptr: Int32Array
    indices: Int32Array

    def __post_init__(self) -> None:
        frozen(self.indptr)
        frozen(self.indices)

    @classmethod
    def from_pairs(cls, pairs: IntArray, n_elements: int) -> Adjacency:
        """From an (E, 2) array of neighbouring elements, in any order, repeats allowed.

        Examples
        --------
        >>> import numpy as np
        >>> graph = Adjacency.from_pairs(np.array([[0, 1], [1, 2], [1, 0]]), 3)
        >>> graph.indptr.tolist(), graph.indices.tolist()
        ([0, 1, 3, 4], [1, 0, 2, 1])
        """
        pairs = pairs[pairs[:, 0] != pairs[:, 1]]
        rows = np.concatenate([pairs[:, 0], pairs[:, 1]])
        columns = np.concatenate([pairs[:, 1], pairs[:, 0]])
        graph = sparse.coo_array(
            (np.ones(len(rows), np.int8), (rows, columns)), shape=(n_elements, n_elements)
        ).tocsr()
        graph.sum_duplicates()
        graph.sort_indices()
        return cls(graph.indptr.astype(np.int32), graph.indices.astype(np.int32))

    def grouped(self, members: IntArray, n_groups: int) -> Adjacency:
        """Which groups of elements touch.

        Parameters
        ----------
        members : (F,) int
            The group of each element.
        n_groups : int

        Examples
        --------
        >>> chain = Adjacency.from_pairs(np.array([[0, 1], [1, 2], [2, 3]]), 4)
        >>> chain.grouped(np.array([0, 0, 1, 2]), 3).indices.tolist()
        [1, 0, 2, 1]
        """
        # Of the links of a grid of millions of cells few lead from group to group, each seen
        # from both sides: once will do.
        group = members.astype(np.int32)
        first = np.repeat(group, np.diff(self.indptr))
        second = group[self.indices]
        ascending = first < second
        return Adjacency.from_pairs(
            np.stack([first[ascending], second[ascending]], axis=1).astype(np.int64), n_groups
        )

    @property
    def n_elements(self) -> int:
        """Number of elements, F."""
        return len(self.indptr) - 1

    @cached_property
    def pairs(self) -> IntArray:
        """(E, 2) int: each element with each of its neighbours."""
        rows = np.repeat(np.arange(self.n_elements), np.diff(self.indptr))
        return np.stack([rows, self.indices.astype(np.int64)], axis=1)

    def neighbors(self, element: int) -> Int32Array:
        """The elements next to one element, ascending."""
        return self.indices[self.indptr[element] : self.indptr[element + 1]]

    @cached_property
    def matrix(self) -> sparse.csr_array:
        """(F, F) sparse 0/1 matrix, for ``scipy.sparse.csgraph``."""
        size = self.n_elements
        ones = np.ones(len(self.indices), np.int8)
        return sparse.csr_array((ones, self.indices, self.indptr), shape=(size, size))

    def components(self, elements: IntArray | None = None) -> tuple[int, IntArray]:
        """Connected components of all elements, or of those given.

        Returns
        -------
        count : int
        component : (k,) int
            The component of each element asked for, numbered from 0 in the order of their least
            elements.
        """
        if elements is None:
            return self._all_components
        component = np.full(self.n_elements, _OUTSIDE, np.int64)
        component[elements] = -1
        count = _flood(self.indptr, self.indices, component)
        return count, component[elements]

    @cached_property
    def _all_components(self) -> tuple[int, IntArray]:
        component = np.full(self.n_elements, -1, np.int64)
        return _flood(self.indptr, self.indices, component), frozen(component)


@kernel
def _flood(indptr: Int32Array, indices: Int32Array, component: IntArray) -> int:
    """Write the number of each element's component where it is -1 so far, and count them."""
    waiting = np.empty(len(component), np.int32)
    count = 0
    for first in range(len(component)):
        if component[first] != -1:
            continue
        component[first] = count
        waiting[0], n_waiting = first, 1
        while n_waiting > 0:
            n_waiting -= 1
            element = waiting[n_waiting]
            for k in range(indptr[element], indptr[element + 1]):
                other = indices[k]
                if component[other] == -1:
                    component[other] = count
                    waiting[n_waiting] = other
                    n_waiting += 1
        count += 1
    return count


def mesh_adjacency(mesh: PolygonMesh) -> Adjacency:
    """Neighbouring polygons of a mesh: those that share an edge by position.

    Examples
    --------
    >>> mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]],
    ...                               [[0, 1, 2], [1, 3, 2]])
    >>> mesh_adjacency(mesh).neighbors(0).tolist()
    [1]
    """
    return Adjacency.from_pairs(edge_pairs(mesh)[0], mesh.n_polygons)


def edge_pairs(mesh: PolygonMesh) -> tuple[IntArray, IntArray]:
    """Polygons that are neighbours across an edge, and across which.

    Parameters
    ----------
    mesh : PolygonMesh

    Returns
    -------
    pairs : (E, 2) int
        Numbers of polygons; a pair comes once for each edge that it has in common. A polygon that
        runs through an edge several times may be its own neighbour.
    edge : (E,) int
        The edges' numbers in :func:`undirected`.

    Examples
    --------
    Four walls of a cross around their common edge:

    >>> cross = PolygonMesh.from_faces(
    ...     [[0, 0, 0], [0, 0, 1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]],
    ...     [[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5]])
    >>> sorted(map(sorted, edge_pairs(cross)[0].tolist()))
    [[0, 2], [0, 3], [1, 2], [1, 3]]
    """
    ends, polygon = mesh.edges
    edges, group = undirected(ends)
    sizes = np.bincount(group)
    order = np.argsort(group, kind="stable")
    if (sizes > 3).any():
        crowded = sizes[group] > 3
        turn = np.zeros(len(group), np.int64)
        turn[crowded] = _turns(mesh, edges[group[crowded]], group[crowded], polygon[crowded])
        order = np.lexsort((turn, group))  # in file order where the rest is equal
    group, polygon = group[order], polygon[order]
    # Each with the one behind it, and the last of three or more with the first.
    starts = np.cumsum(sizes) - sizes
    following = np.arange(1, len(group) + 1)
    following[starts + sizes - 1] = starts
    paired = sizes[group] > 2
    paired[starts[sizes == 2]] = True
    return np.stack([polygon[paired], polygon[following[paired]]], axis=1), group[paired]


def _turns(mesh: PolygonMesh, ends: IntArray, edge: IntArray, polygon: IntArray) -> IntArray:
    """Numbers that ascend with the angle of polygons around edges, equal at equal angles.

    Parameters
    ----------
    mesh : PolygonMesh
    ends : (k, 2) int
        Positions of the ends of each edge, the same way round for all polygons of one edge.
    edge, polygon : (k,) int
    """
    place = np.empty((int(mesh.merged.max()) + 1, 3))
    place[mesh.merged] = mesh.vertices
    start = place[ends[:, 0]]
    along = place[ends[:, 1]] - start
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # Where a polygon lies, as seen along the edge, its middle says.
    middles = np.add.reduceat(place[mesh.merged[mesh.corners]], mesh.offsets[:-1], axis=0)
    middles /= np.diff(mesh.offsets)[:, None]
    away = middles[polygon] - start
    away -= np.einsum("ij,ij->i", away, along)[:, None] * along
    far = np.linalg.norm(away, axis=1)
    # Angles are from the polygon that is farthest away, which has one for sure.
    by_distance = np.lexsort((far, edge))
    last = by_distance[np.flatnonzero(np.diff(edge[by_distance], append=-1))]
    zero = away[last[np.searchsorted(edge[last], edge)]]
    quarter = np.cross(along, zero)
    angle = np.arctan2(np.einsum("ij,ij->i", away, quarter), np.einsum("ij,ij->i", away, zero)) % (
        2.0 * np.pi
    )
    flat = far <= _SAME * np.linalg.norm(zero, axis=1)  # on the edge: at no angle
    angle[(angle > 2.0 * np.pi - _SAME) | flat] = 0.0
    order = np.lexsort((angle, edge))
    onward = np.diff(angle[order], prepend=0.0) > _SAME
    turn = np.empty(len(edge), np.int64)
    turn[order] = np.cumsum(onward)  # from edge to edge it need not begin anew
    return turn


def grid_adjacency(grid: VoxelGrid) -> Adjacency:
    """Neighbouring cells of a grid: those that share a face or, on a surface, an edge.

    Examples
    --------
    >>> stairs = VoxelGrid.from_occupied(np.array([[[True, False], [False, True]]]))
    >>> grid_adjacency(stairs).indices.tolist()
    []
    """
    n, shape, here = grid.n_elements, grid.occupied.shape, grid.is_element
    number = np.full([size + 2 for size in shape], -1, np.int32)
    number[1:-1, 1:-1, 1:-1][here] = np.arange(n, dtype=np.int32)
    most = 1 if grid.solid else 2
    # In the order of the cells, so that the neighbours of each ascend.
    steps = [step for step in np.ndindex(3, 3, 3) if 0 < sum(abs(k - 1) for k in step) <= most]

    def beside(step: tuple[int, ...]) -> Int32Array:
        """(F,) int32: for each element the one a step further, -1 where there is none."""
        window = tuple(slice(k, k + size) for k, size in zip(step, shape, strict=True))
        return number[window][here]

    degree = np.zeros(n + 1, np.int64)
    for step in steps:
        degree[1:] += beside(step) >= 0
    indptr = np.cumsum(degree).astype(np.int32)
    indices = np.empty(int(indptr[-1]), np.int32)
    place = indptr[:-1].copy()
    for step in steps:
        found = beside(step)
        there = found >= 0
        indices[place[there]] = found[there]
        place += there
    return Adjacency(indptr, indices)


def near_pairs(points: FloatArray, nearest: int = NEAREST) -> IntArray:
    """(E, 2) int: pairs of points each of which is among the nearest of the other.

    Parameters
    ----------
    points : (F, 3) float
    nearest : int
        How many others are the nearest of a point.

    Examples
    --------
    >>> near_pairs(np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0]]), 1).tolist()
    [[0, 1]]
    """
    count = len(points)
    near = min(nearest + 1, count)
    found = nearest_points(points, near)[1]
    rows = np.repeat(np.arange(count), near)
    columns = found.reshape(-1)
    apart = rows != columns
    low, high = np.minimum(rows, columns)[apart], np.maximum(rows, columns)[apart]
    code, times = np.unique(low * count + high, return_counts=True)
    pairs: IntArray = np.stack(np.divmod(code[times == 2], count), axis=1)
    return pairs


def undirected(ends: IntArray) -> tuple[IntArray, IntArray]:
    """Distinct undirected edges, and for each directed edge the number of its undirected one."""
    if not len(ends):
        return ends, np.empty(0, np.int64)
    low, high = np.minimum(*ends.T), np.maximum(*ends.T)
    count = int(high.max()) + 1
    code, group = np.unique(low * count + high, return_inverse=True)  # sorts rows much faster
    return np.stack(np.divmod(code, count), axis=1), group.reshape(-1)
