"""Objectives on parts that are alike: similar_proportions (Sec. 10), similar (Sec. 3). 0 is best.

``similar_proportions`` compares lengths: of two copies the smaller counts as unlike.
``similar`` compares the same three scales after every part has been scaled to unit size. It is as
cheap, sums over the elements and nothing else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from moseg_core import Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray


def all_similar(parts: PartArray) -> FloatArray:
    """:func:`similar` of several calls, (k,) float."""
    unit = parts.scales / np.linalg.norm(parts.scales, axis=2, keepdims=True)
    squares = (unit - unit.mean(axis=1, keepdims=True)) ** 2
    values: FloatArray = squares.sum(axis=2).mean(axis=1)
    return values


def all_similar_proportions(parts: PartArray) -> FloatArray:
    """:func:`similar_proportions` of several calls, (k,) float."""
    squares = (parts.scales - parts.scales.mean(axis=1, keepdims=True)) ** 2
    # As one row for each call: numpy then adds in the same order for one call as for many.
    spread: FloatArray = squares.reshape(len(parts), -1).sum(axis=1)
    return spread / parts.shape.box_diagonal**2


@objective(
    range=(0, 0.25),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
    vectorized=all_similar,
)
def similar(parts: Sequence[Part]) -> float:
    """``mean_i ||u_i - mean u||^2``: how far the parts' proportions are from their mean.

    Parameters
    ----------
    parts : sequence of Part
        Two or more, in any order.

    Returns
    -------
    float
        ``u_i = s_i / ||s_i||`` are the three scales of part ``i``, brought to unit length. 0 for
        copies of any sizes; 0 is best. The ``u_i`` run from a line's (1, 0, 0) over a disc's
        (1, 1, 0) to a ball's (1, 1, 1), all within a ball of radius 0.463, whose square 0.215 no
        mean squared distance from the mean exceeds.

    Notes
    -----
    Named in Simari & Singh, Sec. 3: "similar (in proportions, for instance)". A mean and not a
    sum as in ``similar_proportions``, so that it stays bounded for any number of parts. The size
    ``||s_i||`` is the surface's root mean squared distance from its centroid, which unlike area
    or volume is 0 for no part.

    It sees proportions only: a brick is similar to an ellipsoid with the same three scales, and
    a part to its mirror image.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> pair = Shape.from_mesh(
    ...     [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0],
    ...      [9, 0, 0], [9, 0, 6], [9, 3, 6], [9, 3, 0]],
    ...     [[0, 1, 2, 3], [4, 5, 6, 7]])
    >>> found = Problem(["a", "b"], "similar(a, b)").evaluate(pair, [0, 1])
    >>> round(found.cost.value, 12)
    0.0
    """
    scales = np.array([part.scales for part in parts])
    unit = scales / np.linalg.norm(scales, axis=1, keepdims=True)
    return float(((unit - unit.mean(axis=0)) ** 2).sum(axis=1).mean())


@objective(
    range=(0, math.inf),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation", "labels"),
    vectorized=all_similar_proportions,
)
def similar_proportions(parts: Sequence[Part]) -> float:
    """``sum_i ||s_i - mean s||^2 / d^2``: how far the parts' scales are from their mean.

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
