"""Polygon meshes: the geometry that the user's file holds, face by face, in file order.

moseg gives one label to each *input polygon*. So a mesh keeps its polygons as they were read
(any number of corners each) beside a triangulation in which every triangle remembers the
polygon it came from. Areas, moments, hulls and pictures are computed on the triangles; labels,
adjacency and outputs are about the polygons.

Corners are joined by *position*, not by index: an STL file repeats every vertex, and an OBJ or
GLB file repeats those on a texture seam, yet the surface is one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.triangulate import triangulate_polygons
from moseg_core.types import FloatArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class PolygonMesh(Geometry):
    """Polygons over shared vertices, with the triangles that they are cut into.

    Build one with :meth:`from_faces`.

    Parameters
    ----------
    vertices : (V, 3) float, model units
    corners : (C,) int
        The vertex indices of all polygons, one polygon after the other.
    offsets : (F + 1,) int
        Polygon ``f`` has the corners ``corners[offsets[f]:offsets[f + 1]]``.
    triangles : (T, 3) int
        Vertex indices; the triangles of one polygon follow each other, polygons in order.
    triangle_polygon : (T,) int
        The polygon that each triangle is a piece of; ascending.
    """

    noun: ClassVar[str] = "face"
    kind: ClassVar[str] = "polygon mesh"

    @classmethod
    def from_faces(
        cls,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike | Iterable[Sequence[int]],
        *,
        notes: Iterable[str] = (),
    ) -> PolygonMesh:
        """Check vertices and faces, and triangulate what has more than three corners.

        Parameters
        ----------
        vertices : (V, 3) array_like of float
        faces : (F, k) array_like of int, or an iterable of sequences of vertex indices
            Zero-based; polygons of three or more corners, in any mix.
        notes : iterable of str
            What was passed over or repaired on the way.

        Raises
        ------
        ShapeError
            No vertices or faces, wrong array shapes, a coordinate that is not finite, a face
            with fewer than three corners or one that names a vertex that does not exist.

        Examples
        --------
        >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
        ...                                 [[0, 1, 2, 3]])
        >>> square.n_polygons, len(square.triangles)
        (1, 2)
        """
        points = _vertex_array(vertices)
        corners, offsets = _corner_arrays(faces)
        if len(offsets) < 2:
            raise ShapeError("the mesh has no faces; moseg needs a surface to segment")
        sizes = np.diff(offsets)
        if sizes.min() < 3:
            face = int(np.argmax(sizes < 3))
            raise ShapeError(f"face {face} has {sizes[face]} corners; a face needs at least 3")
        outside = (corners < 0) | (corners >= len(points))
        if outside.any():
            corner = int(np.argmax(outside))
            face = int(np.searchsorted(offsets, corner, side="right")) - 1
            raise ShapeError(
                f"face {face} names vertex {corners[corner]}, but there are {len(points)} vertices"
                f" (numbered from 0)"
            )
        finite = np.isfinite(points).all(axis=1)
        if not finite.all():
            vertex = int(np.argmin(finite))
            raise ShapeError(
                f"vertex {vertex} is not finite: {points[vertex].tolist()}"
                f" ({int((~finite).sum())} such in all); repair the file first"
            )
        triangles, triangle_polygon = triangulate_polygons(points, corners, offsets)
        return cls(
            vertices=points,
            corners=corners,
            offsets=offsets,
            triangles=triangles,
            triangle_polygon=triangle_polygon,
            notes=tuple(notes),
        )

    @property
    def n_polygons(self) -> int:
        """Number of input polygons, F."""
        return self.n_elements

    @property
    def is_triangular(self) -> bool:
        """Whether every polygon is a triangle, so that triangles and polygons coincide."""
        return len(self.triangles) == self.n_polygons

    @cached_property
    def edges(self) -> tuple[IntArray, IntArray]:
        """The directed boundary edges of all polygons, as merged positions.

        Returns
        -------
        ends : (C, 2) int
            Start and end position of each edge; edges of no length are left out.
        polygon : (C,) int
            The polygon that each edge belongs to.
        """
        polygon = np.repeat(np.arange(self.n_polygons), np.diff(self.offsets))
        following = np.arange(1, len(self.corners) + 1)
        following[self.offsets[1:] - 1] = self.offsets[:-1]
        position = self.merged[self.corners]
        ends = np.stack([position, position[following]], axis=1)
        real = ends[:, 0] != ends[:, 1]
        return ends[real], polygon[real]


def _vertex_array(vertices: npt.ArrayLike) -> FloatArray:
    try:
        points = np.array(vertices, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ShapeError(f"vertices must be a (V, 3) array of numbers: {error}") from error
    if points.size == 0:
        raise ShapeError("the mesh has no vertices")
    if points.ndim != 2 or points.shape[1] != 3:
        raise ShapeError(f"vertices must have the shape (V, 3), not {points.shape}")
    return points


def _corner_arrays(
    faces: npt.ArrayLike | Iterable[Sequence[int]],
) -> tuple[IntArray, IntArray]:
    """Flatten faces of any kind into (corners, offsets)."""
    if isinstance(faces, np.ndarray):
        if faces.size == 0:
            return np.empty(0, np.int64), np.zeros(1, np.int64)
        if faces.ndim != 2 or not np.issubdtype(faces.dtype, np.integer):
            raise ShapeError(
                f"faces must be a (F, k) array of integers, not {faces.dtype} of shape"
                f" {faces.shape}"
            )
        offsets = np.arange(len(faces) + 1, dtype=np.int64) * faces.shape[1]
        return faces.astype(np.int64).reshape(-1), offsets
    try:
        rows = [list(face) for face in faces]  # type: ignore[union-attr, arg-type]  # caught below
    except TypeError as error:
        raise ShapeError("each face must be a sequence of vertex indices") from error
    offsets = np.zeros(len(rows) + 1, np.int64)
    np.cumsum([len(row) for row in rows], out=offsets[1:])
    corners = np.array([corner for row in rows for corner in row])
    if corners.size and not np.issubdtype(corners.dtype, np.integer):
        raise ShapeError("faces must hold vertex indices, that is integers")
    return corners.astype(np.int64), offsets
