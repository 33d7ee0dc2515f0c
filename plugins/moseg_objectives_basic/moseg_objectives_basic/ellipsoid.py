"""How close a part is to an ellipsoid: ellipsoidal (Sec. 10), and the distance that it needs.

The distance from points to the surface of an ellipsoid, which may be flat:

By symmetry only the octant of positive coordinates matters. For a point ``y`` there, the nearest
point of the ellipsoid with radii ``e`` is ``x_i = e_i^2 y_i / (t + e_i^2)``, where ``t`` is the
largest root of

    F(t) = sum_i (e_i y_i / (t + e_i^2))^2 - 1.

With ``s = t + e_min^2`` the root is at ``s >= 0``, and nothing cancels near 0. The length ``n`` of
the vector of terms decreases there and ``1/n`` is concave, so Newton's method for ``1/n = 1`` from
a point where ``n >= 1`` climbs to the root without overshooting. Where it stops, ``x`` is the
nearest point of the ellipsoid ``n`` times as large, so that the distance is off by at most
``(n - 1) e_max``. Where there is no root at ``s > 0``, the point is near the middle plane across
the shortest radius, and the nearest point leaves that plane. A radius of 0 needs nothing
special: the ellipsoid is then a filled ellipse or a segment. Compare Eberly, "Distance from a
Point to an Ellipse, an Ellipse, or an Ellipsoid", Geometric Tools, 2013.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from moseg_core import Part, objective
from moseg_objectives_basic.surface_distance import normalized_mean

FloatArray = npt.NDArray[np.float64]

_MOST_STEPS = 200
_CLOSE = 1e-15


def squared_distances_to_ellipsoid(points: FloatArray, radii: FloatArray) -> FloatArray:
    """Squared distance of points to the surface of an axis-aligned ellipsoid at the origin.

    Parameters
    ----------
    points : (k, 3) float
    radii : (3,) float
        Not negative, in any order.

    Returns
    -------
    (k,) float

    Examples
    --------
    >>> import numpy as np
    >>> at = np.array([[3., 0, 0], [0, 0, 0], [0, 0, 5]])
    >>> squared_distances_to_ellipsoid(at, np.array([2., 1, 1])).round(12).tolist()
    [1.0, 1.0, 16.0]
    """
    size = max(float(radii.max()), float(np.abs(points).max(initial=0.0)))
    if size == 0.0:
        return np.zeros(len(points))
    order = np.argsort(radii)
    e = radii[order] / size
    y = np.abs(points[:, order]) / size
    # In units of `size`: e_min first; gap_i = e_i^2 - e_min^2, exact where radii are equal.
    gap = (e - e[0]) * (e + e[0])
    pull = e * y
    # A product so small has a factor below 1e-75: nothing as a length, but its square underflows
    # and quotients overflow.
    pull[pull < 1e-150] = 0.0
    s = np.maximum((pull - gap).max(axis=1), np.linalg.norm(pull, axis=1) - gap[2]).clip(0.0)
    still = np.flatnonzero(s == 0.0)
    at_zero = (_terms(pull[still], gap, s[still]) ** 2).sum(axis=1)
    middle = still[at_zero <= 1.0]
    moving = np.setdiff1d(np.arange(len(y)), middle, assume_unique=True)
    for _ in range(_MOST_STEPS):
        current = s[moving]
        squares = _terms(pull[moving], gap, current) ** 2
        length = np.sqrt(squares.sum(axis=1))
        far = length > 1.0 + _CLOSE
        if not far.any():
            break
        moving, current, squares, length = moving[far], current[far], squares[far], length[far]
        reach = current[:, None] + gap
        pace = np.divide(squares, reach, out=np.zeros_like(squares), where=squares > 0).sum(axis=1)
        s[moving] = current + (length - 1.0) * length**2 / pace
    nearest = e * _terms(pull, gap, s)
    nearest[middle, 0] = e[0] * np.sqrt(1.0 - at_zero[at_zero <= 1.0])
    squared: FloatArray = ((nearest - y) ** 2).sum(axis=1) * size**2
    return squared


def _terms(pull: FloatArray, gap: FloatArray, s: FloatArray) -> FloatArray:
    """(k, 3) float: ``e_i y_i / (s + gap_i)``, 0 where both are 0."""
    reach = s[:, None] + gap
    return np.divide(pull, reach, out=np.zeros_like(pull), where=(reach > 0) & (pull > 0))


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="expensive",
)
def ellipsoidal(part: Part) -> float:
    """``surfdist(P, E)``: the distance to the ellipsoid ``E`` of the part's covariance.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        Surface distance from the part to the ellipsoid around its centroid with radii
        ``sqrt(3) * scales`` along its principal axes, or ``sqrt(5) * scales`` where the elements
        fill a solid. 0 for a sphere; 0 is best. A point ``x`` is within ``max(|x|, sqrt(3) s_3)``
        of the ellipsoid, hence at most 1/2 on a surface, and at most 1 on a solid.

    Notes
    -----
    Simari & Singh, Sec. 10: ``surfdist(P, covarellipsoid(P))``. The factor ``sqrt(3)`` is exact
    for a sphere's surface; the radii of a 3:1 ellipsoid come out 10 % short along its axis and
    5 % long across it, so that an elongated ellipsoid has a small positive value. Of a solid the
    scales are those of the volume, for which ``sqrt(5)`` is exact whatever the proportions; the
    distance is still that of the surface, the exposed faces.

    Examples
    --------
    >>> import trimesh
    >>> from moseg_core import Problem, Shape
    >>> ball = Shape.from_mesh(trimesh.creation.icosphere(subdivisions=4))
    >>> found = Problem(["a"], "ellipsoidal(a)").evaluate(ball, [0] * ball.n_elements)
    >>> found.cost.value < 1e-6
    True
    """
    points, weights = part.measure("basic:surface_samples")
    local = (points - part.centroid) @ part.axes.T
    factor = np.sqrt(5.0 if part.shape.solid else 3.0)
    squared = squared_distances_to_ellipsoid(local, factor * part.scales)
    return normalized_mean(part, squared, weights)
