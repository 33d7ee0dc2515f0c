"""Names for the arrays that travel between modules.

Shapes are given in the docstrings, ``(F, 3) float`` for one row of three per surface element;
these aliases only fix the element type, for the type checker.
"""

from __future__ import annotations

from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.int64]
Int32Array: TypeAlias = npt.NDArray[np.int32]
BoolArray: TypeAlias = npt.NDArray[np.bool_]

UNLABELLED = -1
"""Stands for a label where an element has none, because nobody has said what it is."""

_Array = TypeVar("_Array", bound=npt.NDArray[Any])


def frozen(array: _Array) -> _Array:
    """The array, from now on read-only: what is shared must not change under its users."""
    array.flags.writeable = False
    return array
