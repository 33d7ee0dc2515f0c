"""A tree of boxes over triangles or points, so that winding numbers are cheap far away.

Every box holds the dipole of its pieces (Barill et al. 2018, doi:10.1145/3197517.3201337, first
order); :mod:`moseg_core.shape.volume.winding` walks down the tree only where a query is near.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.volume.winding import winding_numbers
from moseg_core.types import FloatArray, IntArray

#: Pieces in a box that is not divided any more.
_LEAF = 8

#: A box is seen as one dipole from more than so many radii.
_FAR = 2.0

#: Length over which a point's pull is blunted, in units of the root of its area.
_SOFT = 0.1


@dataclass(frozen=True, eq=False)
class WindingTree:
    """Pieces of surface in a tree of boxes, for winding numbers.

    The fields are described in :func:`moseg_core.shape.volume.winding.winding_numbers`.
    """

    places: FloatArray
    dipoles: FloatArray
    softening: FloatArray
    corners: FloatArray
    starts: IntArray
    stops: IntArray
    skips: IntArray
    box_places: FloatArray
    box_dipoles: FloatArray
    box_radii: FloatArray

    @classmethod
    def of(cls, geometry: Geometry) -> WindingTree:
        """The triangles of a geometry, or the points of a cloud, which has normals."""
        corners = np.ascontiguousarray(geometry.vertices[geometry.triangles])
        if isinstance(geometry, PointCloud):
            assert geometry.normals is not None  # asked for by the caller
            places, areas = geometry.vertices, geometry.areas
            length = np.linalg.norm(geometry.normals, axis=1)
            unit = geometry.normals / np.where(length > 0, length, 1.0)[:, None]
            dipoles, extent = areas[:, None] * unit, np.zeros(len(places))
        else:
            edges = corners - corners[:, :1]
            dipoles = np.cross(edges[:, 1], edges[:, 2]) / 2.0
            areas = np.linalg.norm(dipoles, axis=1)
            places = corners.mean(axis=1)
            extent = np.linalg.norm(corners - places[:, None], axis=2).max(axis=1)
        order, starts, stops, skips = _boxes(places)
        places, areas, extent = places[order], areas[order], extent[order]
        dipoles = dipoles[order]
        middles, sums = np.zeros((2, len(starts), 3))
        reach = np.zeros(len(starts))
        for box, (start, stop) in enumerate(zip(starts, stops, strict=True)):
            mine = slice(start, stop)
            weights = areas[mine]
            total = weights.sum()
            weights = weights / total if total > 0 else np.full(stop - start, 1 / (stop - start))
            middles[box] = weights @ places[mine]
            sums[box] = dipoles[mine].sum(axis=0)
            apart = np.linalg.norm(places[mine] - middles[box], axis=1) + extent[mine]
            reach[box] = apart.max()
        return cls(
            places=np.ascontiguousarray(places),
            dipoles=np.ascontiguousarray(dipoles),
            softening=_SOFT**2 * areas,
            corners=np.ascontiguousarray(corners[order]) if len(corners) else corners,
            starts=starts,
            stops=stops,
            skips=skips,
            box_places=middles,
            box_dipoles=sums,
            box_radii=reach,
        )

    def winding(self, queries: FloatArray, far: float = _FAR) -> FloatArray:
        """(Q,) float: winding numbers around (Q, 3) points; exact where `far` is infinite."""
        winding = np.empty(len(queries))
        winding_numbers(
            np.ascontiguousarray(queries),
            self.places,
            self.dipoles,
            self.softening,
            self.corners,
            self.starts,
            self.stops,
            self.skips,
            self.box_places,
            self.box_dipoles,
            self.box_radii,
            far,
            winding,
        )
        return winding


def _boxes(places: FloatArray) -> tuple[IntArray, IntArray, IntArray, IntArray]:
    """Halve the pieces along the longest side until few are left; boxes before what they hold.

    Returns
    -------
    order : (P,) int
        The pieces, those of a box next to each other.
    starts, stops : (B,) int
        The part of `order` that is in each box.
    skips : (B,) int
        The next box that is not within this one.
    """
    order = np.arange(len(places))
    starts: list[int] = []
    stops: list[int] = []
    skips: list[int] = []

    def divide(start: int, stop: int) -> None:
        box = len(starts)
        starts.append(start)
        stops.append(stop)
        skips.append(-1)
        if stop - start > _LEAF:
            mine = order[start:stop]
            axis = int(np.ptp(places[mine], axis=0).argmax())
            half = (stop - start) // 2
            order[start:stop] = mine[np.argpartition(places[mine, axis], half)]
            divide(start, start + half)
            divide(start + half, stop)
        skips[box] = len(starts)

    divide(0, len(places))
    return order, np.array(starts), np.array(stops), np.array(skips)
