"""The distance from a point to a triangle.

That of C. Ericson, "Real-time collision detection", 2005, Sec. 5.1.5, in the order of operations of
libigl's ``point_simplex_squared_distance``, so that values are libigl's to the last bit.
:mod:`moseg_objectives_basic.surface_tree` finds the least to many triangles.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from moseg_core import kernel

FloatArray = npt.NDArray[np.float64]


@kernel
def square(x: float, y: float, z: float) -> float:
    """Squared length of a vector."""
    return x * x + y * y + z * z


@kernel
def to_triangle(x: float, y: float, z: float, corners: FloatArray, t: int) -> float:
    """Squared distance from a point to a triangle a, b, c: its corner, side or inside.

    Parameters
    ----------
    x, y, z : float
    corners : (n, 3, 3) float
        Of triangles.
    t : int
        Which of them.

    Examples
    --------
    >>> to_triangle(1.0, 1.0, 3.0, np.array([[[0., 0, 0], [4, 0, 0], [0, 4, 0]]]), 0)
    9.0
    """
    a0, a1, a2 = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
    b0, b1, b2 = corners[t, 1, 0], corners[t, 1, 1], corners[t, 1, 2]
    c0, c1, c2 = corners[t, 2, 0], corners[t, 2, 1], corners[t, 2, 2]
    ab0, ab1, ab2 = b0 - a0, b1 - a1, b2 - a2
    ac0, ac1, ac2 = c0 - a0, c1 - a1, c2 - a2
    p0, p1, p2 = x - a0, y - a1, z - a2
    along_ab_a, along_ac_a = ab0 * p0 + ab1 * p1 + ab2 * p2, ac0 * p0 + ac1 * p1 + ac2 * p2
    if along_ab_a <= 0.0 and along_ac_a <= 0.0:
        return square(p0, p1, p2)
    p0, p1, p2 = x - b0, y - b1, z - b2
    along_ab_b, along_ac_b = ab0 * p0 + ab1 * p1 + ab2 * p2, ac0 * p0 + ac1 * p1 + ac2 * p2
    if along_ab_b >= 0.0 and along_ac_b <= along_ab_b:
        return square(p0, p1, p2)
    # The parts of the triangle's area that are across from c, b and a, but for a common factor.
    of_c = along_ab_a * along_ac_b - along_ab_b * along_ac_a
    if of_c <= 0.0 <= along_ab_a and along_ab_b <= 0.0 and (a0 != b0 or a1 != b1 or a2 != b2):
        v = along_ab_a / (along_ab_a - along_ab_b)
        return square(x - (a0 + v * ab0), y - (a1 + v * ab1), z - (a2 + v * ab2))
    p0, p1, p2 = x - c0, y - c1, z - c2
    along_ab_c, along_ac_c = ab0 * p0 + ab1 * p1 + ab2 * p2, ac0 * p0 + ac1 * p1 + ac2 * p2
    if along_ac_c >= 0.0 and along_ab_c <= along_ac_c:
        return square(p0, p1, p2)
    of_b = along_ab_c * along_ac_a - along_ab_a * along_ac_c
    if of_b <= 0.0 <= along_ac_a and along_ac_c <= 0.0:
        w = along_ac_a / (along_ac_a - along_ac_c)
        return square(x - (a0 + w * ac0), y - (a1 + w * ac1), z - (a2 + w * ac2))
    of_a = along_ab_b * along_ac_c - along_ab_c * along_ac_b
    past_b, past_c = along_ac_b - along_ab_b, along_ab_c - along_ac_c
    if of_a <= 0.0 <= past_b and past_c >= 0.0:
        w = past_b / (past_b + past_c)
        return square(x - (b0 + w * (c0 - b0)), y - (b1 + w * (c1 - b1)), z - (b2 + w * (c2 - b2)))
    share = 1.0 / (of_a + of_b + of_c)
    v, w = of_b * share, of_c * share
    return square(
        x - ((a0 + ab0 * v) + ac0 * w),
        y - ((a1 + ab1 * v) + ac1 * w),
        z - ((a2 + ab2 * v) + ac2 * w),
    )
