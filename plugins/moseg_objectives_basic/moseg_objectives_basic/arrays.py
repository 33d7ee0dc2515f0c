"""Arrays of numbers, one for each call, and their sums, for the vectorised forms of objectives.

Numpy adds along an axis in an order that may depend on how many rows there are; a value must not.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]


def row_sums(values: FloatArray) -> FloatArray:
    """(k,) float: the sum of each row of (k, n) values, rounded once.

    Examples
    --------
    >>> row_sums(np.array([[1e16, 1.0, -1e16], [0.1, 0.2, 0.3]])).tolist()
    [1.0, 0.6]
    """
    return np.array([math.fsum(row) for row in values.tolist()], np.float64)
