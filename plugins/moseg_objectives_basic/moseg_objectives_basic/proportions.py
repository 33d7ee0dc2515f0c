"""Objectives on the proportions of one part: narrow, flat, compact (Sec. 10).

All three are ratios of the part's scales ``s1 >= s2 >= s3``, the square roots of the eigenvalues
of its surface's covariance: lengths along its principal axes. 0 is best.

The paper prints ``narrow`` with its scales in the opposite order; as printed it would grow
without bound and ``compact = 1 - narrow`` would make no sense. Descending scales are meant.
"""

from __future__ import annotations

import numpy as np

from moseg_core import Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray


def all_narrow(parts: PartArray) -> FloatArray:
    """:func:`narrow` of several parts, (k,) float."""
    s1, s2, s3 = parts.scales.T
    values: FloatArray = (s2 + s3) / (2 * s1)
    return values


def all_flat(parts: PartArray) -> FloatArray:
    """:func:`flat` of several parts, (k,) float."""
    s1, s2, s3 = parts.scales.T
    thick = s3 > 0  # then the width is not 0 either
    ratio = np.divide(s3, 2 * s2, out=np.zeros_like(s3), where=thick)
    values: FloatArray = s3 / (2 * s1) + ratio
    return values


def all_compact(parts: PartArray) -> FloatArray:
    """:func:`compact` of several parts, (k,) float."""
    return 1.0 - all_narrow(parts)


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_narrow,
)
def narrow(part: Part) -> float:
    """``(s2 + s3) / (2 s1)``: the mean of the short scales over the long one.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 for a line, 1 for a part that extends alike in all directions; 0 is best.

    Notes
    -----
    Simari & Singh, Sec. 10, with the scales in descending order.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> round(Problem(["a"], "narrow(a)").evaluate(strip, [0]).cost.value, 4)
    0.0556
    """
    s1, s2, s3 = part.scales
    return float((s2 + s3) / (2 * s1))


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_flat,
)
def flat(part: Part) -> float:
    """``s3 / (2 s1) + s3 / (2 s2)``: the mean of the thickness over the length and the width.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 for a plane piece, 1 for a part that extends alike in all directions; 0 is best.

    Notes
    -----
    Simari & Singh, Sec. 10.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> Problem(["a"], "flat(a)").evaluate(strip, [0]).cost.value
    0.0
    """
    s1, s2, s3 = part.scales
    if s3 == 0:
        return 0.0
    return float(s3 / (2 * s1) + s3 / (2 * s2))


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_compact,
)
def compact(part: Part) -> float:
    """``1 - narrow(P)``: the contrary of a line.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 for a part that extends alike in all directions, 1 for a line; 0 is best.

    Notes
    -----
    Simari & Singh, Sec. 10.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [9, 0, 0], [9, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    >>> round(Problem(["a"], "compact(a)").evaluate(strip, [0]).cost.value, 4)
    0.9444
    """
    return 1.0 - narrow(part)
