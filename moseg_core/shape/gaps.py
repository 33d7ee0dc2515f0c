"""The gap between two parts: the least distance between the middles of their elements.

Parts of a labelling that lie apart are looked at once and never again, so that a search tree takes
longer to make than it saves. Instead most elements are passed over by the boxes around the parts:
an element that is farther from the other part's box than a distance that is known already cannot
be one of the nearest two.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, Int32Array


@kernel
def _members(points: FloatArray, labels: Int32Array, part: int) -> FloatArray:
    """(k, 3) float: where the elements of a part are."""
    count = 0
    for f in range(labels.shape[0]):
        count += labels[f] == part
    found = np.empty((count, 3))
    count = 0
    for f in range(labels.shape[0]):
        if labels[f] == part:
            for j in range(3):
                found[count, j] = points[f, j]
            count += 1
    return found


@kernel
def _to_box(points: FloatArray, others: FloatArray) -> FloatArray:
    """(k,) float: squared distance of each point from the box around others."""
    low, high = others[0].copy(), others[0].copy()
    for k in range(others.shape[0]):
        for j in range(3):
            low[j] = min(low[j], others[k, j])
            high[j] = max(high[j], others[k, j])
    squared = np.zeros(points.shape[0])
    for k in range(points.shape[0]):
        for j in range(3):
            off = max(low[j] - points[k, j], 0.0, points[k, j] - high[j])
            squared[k] += off * off
    return squared


@kernel
def least_distance(points: FloatArray, labels: Int32Array, first: int, second: int) -> float:
    """The least distance between points of two parts; infinite where one of them is empty.

    Parameters
    ----------
    points : (F, 3) float
    labels : (F,) int32
        Part of each point.
    first, second : int
        The two parts.
    """
    one, two = _members(points, labels, first), _members(points, labels, second)
    if one.shape[0] == 0 or two.shape[0] == 0:
        return math.inf
    off = _to_box(one, two)
    back = _to_box(two, one)
    least = math.inf
    # Rounding is monotone: no distance is computed to be less than that to a box around its end.
    # The point nearest to the other's box comes first, and rules out most of what follows.
    start = int(np.argmin(off))
    for turn in range(one.shape[0]):
        a = (start + turn) % one.shape[0]
        if off[a] >= least:
            continue
        x, y, z = one[a, 0], one[a, 1], one[a, 2]
        for b in range(two.shape[0]):
            if back[b] < least:
                dx, dy, dz = x - two[b, 0], y - two[b, 1], z - two[b, 2]
                least = min(least, dx * dx + dy * dy + dz * dz)
    return math.sqrt(least)
