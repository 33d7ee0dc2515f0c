"""Voxel grids: elements that are cells of a regular grid.

Two readings of the same grid. As a *solid*, every occupied cell is an element, and a part is a
piece of the solid: its measures are those of the volume. As a *surface*, only cells with an
exposed face, one behind which the grid is empty, are elements, and each stands for its exposed
squares; a part is a piece of the staircase that bounds the solid. Directions are sampled by the
grid: of a slope the staircase has up to sqrt(3) times the area, equally in all its parts that are
inclined alike.

Cells are numbered in C order, the last index runs fastest. From a cell to the next along axis ``a``
of the array it is one step ``steps[a]``, a vector: a cell's index times the steps, added to the
origin, is its first corner. So cells are cubes, boxes, or, where a scanner was tilted, boxes at an
angle to the coordinates; what is measured of them holds for any three steps that span a space.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal, get_args

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError, UsageError, unknown
from moseg_core.shape.cell_corners import NOTHING, corner_numbers, outer_points, used_points
from moseg_core.shape.geometry import ARRAYS, FARTHEST, Geometry
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen

Elements = Literal["solid", "surface"]

_MADE = (*ARRAYS, "cells")
_OTHERS = ((1, 2), (0, 2), (0, 1))
_SMALLEST = 1e-50
_OTHER = NOTHING - 1  # an element of no group


@dataclass(frozen=True, eq=False, kw_only=True)
class VoxelGrid(Geometry):
    """Occupied cells of a regular grid.

    Build one with :meth:`from_occupied`.

    Parameters
    ----------
    vertices, corners, offsets, triangles, triangle_polygon
        As in :class:`~moseg_core.shape.geometry.Geometry`: the eight corners of every element, and
        two triangles for each of its exposed faces, which show their outer side.
    occupied : (nx, ny, nz) bool
        The whole grid, cells that are no elements included.
    cells : (F, 3) int
        The index of each element in the grid, in C order.
    steps : (3, 3) float, model units
        Row ``a`` goes from a cell to the next along axis ``a`` of the array: three edges of a cell.
    origin : (3,) float, model units
        First corner of the cell (0, 0, 0), from which its edges go; the least one, unless a step
        goes down.
    elements : {"solid", "surface"}
        Whether all occupied cells are elements, or those with an exposed face.
    header : mapping of str to any
        What the file said of the grid beside that, for a writer of the same format.
    """

    noun: ClassVar[str] = "cell"
    kind: ClassVar[str] = "voxel grid"

    occupied: BoolArray
    cells: IntArray
    steps: FloatArray
    origin: FloatArray
    elements: Elements
    header: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.cells is None:
            object.__delattr__(self, "cells")
        else:
            frozen(self.cells)
        for array in (self.occupied, self.steps, self.origin):
            frozen(array)

    def __getattr__(self, name: str) -> Any:
        # Asked only for what is not there: arrays of the elements, hundreds of bytes for each.
        if name not in _MADE or "elements" not in self.__dict__:
            raise AttributeError(f"'{type(self).__name__}' has no attribute '{name}'")
        made: dict[str, npt.NDArray[Any]]
        if name == "cells":
            made = {"cells": np.argwhere(self.is_element)}
        elif name == "offsets":
            made = {"offsets": 8 * np.arange(self.n_elements + 1)}
        elif name == "vertices":
            made = {"vertices": self.origin + _stepped(_indices(self._used_points), self.steps)}
        elif name == "corners":
            made = {"corners": np.concatenate([*self.corners_in_pieces()])}
        else:
            triangles, owner = _triangles(
                self.cells, self.corners.reshape(-1, 8), _exposed(self.occupied)
            )
            if np.linalg.det(self.steps) < 0:  # a mirror image: counter-clockwise is clockwise
                triangles = np.ascontiguousarray(triangles[:, ::-1])
            made = {"triangles": triangles, "triangle_polygon": owner}
        for key, array in made.items():
            object.__setattr__(self, key, frozen(array))
        return self.__dict__[name]

    @cached_property
    def is_element(self) -> BoolArray:
        """(nx, ny, nz) bool: which cells are elements."""
        if self.elements == "solid":
            return self.occupied
        return frozen(np.asarray(_exposed(self.occupied).any(axis=0)))

    @cached_property
    def n_elements(self) -> int:
        """Number of elements, F."""
        return int(np.count_nonzero(self.is_element))

    @property
    def used_vertices(self) -> FloatArray:
        """(V, 3) float, model units: all vertices, since each is a corner of an element."""
        return self.vertices

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """The least and the greatest coordinates of all corners, (3,) float each, model units."""
        if not np.array_equal(self.steps, np.diag(np.diag(self.steps))):
            return super().box
        rows = [np.flatnonzero(self.is_element.any(axis=_OTHERS[axis])) for axis in range(3)]
        ends = np.array([[row[0] for row in rows], [row[-1] + 1 for row in rows]])
        places = self.origin + _stepped(ends, self.steps)
        return places.min(axis=0), places.max(axis=0)

    @classmethod
    def from_occupied(
        cls,
        occupied: npt.ArrayLike,
        *,
        pitch: npt.ArrayLike = 1.0,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        elements: Elements = "solid",
        notes: Iterable[str] = (),
        header: Mapping[str, Any] | None = None,
    ) -> VoxelGrid:
        """Check a grid and find the exposed faces of its cells.

        Parameters
        ----------
        occupied : (nx, ny, nz) array_like of bool
        pitch : float, (3,) or (3, 3) array_like of float, model units
            The side of cubes, the sides of boxes along x, y and z, or as rows the steps.
        origin : (3,) array_like of float, model units
        elements : {"solid", "surface"}
        notes : iterable of str
        header : mapping of str to any, optional

        Raises
        ------
        ShapeError
            Not a grid in three dimensions, no occupied cell, or a pitch or origin that makes no
            sense.
        UsageError
            Other elements.

        Examples
        --------
        >>> block = np.ones((3, 3, 3), bool)
        >>> solid, surface = (VoxelGrid.from_occupied(block, elements=kind)
        ...                   for kind in ("solid", "surface"))
        >>> solid.n_elements, surface.n_elements, len(surface.triangles)
        (27, 26, 108)
        >>> VoxelGrid.from_occupied(block, pitch=(0.5, 0.5, 1)).volume
        6.75
        """
        filled = np.array(occupied)
        if filled.ndim != 3 or filled.dtype != np.bool_:
            raise ShapeError(
                f"a voxel grid is a (nx, ny, nz) array of bool, not of {filled.dtype} of shape"
                f" {filled.shape}"
            )
        if not filled.any():
            raise ShapeError(f"none of the {filled.size} cells of the grid is occupied")
        steps = _steps(pitch)
        try:
            corner = np.array(origin, np.float64)
        except (TypeError, ValueError):
            corner = np.empty(0)
        if steps is None or corner.shape != (3,) or not np.isfinite(corner).all():
            raise ShapeError(
                f"a grid needs a positive pitch, one number or three, and three coordinates of its"
                f" origin, not {pitch!r:.80} and {origin!r:.80}"
            )
        if elements not in get_args(Elements):
            raise UsageError(unknown("kind of elements", str(elements), get_args(Elements)))
        _refuse_unmeasurable(filled.shape, steps, corner)
        return cls(
            **dict.fromkeys(_MADE),  # type: ignore[arg-type]  # made when they are asked for
            occupied=filled,
            steps=steps,
            origin=corner,
            elements=elements,
            notes=tuple(notes),
            header=dict(header or {}),
        )

    @property
    def solid(self) -> bool:
        """Whether the elements fill a solid, rather than cover a surface."""
        return self.elements == "solid"

    @property
    def volume(self) -> float:
        """Volume of all occupied cells, model units cubed."""
        return float(np.count_nonzero(self.occupied)) * self.cell_volume

    @property
    def pitch(self) -> FloatArray:
        """(3,) float, model units: the sides of a cell, along the axes of the array."""
        lengths: FloatArray = np.linalg.norm(self.steps, axis=1)
        return lengths

    @property
    def cell_volume(self) -> float:
        """Volume of a cell, model units cubed."""
        x, y, z = self.steps
        return abs(float(x @ np.cross(y, z)))

    @property
    def side_areas(self) -> FloatArray:
        """(3,) float, model units squared: area of the side of a cell that a step goes through."""
        following = np.cross(self.steps[[1, 2, 0]], self.steps[[2, 0, 1]])
        areas: FloatArray = np.linalg.norm(following, axis=1)
        return areas

    @cached_property
    def centers(self) -> FloatArray:
        """(F, 3) float, model units: the middle of each element."""
        made = self.__dict__.get("cells")
        cells = np.argwhere(self.is_element) if made is None else made
        return frozen(self.origin + _stepped(cells + 0.5, self.steps))

    @property
    def _used_points(self) -> BoolArray:
        """(nx + 1, ny + 1, nz + 1) bool: the lattice points that are vertices."""
        return used_points(self.is_element)

    def corners_in_pieces(self) -> Iterator[IntArray]:
        """The corners of all elements, a stretch of them at a time; they are not kept."""
        if "corners" in self.__dict__:
            yield self.corners
        else:
            yield from (rows.reshape(-1) for rows in corner_numbers(self.is_element))

    def used_by(self, elements: IntArray) -> BoolArray:
        """(V,) bool: the vertices that some elements have."""
        chosen = np.zeros(self.n_elements, np.bool_)
        chosen[elements] = True
        used: BoolArray = used_points(self.spread(chosen, 0))[self._used_points]
        return used

    def outer_corners(self, groups: IntArray) -> tuple[IntArray, IntArray]:
        """Vertices of groups of elements, without those between two others next to them."""
        return outer_points(self.spread(np.where(groups < 0, _OTHER, groups), NOTHING))

    def spread(self, values: npt.NDArray[Any], rest: int) -> npt.NDArray[Any]:
        """(nx, ny, nz): one value for each element at its place in the grid, else `rest`.

        Parameters
        ----------
        values : (F,) of any type
        rest : int
            What stands where there is no element.

        Examples
        --------
        >>> bar = VoxelGrid.from_occupied(np.array([[[True, False, True]]]))
        >>> bar.spread(np.array([7, 8]), -1).tolist()
        [[[7, -1, 8]]]
        """
        grid = np.full(self.occupied.shape, rest, values.dtype)
        grid[self.is_element] = values
        return grid


def _steps(pitch: npt.ArrayLike) -> FloatArray | None:
    """(3, 3) float: the steps that a pitch stands for; None where it makes no sense."""
    try:
        given = np.array(pitch, np.float64)
    except (TypeError, ValueError):
        return None
    if given.shape not in ((), (3,), (3, 3)) or not np.isfinite(given).all():
        return None
    if given.shape == (3, 3):
        sides = np.linalg.norm(given, axis=1)
        # Steps that lie in a plane, but for rounding, span no cell.
        spans = abs(np.linalg.det(given)) > 1e-9 * sides.prod()
        return given if spans and (sides > 0).all() else None
    sides = np.broadcast_to(given, 3)
    return np.diag(sides) if (sides > 0).all() else None


def _refuse_unmeasurable(shape: tuple[int, ...], steps: FloatArray, corner: FloatArray) -> None:
    """Refuse cells whose volume or place is no number that can be computed with."""
    sides = np.abs(steps).max(axis=1)
    reach = float((np.abs(corner) + np.abs(steps).T @ np.array(shape)).max())
    if not sides.min() >= _SMALLEST or not reach <= FARTHEST:
        raise ShapeError(
            f"cells with sides of {', '.join(f'{side:.3g}' for side in sides)}, the grid's origin"
            f" at {corner.tolist()}, are beyond what can be measured; repair or rescale the grid"
        )
    if sides.min() <= 8.0 * np.finfo(np.float64).eps * reach:
        raise ShapeError(
            f"cells with sides of {sides.min():.3g} cannot be told apart at {corner.tolist()}, so"
            " far from the origin; repair the grid's place"
        )


def _stepped(places: npt.NDArray[Any], steps: FloatArray) -> FloatArray:
    """(n, 3) float: places in cells as places in space, from the grid's origin."""
    sides = np.diag(steps)
    if np.array_equal(steps, np.diag(sides)):  # as nearly always; and 0 times others adds nothing
        return places * sides
    stepped: FloatArray = places @ steps
    return stepped


def _exposed(filled: BoolArray) -> BoolArray:
    """(6, nx, ny, nz) bool: faces with nothing behind them; along each axis first the lower one."""
    faces = np.empty((6, *filled.shape), np.bool_)
    for axis in range(3):
        along, lower = np.moveaxis(filled, axis, 0), np.moveaxis(faces[2 * axis], axis, 0)
        upper = np.moveaxis(faces[2 * axis + 1], axis, 0)
        lower[0], upper[-1] = along[0], along[-1]
        np.greater(along[1:], along[:-1], out=lower[1:])
        np.greater(along[:-1], along[1:], out=upper[:-1])
    return faces


def _indices(points: BoolArray) -> IntArray:
    """(n, 3) int: where in an array true values are, in C order, a row for each."""
    return np.stack(np.nonzero(points), axis=1)


def _triangles(cells: IntArray, corners: IntArray, exposed: BoolArray) -> tuple[IntArray, IntArray]:
    """Two triangles for each exposed face, counter-clockwise from outside; the cell of each."""
    triangles, owners = [], []
    for face, shown in enumerate(exposed):
        axis, upper = divmod(face, 2)
        chosen = np.flatnonzero(shown[tuple(cells.T)])
        # The bits of a corner's number are its places along x, y and z.
        along, first, second = 4 >> axis, 4 >> (axis + 1) % 3, 4 >> (axis + 2) % 3
        base = along * upper
        ring = np.array([base, base + first, base + first + second, base + second])
        ring = ring if upper else ring[::-1]
        quad = corners[chosen][:, ring]
        triangles += [quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]]
        owners += [chosen, chosen]
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(triangles)[order], owner[order]
