"""Point clouds: elements that are points, each standing for a piece of surface around it.

A cloud says where its surface is and not how much of it belongs to a point, nor which points are
neighbours. The first is estimated here, since measures of parts are weighted by area; the second
is left open unless the user asks (:func:`moseg_core.shape.adjacency.near_pairs`).

**Areas.** Where points lie on a surface with the density ``rho``, a disc of radius ``r`` holds
``rho pi r^2`` of them, and the squared distance ``r_j^2`` to the ``j``-th nearest is ``j / (rho
pi)`` in the mean. With the K nearest together, ``1 / rho = pi sum r_j^2 / sum j``, which is
unbiased for random points in a plane, 5 % high on a square lattice and 21 % on a hexagonal
one. Only ratios of areas matter to objectives. A single point's estimate has a standard deviation
of 0.4, of which little is left in the sum over a part. The estimate is wrong where the surface is
not a plane over the distance of K points: too large within that distance of an open edge, too
small where two sheets are nearer to each other than that.

**Points that are not finite.** Scanners write a point without a place where nothing came back. Such
a point stays an element, so that labels keep their rows. It stands in the place of the last point
before it that has one (of the first, where none is before) and carries no weight.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.geometry import FARTHEST, Geometry
from moseg_core.shape.nearest import nearest_points
from moseg_core.shape.positions import find_positions
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen

_NEAREST = 8


@dataclass(frozen=True, eq=False, kw_only=True)
class PointCloud(Geometry):
    """Points on a surface.

    Build one with :meth:`from_points`.

    Parameters
    ----------
    vertices, corners, offsets, triangles, triangle_polygon
        As in :class:`~moseg_core.shape.geometry.Geometry`: the points, one corner each, no
        triangles.
    areas : (F,) float, model units squared
        How much surface each point stands for.
    normals : (F, 3) float or None
        Directions away from the surface, of any length; None where they are not known.
    stand_in : (F,) int or None
        For each point that is not finite the one in whose place it stands, for others themselves;
        None where all are finite.
    """

    noun: ClassVar[str] = "point"
    kind: ClassVar[str] = "point cloud"

    areas: FloatArray
    normals: FloatArray | None = None
    stand_in: IntArray | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        frozen(self.areas)
        if self.normals is not None:
            frozen(self.normals)

    @classmethod
    def from_points(
        cls,
        points: npt.ArrayLike,
        *,
        areas: npt.ArrayLike | None = None,
        normals: npt.ArrayLike | None = None,
        notes: Iterable[str] = (),
    ) -> PointCloud:
        """Check points and what is known of them; estimate areas that are not given.

        Parameters
        ----------
        points : (F, 3) array_like of float, model units
        areas : (F,) array_like of float, model units squared, optional
        normals : (F, 3) array_like of float, optional
        notes : iterable of str
            What was passed over or repaired on the way.

        Raises
        ------
        ShapeError
            Arrays of other shapes, no point that is finite, negative areas, or none at all.

        Examples
        --------
        >>> corner = PointCloud.from_points([[0, 0, 0], [np.nan, 0, 0], [1, 0, 0], [0, 1, 0]])
        >>> corner.n_elements, len(corner.triangles), float(corner.areas[1])
        (4, 0, 0.0)
        """
        places = _rows("points", points)
        finite = np.asarray(np.isfinite(places).all(axis=1))
        if not finite.any():
            raise ShapeError("no point is finite: there is no surface to segment")
        stand_in = None
        notes = list(notes)
        if not finite.all():
            stand_in = _stand_ins(finite)
            places = places[stand_in]
            notes.append(
                f"points that are not finite: {int((~finite).sum())}; they keep their rows and"
                f" carry no weight"
            )
        if areas is None:
            weights = np.zeros(len(places))
            weights[finite] = _areas(places[finite])
        else:
            weights = np.where(finite, _finite("areas", areas, finite, notes), 0.0)
            if (weights < 0).any() or not weights.any():
                raise ShapeError("areas of points must not be negative, and not all of them 0")
            if weights.max() > FARTHEST**2:
                raise ShapeError(
                    f"the area of point {int(weights.argmax())} is {weights.max():g}, beyond what"
                    " can be measured; repair or rescale the areas first"
                )
        return cls(
            vertices=places,
            corners=np.arange(len(places)),
            offsets=np.arange(len(places) + 1),
            triangles=np.empty((0, 3), np.int64),
            triangle_polygon=np.empty(0, np.int64),
            areas=weights,
            normals=None if normals is None else _finite("normals", normals, finite, notes),
            stand_in=stand_in,
            notes=tuple(notes),
        )

    @property
    def n_unplaced(self) -> int:
        """How many points are not finite."""
        return 0 if self.stand_in is None else int((self.stand_in != self.corners).sum())


def estimated_areas(points: FloatArray, nearest: int = _NEAREST) -> FloatArray:
    """How much surface each point stands for, from the distances to its nearest neighbours.

    Parameters
    ----------
    points : (F, 3) float, model units
    nearest : int
        How many neighbours to look at.

    Returns
    -------
    (F,) float, model units squared
        0 for a point with so many others in its very place.

    Examples
    --------
    A square lattice of spacing 2, away from its edges:

    >>> x, y = np.meshgrid(np.arange(9.0), np.arange(9.0))
    >>> lattice = 2 * np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    >>> round(float(estimated_areas(lattice)[40]), 2)
    4.19
    """
    near = min(nearest, len(points) - 1)
    if near < 1:
        return np.zeros(len(points))
    distances = nearest_points(points, near + 1)[0][:, 1:]
    areas: FloatArray = np.pi * (distances**2).sum(axis=1) / (near * (near + 1) / 2)
    return areas


def _areas(places: FloatArray) -> FloatArray:
    """Estimates for all points, not all of them 0.

    Where all have so many others in their very place that nothing is left to any, those in one
    place share what the place stands for.
    """
    areas = estimated_areas(places)
    if areas.any():
        return areas
    number = find_positions(places).number
    first = np.unique(number, return_index=True)[1]
    if len(first) < 2:
        raise ShapeError("all points are in one place: there is no surface to segment")
    shared: FloatArray = (estimated_areas(places[first]) / np.bincount(number))[number]
    return shared


def _stand_ins(finite: BoolArray) -> IntArray:
    """(F,) int: the last finite point up to each, or the first where there is none."""
    last = np.maximum.accumulate(np.where(finite, np.arange(len(finite)), -1))
    return np.where(last < 0, np.argmax(finite), last)


def _finite(what: str, given: npt.ArrayLike, placed: BoolArray, notes: list[str]) -> FloatArray:
    """The array, with 0 in rows that are not finite; says so of points that have a place."""
    array = _rows(what, given, len(placed))
    wrong = ~np.isfinite(array.reshape(len(placed), -1)).all(axis=1)
    array[wrong] = 0.0
    if count := int((wrong & placed).sum()):
        notes.append(f"{what} that are not finite: {count}; they are taken to be 0")
    return array


def _rows(what: str, given: npt.ArrayLike, count: int | None = None) -> FloatArray:
    """The array as floats: (F, 3), or (F,) for areas."""
    tail = () if what == "areas" else (3,)
    try:
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ShapeError(f"{what} must be an array of numbers: {error}") from error
    if array.size == 0:
        raise ShapeError(f"the cloud has no {what}")
    wanted = "F" if count is None else str(count)
    if array.ndim == 0 or array.shape[1:] != tail or count not in (None, len(array)):
        expected = f"({wanted}, 3)" if tail else f"({wanted},)"
        raise ShapeError(f"{what} must have the shape {expected}, not {array.shape}")
    return array
