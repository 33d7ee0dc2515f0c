"""The volume of a shape from convex hulls alone: for samples that know no inside and no outside.

The convex hull of a whole shape is an upper bound on its volume, and for a hammer it is three
times too large: it spans the air between handle and head. Cut in two by a plane, each half has a
hull of its own, and where the shape is not convex the two together are smaller. So the hull is
cut as long as that takes away enough: of each piece the three principal axes and some places along
each are tried, the best cut is made, and the halves are treated alike. What remains is an
approximate convex decomposition, in the manner of Lien and Amato (2006,
doi:10.1016/j.cagd.2006.09.001) but for the greedy choice of planes; the sum of its hulls is still
about an upper bound, and the hull's volume itself where the shape is convex.

Surfaces are sampled first, so that meshes and clouds are cut alike. A cut has no samples in its
plane; those within their spacing of it are moved there and belong to both halves.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray

_SAMPLES = 6_000
_PLACES = 9

#: A cut is worth while if it takes away this share of the whole hull.
_WORTH = 0.01
_DEEPEST = 10


def hulls_volume(geometry: Geometry) -> tuple[float, int]:
    """Volume of the convex pieces that a shape is cut into.

    Parameters
    ----------
    geometry : Geometry

    Returns
    -------
    volume : float, model units cubed
        0 where the shape is flat.
    pieces : int
        How many convex hulls make it up.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> volume, pieces = hulls_volume(tent)
    >>> round(volume, 6), pieces
    (0.166667, 1)
    """
    vertices = geometry.used_vertices
    middle, size = vertices.mean(axis=0), float(np.ptp(vertices, axis=0).max())
    if size == 0.0:
        return 0.0, 1
    # In units of its size, so that what counts as flat does not depend on units.
    whole = _hull((vertices - middle) / size)
    if whole < 1e-12:
        return 0.0, 1
    samples, spacing = _samples(geometry, vertices)
    samples, spacing = (samples - middle) / size, spacing / size
    volume, pieces = _cut(samples, _hull(samples), spacing, _WORTH * whole, _DEEPEST)
    return (volume if pieces > 1 else whole) * size**3, pieces


def _samples(geometry: Geometry, vertices: FloatArray) -> tuple[FloatArray, float]:
    """Points all over the surface, not too many, and how far they are apart."""
    rng = np.random.default_rng(0)
    if len(vertices) > _SAMPLES:
        vertices = vertices[rng.choice(len(vertices), _SAMPLES, replace=False)]
    if isinstance(geometry, PointCloud):
        return vertices, float(np.sqrt(geometry.areas.sum() / len(vertices)))
    corners = geometry.vertices[geometry.triangles]
    edges = corners - corners[:, :1]
    areas = np.linalg.norm(np.cross(edges[:, 1], edges[:, 2]), axis=1) / 2.0
    chosen = rng.choice(len(areas), _SAMPLES, p=areas / areas.sum())
    u, v = np.sqrt(rng.random(_SAMPLES)), rng.random(_SAMPLES)
    weights = np.stack([1 - u, u * (1 - v), u * v], axis=1)
    inside = np.einsum("sk,skd->sd", weights, corners[chosen])
    return np.concatenate([vertices, inside]), float(np.sqrt(areas.sum() / _SAMPLES))


def _hull(points: FloatArray) -> float:
    """Volume of the convex hull; 0 for points in a plane."""
    try:
        return float(ConvexHull(points).volume) if len(points) > 3 else 0.0
    except QhullError:
        return 0.0


def _cut(
    points: FloatArray, hull: float, spacing: float, worth: float, deepest: int
) -> tuple[float, int]:
    """Least sum of hulls that greedy cuts of some points come to, and the number of hulls."""
    if hull < worth or deepest == 0:
        return hull, 1
    middle = points.mean(axis=0)
    axes = np.linalg.svd(np.cov((points - middle).T))[0]
    local = (points - middle) @ axes
    best = hull - worth
    halves: list[tuple[FloatArray, float]] = []
    for axis in range(3):
        along = local[:, axis]
        places = np.linspace(along.min(), along.max(), _PLACES + 2)[1:-1]
        for place in places:
            both = [_half(local, axis, place, side, spacing) for side in (1.0, -1.0)]
            first = _hull(both[0])
            if first >= best:
                continue
            sizes = [first, _hull(both[1])]
            if sum(sizes) < best:
                best, halves = sum(sizes), list(zip(both, sizes, strict=True))
    if not halves:
        return hull, 1
    found = [_cut(half, size, spacing, worth, deepest - 1) for half, size in halves]
    return sum(volume for volume, _ in found), sum(pieces for _, pieces in found)


def _half(local: FloatArray, axis: int, place: float, side: float, spacing: float) -> FloatArray:
    """The points on one side of a plane, with those little beyond it moved into it."""
    beyond = side * (local[:, axis] - place)
    half = local[beyond <= spacing]
    half[:, axis] = np.where(side * (half[:, axis] - place) > 0.0, place, half[:, axis])
    return half
