"""The two points furthest apart, exactly.

Points are visited from the outside in, by their distance ``r`` from the middle. No pair can be
further apart than ``r_i + r_j``, so the loops end early on anything but a sphere.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, IntArray


def farthest_pair(points: FloatArray) -> tuple[int, int]:
    """Indices i <= j of the two points furthest apart; of equal pairs the lowest.

    Parameters
    ----------
    points : (P, 3) float

    Examples
    --------
    >>> import numpy as np
    >>> farthest_pair(np.array([[0., 0, 0], [5, 0, 0], [1, 1, 0]]))
    (0, 1)
    """
    radius = np.linalg.norm(points - points.mean(axis=0), axis=1)
    order = np.argsort(-radius, kind="stable")
    i, j = _search(points[order], radius[order], order)
    return int(i), int(j)


@kernel
def _search(points: FloatArray, radius: FloatArray, number: IntArray) -> tuple[int, int]:
    best, at_i, at_j = -1.0, 0, 0
    # Radii are rounded; the slack keeps pairs that tie.
    slack = 1e-9 * radius[0]
    for a in range(points.shape[0]):
        if 2.0 * radius[a] + slack < np.sqrt(max(best, 0.0)):
            break
        for b in range(a, points.shape[0]):
            if radius[a] + radius[b] + slack < np.sqrt(max(best, 0.0)):
                break
            dx = points[a, 0] - points[b, 0]
            dy = points[a, 1] - points[b, 1]
            dz = points[a, 2] - points[b, 2]
            square = dx * dx + dy * dy + dz * dz
            i, j = int(min(number[a], number[b])), int(max(number[a], number[b]))
            if square > best or (square == best and (i < at_i or (i == at_i and j < at_j))):
                best, at_i, at_j = square, i, j
    return at_i, at_j
