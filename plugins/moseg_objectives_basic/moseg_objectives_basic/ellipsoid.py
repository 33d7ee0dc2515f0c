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

from moseg_core import Part, kernel, objective
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
    return _squared_distances(y, e, pull, gap) * size**2


@kernel
def _squared_distances(
    y: FloatArray, e: FloatArray, pull: FloatArray, gap: FloatArray
) -> FloatArray:
    """(k,) float: squared distance of points ``y >= 0``; radii ``e`` ascend."""
    squared = np.empty(len(y))
    for p in range(len(y)):
        s = 0.0
        for i in range(3):
            s = max(s, pull[p, i] - gap[i])
        s = max(s, np.sqrt(pull[p, 0] ** 2 + pull[p, 1] ** 2 + pull[p, 2] ** 2) - gap[2])
        middle, square = False, 0.0
        for _ in range(_MOST_STEPS):
            square, pace = 0.0, 0.0
            for i in range(3):
                term = _term(pull[p, i], s + gap[i])
                square += term**2
                pace += term**2 / (s + gap[i]) if term > 0.0 else 0.0
            length, middle = np.sqrt(square), s == 0.0 and square <= 1.0
            if middle or length <= 1.0 + _CLOSE:
                break
            s += (length - 1.0) * length**2 / pace
        total = 0.0
        for i in range(3):
            nearest = e[i] * _term(pull[p, i], s + gap[i])
            if middle and i == 0:
                nearest = e[0] * np.sqrt(1.0 - square)
            total += (nearest - y[p, i]) ** 2
        squared[p] = total
    return squared


@kernel
def _term(pull: float, reach: float) -> float:
    """``e_i y_i / (s + gap_i)``, 0 where both are 0."""
    return pull / reach if reach > 0.0 and pull > 0.0 else 0.0


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
