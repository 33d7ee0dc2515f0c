"""Objectives on which parts are next to each other: touching, apart. 0 is best.

Two parts touch where elements of one are neighbours of elements of the other. ``touching`` leads
parts to each other by the gap between them, ``apart`` parts away from each other by how much of
their boundaries they share.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from moseg_core import Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray


def all_touching(parts: PartArray) -> FloatArray:
    """:func:`touching` for several calls, (k,) float."""
    shared = parts.lengths_between[:, 0, 1:]
    gaps = np.zeros(len(parts))
    for call, other in np.argwhere(~(shared > 0)).tolist():
        gaps[call] += parts.distance(call, 0, other + 1)
    least: FloatArray = np.minimum(1.0, gaps / shared.shape[1] / parts.shape.box_diagonal)
    return least


@objective(
    range=(0, 1),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order"),
    cost="moderate",
    vectorized=all_touching,
)
def touching(parts: Sequence[Part]) -> float:
    """``mean_i gap(P_1, P_i) / d``: whether the first part touches each of the others.

    Parameters
    ----------
    parts : sequence of Part
        Two or more: ``touching(body, leg*)`` wants each leg at the body.

    Returns
    -------
    float
        ``gap`` is 0 where two parts touch, else the least distance between the middles of their
        elements; ``d`` is the diagonal of the shape's bounding box in its principal axes. 0 where
        all touch the first; 0 is best.

    Notes
    -----
    A gap is straight, through the air where need be. During a search on a coarse shape the elements
    are its own, and a gap is about one of them longer.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[x, y, 0] for x in range(5) for y in (0, 3)],
    ...                         [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(4)])
    >>> problem = Problem(["a", "b", "c"], "touching(a, b, c)")
    >>> problem.evaluate(strip, [0, 1, 2, 2]).cost.value  # c is two beside a, of a diagonal of 5
    0.2
    """
    first, *others = parts
    gaps = 0.0
    for other, shared in zip(others, first.boundary_lengths(others), strict=True):
        if not shared > 0:
            gaps += first.distance_to(other)
    return min(1.0, gaps / len(others) / first.shape.box_diagonal)


def all_apart(parts: PartArray) -> FloatArray:
    """:func:`apart` for several calls, (k,) float."""
    lengths, between = parts.boundary_lengths, parts.lengths_between
    total, m = np.zeros(len(parts)), lengths.shape[1]
    for i in range(m - 1):
        least = np.minimum(lengths[:, i, None], lengths[:, i + 1 :])
        shared = between[:, i, i + 1 :]
        shares = np.divide(shared, least, out=np.zeros_like(shared), where=shared > 0)
        for j in range(m - 1 - i):  # one after the other, whatever the number of calls
            total += shares[:, j]
    mean: FloatArray = np.minimum(1.0, total / math.comb(m, 2))
    return mean


@objective(
    range=(0, 1),
    requires=("adjacency",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
    vectorized=all_apart,
)
def apart(parts: Sequence[Part]) -> float:
    """``mean_ij L_ij / min(L_i, L_j)``: how much of their boundaries parts have with each other.

    Parameters
    ----------
    parts : sequence of Part
        Two or more: ``apart(leg*)`` wants no two legs to touch.

    Returns
    -------
    float
        ``L_ij`` is the length of the boundary between two parts, ``L_i`` that of the whole
        boundary of one; the mean is over all pairs. 0 where no two touch, 1 where each
        has the whole shorter boundary with each other; 0 is best.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[x, y, 0] for x in range(5) for y in (0, 3)],
    ...                         [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(4)])
    >>> problem = Problem(["a", "b", "c"], "apart(a, b) + apart(a, c)")
    >>> [term.value for term in problem.evaluate(strip, [0, 1, 2, 2]).terms]
    [1.0, 0.0]
    """
    shares = 0.0
    for k, first in enumerate(parts[:-1], start=1):
        lengths = first.boundary_lengths(parts[k:])
        for j in np.flatnonzero(lengths).tolist():
            least = min(first.boundary.length, parts[k + j].boundary.length)
            shares += float(lengths[j]) / least
    return min(1.0, shares / math.comb(len(parts), 2))
