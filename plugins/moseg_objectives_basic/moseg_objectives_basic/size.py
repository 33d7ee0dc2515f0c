"""Objectives on how large a part is beside the whole: small, large. 0 is best.

They lead steadily to less, or more, of the surface; what says when it is enough is
``area_fraction`` (:mod:`moseg_objectives_basic.area`).
"""

from __future__ import annotations

import numpy as np

from moseg_core import Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray


def all_small(parts: PartArray) -> FloatArray:
    """:func:`small` of several parts, (k,) float."""
    return np.minimum(1.0, parts.areas / parts.shape.area)


def all_large(parts: PartArray) -> FloatArray:
    """:func:`large` of several parts, (k,) float."""
    return np.maximum(0.0, 1.0 - parts.areas / parts.shape.area)


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_small,
)
def small(part: Part) -> float:
    """``A / A_all``: the part's share of the area.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        0 to 1; 0 is best, where nothing is left of the part.

    Notes
    -----
    The area is the surface's: a part that is thick counts no more than one that is thin.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> Problem(["a", "b"], "small(a)").evaluate(strip, [0, 1]).cost.value
    0.2
    """
    return min(1.0, part.area / part.shape.area)


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    vectorized=all_large,
)
def large(part: Part) -> float:
    """``1 - A / A_all``: the rest's share of the area.

    Parameters
    ----------
    part : Part

    Returns
    -------
    float
        ``1 - small``; 0 is best, where the part is all there is.

    Notes
    -----
    See :func:`small`.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> Problem(["a", "b"], "large(a)").evaluate(strip, [0, 1]).cost.value
    0.8
    """
    return max(0.0, 1.0 - part.area / part.shape.area)
