"""Objectives on several parts: perpendicular, similar_proportions (Sec. 10). 0 is best."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from moseg_core import Part, objective


@objective(
    range=(0, 1), invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels")
)
def perpendicular(first: Part, second: Part) -> float:
    """Small where the long axes of two parts are at a right angle: ``|axis_1 . axis_1'|``.

    Parameters
    ----------
    first, second : Part
        In either order.

    Returns
    -------
    float
        Cosine of the angle between the axes: 0 at a right angle, 1 where they are parallel; 0
        is best. The long axis of a part means little where its two largest scales are equal.

    Notes
    -----
    Simari & Singh, Sec. 10.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> cross = Shape.from_mesh(
    ...     [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0],
    ...      [9, 0, 0], [9, 0, 1], [9, 5, 1], [9, 5, 0]],
    ...     [[0, 1, 2, 3], [4, 5, 6, 7]])
    >>> Problem(["a", "b"], "perpendicular(a, b)").evaluate(cross, [0, 1]).cost.value
    0.0
    """
    return min(1.0, float(abs(first.axes[0] @ second.axes[0])))


@objective(
    range=(0, math.inf),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
)
def similar_proportions(parts: Sequence[Part]) -> float:
    """Small where parts are alike in length, width and height: ``sum ||s_i - mean s||^2 / d^2``.

    Parameters
    ----------
    parts : sequence of Part
        Two or more, in any order.

    Returns
    -------
    float
        0 where all scales are equal; 0 is best. ``s_i`` are the three scales of part ``i`` and
        ``d`` is the diagonal of the whole shape's bounding box in its principal axes.

    Notes
    -----
    Simari & Singh, Sec. 10. The box is taken in the principal axes because one in the file's
    axes changes when the shape is rotated.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> pair = Shape.from_mesh(
    ...     [[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0],
    ...      [9, 0, 0], [9, 0, 1], [9, 4, 1], [9, 4, 0]],
    ...     [[0, 1, 2, 3], [4, 5, 6, 7]])
    >>> found = Problem(["a", "b"], "similar_proportions(a, b)").evaluate(pair, [0, 1])
    >>> round(found.cost.value, 12)
    0.0
    """
    scales = np.array([part.scales for part in parts])
    spread = ((scales - scales.mean(axis=0)) ** 2).sum()
    return float(spread / parts[0].shape.box_diagonal ** 2)
