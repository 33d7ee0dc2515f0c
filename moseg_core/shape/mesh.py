"""Polygon meshes: the geometry that the user's file holds, face by face, in file order.

moseg gives one label to each *input polygon*. So a mesh keeps its polygons as they were read
(any number of corners each) beside a triangulation in which every triangle remembers the
polygon it came from. Areas, moments, hulls and pictures are computed on the triangles; labels,
adjacency and outputs are about the polygons.

Corners are joined by *position*, not by index: an STL file repeats every vertex, and an OBJ or
GLB file repeats those on a texture seam, yet the surface is one. Vertices nearer than a share of
the diagonal are at one position (:mod:`moseg_core.shape.positions`); none is moved.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.appearance import Appearance
from moseg_core.shape.geometry import FARTHEST, Geometry
from moseg_core.shape.positions import WELD, Positions, find_positions
from moseg_core.shape.triangulate import triangulate_polygons
from moseg_core.types import FloatArray, IntArray

MOST_WELD = 0.1
"""The largest share of the diagonal to join within; with more, parts would be one position."""

# Unless the user says how far, vertices are joined within so much of the size of most faces.
_APART = 0.01


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
    tolerance : float, model units
        How far vertices may lie apart and still be at one position.
    appearance : Appearance or None
        Texture coordinates, normals and materials of the polygons, where a reader kept them.
    """

    noun: ClassVar[str] = "face"
    kind: ClassVar[str] = "polygon mesh"

    tolerance: float = 0.0
    appearance: Appearance | None = None

    @classmethod
    def from_faces(
        cls,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike | Iterable[Sequence[int]],
        *,
        weld: float = WELD,
        notes: Iterable[str] = (),
    ) -> PolygonMesh:
        """Check vertices and faces, and triangulate what has more than three corners.

        Parameters
        ----------
        vertices : (V, 3) array_like of float
        faces : (F, k) array_like of int, or an iterable of sequences of vertex indices
            Zero-based; polygons of three or more corners, in any mix.
        weld : float
            How far vertices may lie apart and still be at one position, as a share of the
            diagonal of the bounding box; 0 joins only those that are equal. By default never
            more than a hundredth of the size of most faces.
        notes : iterable of str
            What was passed over or repaired on the way.

        Raises
        ------
        ShapeError
            No vertices or faces, wrong array shapes, a face with fewer than three corners, one
            that names a vertex that does not exist or one whose coordinates are not finite.
            Vertices that no face uses are not looked at.
        UsageError
            A tolerance that is no share from 0 to 0.1.

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
        points, found = _looked_at(points, corners)
        triangles, triangle_polygon = triangulate_polygons(points, corners, offsets)
        mesh = cls(
            vertices=points,
            corners=corners,
            offsets=offsets,
            triangles=triangles,
            triangle_polygon=triangle_polygon,
            notes=(*notes, *found),
        )
        if weld == WELD:  # the shape may be in pieces that are small and far apart
            typical = _typical_size(points, triangles)
            if 0.0 < _APART * typical < weld * mesh.diagonal:
                weld = _APART * typical / mesh.diagonal
        return mesh.welded(weld)

    def welded(self, weld: float) -> PolygonMesh:
        """The same polygons, joined within another share of the diagonal; see :meth:`from_faces`.

        Raises
        ------
        UsageError
            No share from 0 to 0.1.
        """
        return replace(self, tolerance=checked_weld(weld) * self.diagonal)

    @property
    def diagonal(self) -> float:
        """Of the bounding box of all corners, model units."""
        return math.hypot(*np.ptp(self.vertices[self.corners], axis=0))

    @property
    def n_near(self) -> int:
        """How many different places of faces were joined with another because they are near."""
        return self._positions.n_near

    @cached_property
    def _positions(self) -> Positions:
        used = np.zeros(len(self.vertices), np.bool_)
        used[self.corners] = True
        if used.all():
            return find_positions(self.vertices, self.tolerance)
        found = find_positions(self.vertices[used], self.tolerance)
        # Vertices that no face uses are joined among themselves, and numbered behind the others.
        idle = find_positions(self.vertices[~used]).number
        number = np.empty(len(used), np.int64)
        number[used] = found.number
        number[~used] = idle + int(found.number.max()) + 1
        return Positions(number, found.n_near)

    @property
    def n_polygons(self) -> int:
        """Number of input polygons, F."""
        return self.n_elements

    @property
    def is_triangular(self) -> bool:
        """Whether every polygon is a triangle, so that triangles and polygons coincide."""
        return len(self.triangles) == self.n_polygons

    @property
    def triangle_corners(self) -> IntArray:
        """(T, 3) int: for each corner of each triangle its place in :attr:`corners`.

        Examples
        --------
        >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
        ...                                 [[1, 2, 3, 0]])
        >>> square.corners[square.triangle_corners].tolist() == square.triangles.tolist()
        True
        """
        if self.is_triangular:
            return np.arange(len(self.corners)).reshape(-1, 3)
        polygon = np.repeat(np.arange(self.n_polygons), np.diff(self.offsets))
        # Corners in the order of their polygon and vertex, in which a triangle's are looked up.
        code = polygon * len(self.vertices) + self.corners
        order = np.argsort(code, kind="stable")
        wanted = self.triangle_polygon[:, None] * len(self.vertices) + self.triangles
        place: IntArray = order[np.searchsorted(code[order], wanted)]
        return place

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


def _typical_size(vertices: FloatArray, triangles: IntArray) -> float:
    """The size of most triangles: the median of the longer sides of their boxes; 0 for none.

    Of many triangles some ten thousand are looked at.
    """
    some = vertices[triangles[:: max(1, len(triangles) // 10_000)]]
    sizes = np.ptp(some, axis=1).max(axis=1)
    return float(np.median(sizes[sizes > 0.0])) if sizes.any() else 0.0


def checked_weld(weld: float) -> float:
    """A share of the diagonal within which vertices are joined.

    Raises
    ------
    UsageError
        It is no number from 0 to 0.1.
    """
    if not 0.0 <= weld <= MOST_WELD:
        raise UsageError(
            f"vertices are joined within a share of the diagonal from 0 to {MOST_WELD},"
            f" such as {WELD:g}, not {weld!r}"
        )
    return weld


def _looked_at(points: FloatArray, corners: IntArray) -> tuple[FloatArray, list[str]]:
    """The vertices, those aside that no face uses and nobody could measure; and what to say."""
    if max(points.max(), -points.min()) <= FARTHEST:
        return points, []
    measurable = (np.abs(points) <= FARTHEST).all(axis=1)  # not so what is no number
    used = np.zeros(len(points), np.bool_)
    used[corners] = True
    wrong = used & ~np.isfinite(points).all(axis=1)
    if wrong.any():
        vertex = int(np.argmax(wrong))
        raise ShapeError(
            f"vertex {vertex} is not finite: {points[vertex].tolist()}"
            f" ({int(wrong.sum())} such in all); repair the file first"
        )
    idle = ~measurable & ~used
    if not idle.any():
        return points, []
    points[idle] = points[corners[0]]
    return points, [
        f"vertices without a place, used by no face: {int(idle.sum())}; they are not looked at"
    ]


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
