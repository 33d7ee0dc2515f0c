"""An objective on which of two parts is higher up: above. 0 is best."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core import Interval, Part, PartArray, objective
from moseg_objectives_basic.arrays import FloatArray

_FIELD = "basic:height"


def all_above(pairs: PartArray, *, up: str = "z", margin: float = 0.1) -> FloatArray:
    """:func:`above` for several pairs of parts, (k,) float."""
    heights = pairs.field(_FIELD, up=up).mean
    higher = heights[:, 0] - heights[:, 1]
    return np.minimum(1.0, np.maximum(0.0, margin - higher) / (1.0 + margin))


@objective(
    range=(0, 1),
    invariant_to=("scale", "order", "tessellation"),
    fields=(_FIELD,),
    vectorized=all_above,
)
def above(
    first: Part, second: Part, *, up: str = "z", margin: Annotated[float, Interval(0, 1)] = 0.1
) -> float:
    """``max(0, m - (h_1 - h_2)) / (1 + m)``: how far the first is from being above the second.

    Parameters
    ----------
    first, second : Part
    up : str
        Which way is up, in the file's axes: x, y, z, -x, -y or -z.
    margin : float
        How much higher is enough, ``m``, in heights of the shape.

    Returns
    -------
    float
        ``h`` are the heights of the centroids, from 0 at the lowest to 1 at the highest point of
        the shape. 0 where the first is higher by the margin or more, ``m / (1 + m)`` where both
        are level, 1 where the first is at the bottom and the second at the top; 0 is best.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> stairs = Shape.from_mesh([[x, y, x] for x in (0, 1, 2) for y in (0, 1)],
    ...                          [[0, 2, 3, 1], [2, 4, 5, 3]])
    >>> problem = Problem(["low", "high"], "above(high, low) + above(low, high)")
    >>> [round(term.value, 4) for term in problem.evaluate(stairs, [0, 1]).terms]
    [0.0, 0.5455]
    """
    higher = first.field(_FIELD, up=up).mean - second.field(_FIELD, up=up).mean
    return min(1.0, max(0.0, margin - higher) / (1.0 + margin))
