"""Convex hulls as meshes, with as many vertices as one wants.

Qhull (Barber, Dobkin and Huhdanpaa 1996, doi:10.1145/235815.235821) computes the hull in units of
its size, so that what is flat does not depend on units. Points in a plane or on a line have a hull
without volume, of which no program that moves or prints bodies can make anything: it is given the
thickness of a thousandth of its diagonal.

A hull of few vertices is that of a subset of the points. These are chosen farthest first: beginning
with a tetrahedron, the point that lies farthest beyond the planes of the present hull is added. So
it touches the hull of all points at every vertex and lies within it, and how far any point still is
beyond its planes is known: its *shortfall*.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from moseg_core.errors import MosegError
from moseg_core.types import FloatArray, IntArray

FEWEST = 4
"""The least number of vertices of a solid."""

#: Thinner than this share of its diagonal a hull is flat, and how thick one becomes.
_FLAT, _THICKNESS = 1e-6, 1e-3


@dataclass(frozen=True, eq=False, kw_only=True)
class Hull:
    """A convex body.

    Parameters
    ----------
    vertices : (V, 3) float, model units
    triangles : (T, 3) int
        Counter-clockwise from outside.
    shortfall : float, model units
        How far the farthest point lies beyond the planes of the hull; 0 where all vertices of the
        hull of all points are kept, but for rounding.
    thickened : bool
        Whether the points were flat.
    """

    vertices: FloatArray
    triangles: IntArray
    shortfall: float
    thickened: bool


def convex_hull(points: FloatArray, *, most: int | None = None) -> Hull | None:
    """The convex hull of some points.

    Parameters
    ----------
    points : (n, 3) float, model units
    most : int, optional
        The greatest number of vertices, 4 or more.

    Returns
    -------
    Hull or None
        None of points that are all in one place.

    Raises
    ------
    MosegError
        Qhull fails.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])
    >>> hull = convex_hull(cube)
    >>> hull.vertices.shape, hull.triangles.shape, hull.shortfall
    ((8, 3), (12, 3), 0.0)
    >>> convex_hull(cube[:4]).thickened
    True
    """
    middle = (points.min(axis=0) + points.max(axis=0)) / 2.0
    size = float(np.ptp(points, axis=0).max())
    if not size > 0.0:
        return None
    local = (points - middle) / size
    local, thickened = _thickened(local)
    try:
        # The vertices alone, of which the hull is then made: sooner done, and of one kind.
        local = local[np.sort(ConvexHull(local).vertices)]
        shortfall = 0.0
        if most is not None and len(local) > most:
            local, shortfall = _farthest_first(local, most)
        triangles = _outward(local, ConvexHull(local))
    except QhullError as error:
        reason = str(error).partition("\n")[0]
        raise MosegError(f"a convex hull cannot be computed: {reason}") from error
    used, triangles = np.unique(triangles, return_inverse=True)
    return Hull(
        vertices=middle + size * local[used],
        triangles=triangles.reshape(-1, 3),
        shortfall=size * shortfall,
        thickened=thickened,
    )


def _thickened(points: FloatArray) -> tuple[FloatArray, bool]:
    """Points that span a volume: themselves, or twice, apart along the axes they are flat in."""
    axes = np.linalg.svd(np.cov((points - points.mean(axis=0)).T))[2]
    extents = np.ptp(points @ axes.T, axis=0)
    diagonal = float(np.linalg.norm(extents))
    thin = np.flatnonzero(extents <= _FLAT * diagonal)
    for axis in axes[thin]:
        step = 0.5 * _THICKNESS * diagonal * axis
        points = np.concatenate([points - step, points + step])
    return points, len(thin) > 0


def _farthest_first(points: FloatArray, most: int) -> tuple[FloatArray, float]:
    """Some corners of a convex body, the farthest first, and how far the others are beyond."""
    first = int(points[:, 0].argmin())
    chosen = [int(np.linalg.norm(points - points[first], axis=1).argmax())]
    along = points - points[chosen[0]]
    chosen.append(int(np.linalg.norm(along, axis=1).argmax()))
    direction = along[chosen[1]] / np.linalg.norm(along[chosen[1]])
    off = np.linalg.norm(along - (along @ direction)[:, None] * direction, axis=1)
    chosen.append(int(off.argmax()))
    normal = np.cross(direction, along[chosen[2]])
    chosen.append(int(np.abs(along @ normal).argmax()))
    while True:
        planes = ConvexHull(points[chosen]).equations
        beyond = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        farthest = int(beyond.argmax())
        if len(chosen) >= most or farthest in chosen:
            return points[chosen], max(float(beyond[farthest]), 0.0)
        chosen.append(farthest)


def _outward(points: FloatArray, hull: ConvexHull) -> IntArray:
    """(T, 3) int: the facets of a hull, counter-clockwise from outside."""
    facets = hull.simplices.astype(np.int64)
    a, b, c = (points[facets[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    facets[inward] = facets[inward][:, ::-1]
    return facets
