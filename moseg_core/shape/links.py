"""Links: which elements touch, and along which length.

A link joins two neighbouring elements. Its length is that of the boundary between them, so that
the boundary of a part is as long as the links that leave it, whatever the elements are:

- of polygons the edges across which they are neighbours, each as long as it is;
- of the cells of a solid the face that both have; an area, as the areas of a solid are volumes;
- of elements that are neighbours because they are near (``--adjacency knn``), and of the cells of
  a grid's surface: an estimate that counts links. A curve crosses links in proportion to its
  length: where links of the total length ``d`` lie on an area ``A`` in all directions, a curve of
  length 1 crosses ``2 d / (pi A)`` of them (the Cauchy-Crofton formula; Boykov and Kolmogorov 2003,
  doi:10.1109/ICCV.2003.1238310). A link stands for a length in proportion to the distance between
  elements, the root of the area of its two ends, by a factor such that this holds for the whole.

A link between super-elements (:mod:`moseg_core.shape.coarse`) is the sum of those between their
members. So a boundary is as long on a coarse shape as the same boundary on the fine one.

:mod:`moseg_core.shape.boundary_sums` sums links over the boundaries of parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.shape.adjacency import Adjacency, edge_pairs, undirected
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Links:
    """Pairs of neighbouring elements, each pair once.

    Parameters
    ----------
    first, second : (E,) int32
        Numbers of the two elements, ``first < second``; pairs in ascending order.
    lengths : (E,) float, model units
        Length of the boundary between the two; between cells of a solid its area.
    """

    first: Int32Array
    second: Int32Array
    lengths: FloatArray

    def __post_init__(self) -> None:
        for array in (self.first, self.second, self.lengths):
            frozen(array)

    def grouped(self, members: IntArray, values: FloatArray, n_groups: int) -> Links:
        """Links between groups of elements.

        Parameters
        ----------
        members : (F,) int
            The group of each element.
        values : (E,) float
            What to sum in place of the lengths.
        n_groups : int

        Examples
        --------
        >>> chain = Links(first=np.array([0, 1], np.int32), second=np.array([1, 2], np.int32),
        ...               lengths=np.array([2.0, 3.0]))
        >>> chain.grouped(np.array([0, 0, 1]), chain.lengths, 2).lengths.tolist()
        [3.0]
        """
        ends = np.stack([members[self.first], members[self.second]], axis=1)
        apart = ends[:, 0] != ends[:, 1]
        return _summed(ends[apart], values[apart], n_groups)


def _summed(pairs: IntArray, values: FloatArray, n_elements: int) -> Links:
    """Distinct pairs, in order, with the sums of their values."""
    low, high = pairs.min(axis=1, initial=n_elements), pairs.max(axis=1, initial=0)
    code, number = np.unique(low * n_elements + high, return_inverse=True)
    first, second = np.divmod(code, n_elements)
    return Links(
        first=first.astype(np.int32),
        second=second.astype(np.int32),
        lengths=np.bincount(number.reshape(-1), values, len(code)).astype(np.float64),
    )


def find_links(
    geometry: Geometry,
    adjacency: Adjacency,
    *,
    points: FloatArray,
    areas: FloatArray,
    places: FloatArray | None = None,
    near: bool = False,
) -> Links:
    """The links of a shape of input elements.

    Parameters
    ----------
    geometry : Geometry
        What tells which elements touch.
    adjacency : Adjacency
    points : (F, 3) float, model units
    areas : (F,) float
    places : (V, 3) float, optional
        Where the vertices of `geometry` are, if elsewhere (an embedding).
    near : bool
        Whether elements may be neighbours because they are near, so that links are counted.

    Examples
    --------
    >>> mesh = PolygonMesh.from_faces([[0, 0, 0], [3, 0, 0], [0, 4, 0], [3, 4, 0]],
    ...                               [[0, 1, 2], [1, 3, 2]])
    >>> from moseg_core.shape.adjacency import mesh_adjacency
    >>> find_links(mesh, mesh_adjacency(mesh), points=np.zeros((2, 3)),
    ...            areas=np.ones(2)).lengths.tolist()
    [5.0]
    """
    if isinstance(geometry, PolygonMesh) and not near:
        return _edge_links(geometry, geometry.vertices if places is None else places)
    pairs = adjacency.pairs[adjacency.pairs[:, 0] < adjacency.pairs[:, 1]]
    if isinstance(geometry, VoxelGrid) and geometry.solid and not near:
        cells = geometry.cells
        through = np.abs(cells[pairs[:, 0]] - cells[pairs[:, 1]]).argmax(axis=1)
        return _summed(pairs, geometry.side_areas[through], adjacency.n_elements)
    return _summed(pairs, _counted(pairs, points, areas), adjacency.n_elements)


def _edge_links(mesh: PolygonMesh, places: FloatArray) -> Links:
    """Links of polygons: the sum of the lengths of the edges that both have."""
    ends = mesh.edges[0]
    position = np.empty(int(mesh.merged.max()) + 1, np.int64)
    position[mesh.merged] = np.arange(len(mesh.merged))
    edge = undirected(ends)[0]
    lengths = np.linalg.norm(places[position[edge[:, 0]]] - places[position[edge[:, 1]]], axis=1)
    pairs, across = edge_pairs(mesh)
    apart = pairs[:, 0] != pairs[:, 1]
    return _summed(pairs[apart], lengths[across[apart]], mesh.n_polygons)


def _counted(pairs: IntArray, points: FloatArray, areas: FloatArray) -> FloatArray:
    """(E,) float: the length that each link stands for, by the Cauchy-Crofton formula."""
    apart = np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1)
    spacing = np.sqrt(areas)[pairs].mean(axis=1)
    crossed = 2.0 / np.pi * float((spacing * apart).sum())
    length: FloatArray = spacing * (float(areas.sum()) / crossed if crossed > 0 else 0.0)
    return length
