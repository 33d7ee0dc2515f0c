"""What counts as the number that an objective returns.

One rule for the search, the contract kit and the messages of both: a real number is an int or a
float, Python's or numpy's of whatever width, a fraction, or an array of one such number. A bool is
an answer to a question and no measurement; a text, None, a complex number and an array of several
are somebody's mistake, though Python would take some of them (``float("0.5")``).
"""

from __future__ import annotations

import math
import numbers
from typing import Any

import numpy as np


def real_number(value: Any) -> float | None:
    """The value as a float; None where it is no real number.

    NaN and infinity are floats: whether they may be returned is for others to say.

    Examples
    --------
    >>> real_number(np.float32(0.5)), real_number(np.array([2]))
    (0.5, 2.0)
    >>> [real_number(value) for value in ("0.5", True, None, 1j, [0.5], np.ones(2))]
    [None, None, None, None, None, None]
    """
    if isinstance(value, float):
        return float(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return float(value.item()) if value.size == 1 and value.dtype.kind in "iuf" else None
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        try:
            return float(value)
        except OverflowError:  # an int of more than 308 digits, or a fraction
            return math.inf  # either way beyond any range
    return None


def described(value: Any) -> str:
    """A value that is no real number, as a message shows it: itself and its type.

    Examples
    --------
    >>> described("0.5"), described(np.ones(2)), described(None)
    ("'0.5' (a str)", 'array([1., 1.]) (an ndarray of shape (2,) of float64)', 'None')
    """
    if value is None:
        return "None"
    try:
        shown = " ".join(repr(value).split())
    except Exception:  # noqa: BLE001  # a stranger's object decides what it does when it is shown
        shown = "something"
    kind = type(value).__name__
    if isinstance(value, np.ndarray):
        kind = f"{kind} of shape {value.shape} of {value.dtype}"
    article = "an" if kind[:1].lower() in "aeiou" or isinstance(value, np.ndarray) else "a"
    return f"{shown if len(shown) <= 60 else f'{shown[:57]}...'} ({article} {kind})"
