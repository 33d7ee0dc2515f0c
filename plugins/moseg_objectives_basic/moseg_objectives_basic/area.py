"""An objective on how much of the shape a part takes up: area_fraction. 0 is best.

The objectives of Sec. 10 have no opinion on sizes, and some are best for a sliver of a part:
``narrow`` of a few faces in a row, ``flat`` of a single one. Bounds on the share of the whole
surface keep a part from getting there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np

from moseg_core import Interval, Part, PartArray, UsageError, objective
from moseg_objectives_basic.arrays import FloatArray


def middle_share(given: Mapping[str, Any]) -> float | None:
    """The middle of the bounds that a call gives, None where there is no upper one.

    A lower bound alone keeps a part from vanishing, and says little of how large it is.

    Examples
    --------
    >>> [middle_share(given) for given in ({"min": 0.1, "max": 0.3}, {"max": 0.3}, {"min": 0.1})]
    [0.2, 0.15, None]
    """
    low, high = given.get("min", 0.0), given.get("max", 1.0)
    return (low + high) / 2 if 0 < high < 1 else None


def all_beyond(parts: PartArray, *, min: float = 0.0, max: float = 1.0) -> FloatArray:
    """:func:`area_fraction` of several parts, (k,) float."""
    _check_bounds(min, max)
    shares = parts.areas / parts.shape.area
    return np.maximum(0.0, np.maximum(min - shares, shares - max))


def _check_bounds(low: float, high: float) -> None:
    """Refuse bounds that cross."""
    if low > high:
        raise UsageError(
            f"'area_fraction' allows no share at all with min={low:g} and max={high:g};"
            f" min must not be greater than max"
        )


@objective(
    range=(0, 1),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    share=middle_share,
    vectorized=all_beyond,
)
def area_fraction(
    part: Part,
    *,
    min: Annotated[float, Interval(0, 1)] = 0.0,
    max: Annotated[float, Interval(0, 1)] = 1.0,
) -> float:
    """``max(min - share, share - max, 0)``: how far the share of the area is from its bounds.

    Parameters
    ----------
    part : Part
    min, max : float
        Bounds of the share, 0 to 1. Without either the value is always 0.

    Returns
    -------
    float
        ``share`` is the part's area over that of the whole shape. 0 within the bounds, growing
        linearly outside, at most 1; 0 is best.

    Raises
    ------
    UsageError
        ``min`` is greater than ``max``.

    Notes
    -----
    Linear outside, so that a search is led back at the same rate from everywhere; flat inside,
    so that it then leaves the decision to the other terms. What it keeps out is a matter of its
    weight. The area is the surface's: a part that is thick counts no more than one that is thin.

    Where ``max`` is below 1, a part is expected to have a share in the middle of the bounds, from
    which seeders may start (``Problem.expected_shares``); ``min`` alone says nothing of it.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> strip = Shape.from_mesh(
    ...     [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...     [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> found = Problem(["a", "b"], "area_fraction(a, b, min=0.3)").evaluate(strip, [0, 1])
    >>> round(found.cost.value, 12)
    0.1
    """
    _check_bounds(min, max)
    share = part.area / part.shape.area
    if share < min:
        return float(min - share)
    return float(share - max) if share > max else 0.0
