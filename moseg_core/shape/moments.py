"""Areas, first and second moments of elements of every kind: what PCA is made of (Sec. 10).

The sums over a part of these three numbers give its area, centroid and covariance. Over a mesh
they are exact over every triangle, over a grid exact over every cell or exposed square. Of a
point cloud nothing is exact: a point stands for a small piece of surface around it, of which the
area is estimated (:func:`moseg_core.shape.cloud.estimated_areas`) and the extent is left out. That
extent would add ``area^2 / 4 pi`` along the surface to a second moment, for a part of N points
about a share ``1 / N`` of its own.

For elements that fill a solid, "area" is the volume of a cell: the same sums then give the
covariance of the solid.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import FloatArray

# xx, xy, xz, yy, yz, zz
_I, _J = np.array([0, 0, 0, 1, 1, 2]), np.array([0, 1, 2, 1, 2, 2])


@dataclass(frozen=True, eq=False)
class Moments:
    """What each element adds to the measures of a part.

    Parameters
    ----------
    points : (F, 3) float, model units
        Centroid of each element.
    areas : (F,) float, model units squared; cubed where elements fill a solid
    first : (F, 3) float
        Area times centroid, about the origin asked for.
    second : (F, 6) float
        xx, xy, xz, yy, yz, zz about that origin.
    """

    points: FloatArray
    areas: FloatArray
    first: FloatArray
    second: FloatArray


def element_moments(geometry: Geometry, origin: FloatArray) -> Moments:
    """The moments of every element.

    Parameters
    ----------
    geometry : Geometry
    origin : (3,) float, model units
        Moments are about this, and kept rather than derived from the centroids: those are
        rounded in the file's coordinates, which may lie far away.

    Examples
    --------
    >>> import numpy as np
    >>> from moseg_core.shape.voxels import VoxelGrid
    >>> cube = VoxelGrid.from_occupied(np.ones((1, 1, 1), bool), pitch=2.0)
    >>> moments = element_moments(cube, np.ones(3))
    >>> moments.areas.tolist(), moments.second[0, [0, 3, 5]].round(6).tolist()
    ([8.0], [2.666667, 2.666667, 2.666667])
    """
    if isinstance(geometry, PointCloud):
        return _of_points(geometry, origin)
    if geometry.solid:
        assert isinstance(geometry, VoxelGrid)  # the only kind of elements that fills a solid
        return _of_cells(geometry, origin)
    return _of_polygons(geometry, origin)


def _of_polygons(mesh: Geometry, origin: FloatArray) -> Moments:
    """Sums over the triangles of each element, of which there is at least one.

    Over a triangle with corners a, b, c and area A, ``int x x^T dA`` is
    ``A/12 (a a^T + b b^T + c c^T + s s^T)`` with ``s = a + b + c``.
    """
    corners = mesh.vertices[mesh.triangles] - origin
    edge1, edge2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area = np.linalg.norm(np.cross(edge1, edge2), axis=1) / 2.0
    total = corners.sum(axis=1)
    second = np.empty((len(area), 6))
    for k, (i, j) in enumerate(zip(_I, _J, strict=True)):
        # Column by column: to gather all products of all corners takes longer than to sum them.
        a, b, c = (corners[:, corner, i] * corners[:, corner, j] for corner in range(3))
        second[:, k] = (a + b + c + total[:, i] * total[:, j]) * (area / 12.0)
    first = total * area[:, None] / 3.0
    middle = total / 3.0

    if mesh.is_triangular:
        with np.errstate(invalid="ignore", divide="ignore"):
            points = np.where(area[:, None] > 0, first / area[:, None], middle)
        return Moments(points + origin, area, first, second)
    starts = np.searchsorted(mesh.triangle_polygon, np.arange(mesh.n_elements))
    areas = np.add.reduceat(area, starts)
    first = np.add.reduceat(first, starts, axis=0)
    # A polygon of no area has no centroid by area: the mean of its triangles' stands in.
    count = np.diff(np.append(starts, len(area)))
    mean = np.add.reduceat(middle, starts, axis=0) / count[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        points = np.where(areas[:, None] > 0, first / areas[:, None], mean)
    return Moments(points + origin, areas, first, np.add.reduceat(second, starts, axis=0))


def _of_points(cloud: PointCloud, origin: FloatArray) -> Moments:
    """Each point with its area, all of it in one place."""
    local = cloud.vertices - origin
    first = cloud.areas[:, None] * local
    return Moments(cloud.vertices.copy(), cloud.areas.copy(), first, first[:, _I] * local[:, _J])


def _of_cells(grid: VoxelGrid, origin: FloatArray) -> Moments:
    """Volumes of cells, all of one volume V and with the same three edges e.

    Over one around c ``int x x^T`` is ``V (c c^T + sum e e^T / 12)``; for a cube of side h the sum
    is ``h^2`` times the identity.
    """
    return Moments(
        points=cell_measure(grid, origin, "points"),
        areas=cell_measure(grid, origin, "areas"),
        first=cell_measure(grid, origin, "first"),
        second=cell_measure(grid, origin, "second"),
    )


def cell_measure(
    grid: VoxelGrid, origin: FloatArray, what: Literal["points", "areas", "first", "second"]
) -> FloatArray:
    """One of the moments of the cells of a solid (:class:`Moments`), without the others.

    Parameters
    ----------
    grid : VoxelGrid
    origin : (3,) float, model units
    what : {"points", "areas", "first", "second"}
    """
    volume = grid.cell_volume
    if what == "areas":
        return np.full(grid.n_elements, volume)
    if what == "points":
        return grid.centers
    local = grid.centers - origin
    if what == "first":
        local *= volume
        return local
    own = grid.steps.T @ grid.steps / 12.0
    second = np.empty((len(local), 6))
    for k, (i, j) in enumerate(zip(_I, _J, strict=True)):
        second[:, k] = volume * (local[:, i] * local[:, j] + own[i, j])
    return second
