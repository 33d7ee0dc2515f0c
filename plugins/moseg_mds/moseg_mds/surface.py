"""The surface that distances are measured on: each position once, and in one piece.

A shape's file may repeat a vertex for every face (STL), or along a seam of its texture; on the
surface these are one point. Positions are numbered in the order of their coordinates, so that it
does not matter how a file repeats them. Faces that have shrunk to a point, and vertices that no
face uses, belong to no surface: they get the place of the nearest point that does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph
from scipy.spatial import KDTree

from moseg_core import Shape, ShapeError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Surface:
    """A connected triangle mesh in which every vertex is used, and no position is repeated.

    Parameters
    ----------
    vertices : (N, 3) float
        In unit coordinates: the box of the shape has its centre at 0 and the diagonal 1.
    triangles : (T, 3) int
        Of no repeated triangle and none with a single position; two of three may coincide.
    origin : (V,) int
        For each vertex of the shape, the vertex here that stands for it.
    """

    vertices: FloatArray
    triangles: IntArray
    origin: IntArray

    @classmethod
    def of(cls, shape: Shape) -> Surface:
        """Weld a shape.

        Raises
        ------
        ShapeError
            It is no mesh, or in several pieces, between which there is no distance along the
            surface.

        Examples
        --------
        Two triangles that share a side, each with vertices of its own:

        >>> shape = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0],
        ...                          [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [3, 4, 5]])
        >>> surface = Surface.of(shape)
        >>> len(surface.vertices), surface.origin.tolist()
        (4, [0, 2, 1, 2, 3, 1])
        """
        if shape.noun != "face":
            raise ShapeError(
                f"'{shape.name}' is a {shape.geometry.kind}; only a polygon mesh can be unfolded"
            )
        merged = shape.geometry.merged
        positions = np.empty((int(merged.max()) + 1, 3))
        positions[merged] = shape.frame.to_unit(shape.geometry.vertices)
        triangles = _distinct(merged[shape.geometry.triangles])
        kept = _kept_positions(triangles, len(positions), shape.name)
        triangles = triangles[kept[triangles[:, 0]]]
        number = np.cumsum(kept) - 1
        if not kept.all():
            nearest = KDTree(positions[kept]).query(positions[~kept])[1]
            number[~kept] = nearest
        return cls(positions[kept], number[triangles], number[merged])


def _distinct(triangles: IntArray) -> IntArray:
    """The triangles, in an order of their own, each once and none that is a point."""
    point = (triangles == triangles[:, :1]).all(axis=1)
    triangles = triangles[~point]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    # Sorted by their corners, so that the order of faces in the file does not matter either.
    return triangles[first]


def _kept_positions(triangles: IntArray, size: int, name: str) -> npt.NDArray[np.bool_]:
    """(size,) bool: the positions of the one piece that has triangles; or a ShapeError."""
    rows = triangles[:, [0, 1, 2]].reshape(-1)
    columns = triangles[:, [1, 2, 0]].reshape(-1)
    graph = sparse.coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(size, size))
    _, piece = csgraph.connected_components(graph, directed=False)
    real = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    pieces, sizes = np.unique(piece[real[:, 0]], return_counts=True)
    if len(pieces) > 1:
        raise ShapeError(
            f"'{name}' cannot be embedded: it is in {len(pieces)} pieces that do not touch (the"
            f" largest has {int(sizes.max())} of {int(sizes.sum())} triangles), and there is no"
            f" way along the surface from one to another; join them, keep one of them, or do"
            f" without the embedding"
        )
    return np.asarray(piece == pieces[0])
