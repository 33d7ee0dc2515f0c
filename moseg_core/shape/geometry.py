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

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from moseg_core.shape.positions import Positions, find_positions
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen

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
    def used_vertices(self) -> FloatArray:
        """(v, 3) float, model units: the vertices that some element has."""
        used = np.zeros(len(self.vertices), np.bool_)
        used[self.corners] = True
        return self.vertices[used]

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest coordinates of all corners, (3,) float each, model units."""
        used = self.vertices[self.corners]
        return used.min(axis=0), used.max(axis=0)

    def corners_in_pieces(self) -> Iterator[IntArray]:
        """The corners of all elements, a stretch of them at a time."""
        yield self.corners

    def used_by(self, elements: IntArray) -> BoolArray:
        """(V,) bool: the vertices that some elements have.

        Parameters
        ----------
        elements : (k,) int
        """
        used = np.zeros(len(self.vertices), np.bool_)
        if self.is_triangular:
            used[self.triangles[elements]] = True
        else:
            used[self.corners[ranges(self.offsets, elements)]] = True
        return used

    def outer_corners(self, groups: IntArray) -> tuple[IntArray, IntArray]:
        """Vertices of groups of elements, among them all corners of the groups' convex hulls.

        Parameters
        ----------
        groups : (F,) int
            The group of each element; of one below 0 nothing is said.

        Returns
        -------
        group, vertex : (k,) int
            Pairs in any order, maybe several times.
        """
        group, vertex = np.repeat(groups, np.diff(self.offsets)), self.corners
        asked = group >= 0
        return (group, vertex) if asked.all() else (group[asked], vertex[asked])

    @cached_property
    def merged(self) -> IntArray:
        """(V,) int: number of each vertex's position (:mod:`moseg_core.shape.positions`)."""
        return self._positions.number

    @cached_property
    def _positions(self) -> Positions:
        """Which vertices are at one position."""
        return find_positions(self.vertices)


def ranges(starts: IntArray, rows: IntArray) -> IntArray:
    """The numbers ``starts[r]`` to ``starts[r + 1] - 1`` of some rows, one row after the other.

    Examples
    --------
    >>> ranges(np.array([0, 2, 2, 5]), np.array([2, 0])).tolist()
    [2, 3, 4, 0, 1]
    """
    sizes = starts[rows + 1] - starts[rows]
    before = np.cumsum(sizes) - sizes
    found: IntArray = np.arange(int(sizes.sum())) + np.repeat(starts[rows] - before, sizes)
    return found
