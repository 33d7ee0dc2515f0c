"""What surface elements are made of: vertices, and pieces of surface where there are any (Sec. 4).

The paper partitions "mesh faces or point cloud points", and voxels the same way. Whatever the
elements are, the rest of moseg asks the same of them: which vertices each has, for hulls and
extents, and which triangles, for areas, distances and pictures. :class:`Geometry` answers that;
its kinds know how they were made and what else they hold:

- :class:`moseg_core.shape.mesh.PolygonMesh`: an element is a polygon;
- :class:`moseg_core.shape.cloud.PointCloud`: an element is a point, and there are no triangles;
- :class:`moseg_core.shape.voxels.VoxelGrid`: an element is a cell of a grid, and the triangles are
  those of its faces with nothing behind them.

A geometry has no areas, neighbours or volume: :mod:`moseg_core.shape.moments` and
:mod:`moseg_core.shape.adjacency` make those from it, and :class:`moseg_core.shape.shape.Shape`
holds them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from moseg_core.shape.positions import Positions, find_positions
from moseg_core.types import FloatArray, IntArray, frozen

FARTHEST = 1e50
"""Coordinates up to which can be measured: fourth powers of them and a little more are floats."""

ARRAYS = ("vertices", "corners", "offsets", "triangles", "triangle_polygon")
"""The arrays that every geometry has. Kinds that can make them from less may do so when they are
first asked for; such a one is given None."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Geometry:
    """Elements over shared vertices, with the triangles that can be seen of them.

    Parameters
    ----------
    vertices : (V, 3) float, model units
    corners : (C,) int
        The vertex indices of all elements, one element after the other.
    offsets : (F + 1,) int
        Element ``f`` has the corners ``corners[offsets[f]:offsets[f + 1]]``.
    triangles : (T, 3) int
        Vertex indices; the triangles of one element follow each other, elements in order. Their
        corners are corners of the element.
    triangle_polygon : (T,) int
        The element that each triangle is a piece of; ascending.
    notes : tuple of str
        What a reader passed over or repaired to get here; a shape says it with its own notes.
    """

    noun: ClassVar[str] = "element"
    """What one element is called."""
    kind: ClassVar[str] = "surface"
    """What the whole is called."""

    vertices: FloatArray
    corners: IntArray
    offsets: IntArray
    triangles: IntArray
    triangle_polygon: IntArray
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in ARRAYS:
            array = getattr(self, name)
            if array is None:  # made when it is first asked for
                object.__delattr__(self, name)
            else:
                frozen(array)

    @property
    def n_elements(self) -> int:
        """Number of elements, F."""
        return len(self.offsets) - 1

    @property
    def solid(self) -> bool:
        """Whether the elements fill a solid, rather than cover a surface."""
        return False

    @property
    def is_triangular(self) -> bool:
        """Whether element ``f`` is triangle ``f``, and nothing else."""
        return False

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest coordinates of all corners, (3,) float each, model units."""
        used = self.vertices[self.corners]
        return used.min(axis=0), used.max(axis=0)

    @cached_property
    def merged(self) -> IntArray:
        """(V,) int: number of each vertex's position (:mod:`moseg_core.shape.positions`)."""
        return self._positions.number

    @cached_property
    def _positions(self) -> Positions:
        """Which vertices are at one position."""
        return find_positions(self.vertices)
