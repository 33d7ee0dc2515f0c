"""The axis of a chart: from values to places, and where its round numbers are.

An axis covers the values that it is made for, and a little more. On a linear one the ticks are
multiples of 1, 2 or 5 times a power of ten, as many as have room; on a logarithmic one they are
powers of ten, with 2 and 5 times those between where there are few.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

#: Free space at either end of the values, as a share of the axis.
_MARGIN = 0.04
#: Values closer to each other than this share of their size are one, and so are those closer than
#: this number, where steps would no longer have all their digits.
_SAME, _TINY = 1e-6, 1e-290
#: Above as many powers of ten between the ends, some are passed over; below as many, there are
#: ticks between them.
_MANY_DECADES, _FEW_DECADES = 7, 2.5
#: What spans fewer is shown on an axis of a whole power of ten.
_LEAST_DECADES = 0.5


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A range of values, and its ticks.

    Parameters
    ----------
    low, high : float
        The values at the ends.
    log : bool
        Whether equal factors, not equal differences, are equally far apart.
    ticks : tuple of (float, str)
        Values and what is written there.
    """

    low: float
    high: float
    log: bool = False
    ticks: tuple[tuple[float, str], ...] = ()

    def place(self, value: float) -> float:
        """Where a value is: 0 at the low end of the axis, 1 at the high end.

        Examples
        --------
        >>> Axis(low=1.0, high=100.0, log=True).place(10.0)
        0.5
        """
        low, high = self.low, self.high
        if self.log:
            low, high, value = math.log10(low), math.log10(high), math.log10(value)
        return (value - low) / (high - low)


def linear_axis(values: Iterable[float], *, most: int = 6, whole: bool = False) -> Axis:
    """A linear axis for some values.

    Parameters
    ----------
    values : iterable of float
        Below 1e280 in size; without any, the axis runs from 0 to 1.
    most : int
        Most ticks to have.
    whole : bool
        Whether only whole numbers are values: no ticks between them.

    Examples
    --------
    >>> axis = linear_axis([0.31, 0.52, 1.68])
    >>> [text for _, text in axis.ticks]
    ['0.5', '1.0', '1.5']
    >>> round(axis.low, 3), round(axis.high, 3)
    (0.255, 1.735)
    """
    values = list(values) or [0.0, 1.0]
    low, high = min(values), max(values)
    size = max(abs(low), abs(high))
    if high - low <= max(_SAME * size, _TINY):
        widen = 0.1 * size if size > _TINY and not whole else 1.0
        low, high = low - widen, high + widen
    margin = _MARGIN * (high - low)
    low, high = low - margin, high + margin
    step = _round_step((high - low) / most)
    if whole:
        step = max(step, 1.0)
    first, last = math.ceil(low / step), math.floor(high / step)
    marks = [k * step for k in range(first, last + 1)]
    return Axis(low=low, high=high, ticks=tuple((m, _linear_text(m, step, size)) for m in marks))


def log_axis(values: Iterable[float]) -> Axis:
    """A logarithmic axis for some values.

    Parameters
    ----------
    values : iterable of float
        Above 1e-280 and below 1e280, at least one.

    Examples
    --------
    >>> [text for _, text in log_axis([2e-6, 0.2]).ticks]
    ['1e-5', '1e-4', '0.001', '0.01', '0.1']
    >>> [text for _, text in log_axis([3, 40]).ticks]
    ['5', '10', '20']
    """
    exponents = [math.log10(value) for value in values]
    low, high = min(exponents), max(exponents)
    if high - low < _LEAST_DECADES:  # else there might be no tick between the ends
        low, high = (low + high - 1.0) / 2, (low + high + 1.0) / 2
    margin = _MARGIN * (high - low)
    low, high = low - margin, high + margin
    stride = 1 + math.floor((high - low) / _MANY_DECADES)
    factors = (1, 2, 5) if high - low < _FEW_DECADES else (1,)
    marks = [
        float(f"{factor}e{exponent}")
        for exponent in range(math.floor(low), math.floor(high) + 1)
        for factor in factors
        if exponent % stride == 0
    ]
    shown = [mark for mark in marks if low <= math.log10(mark) <= high]
    return Axis(
        low=10.0**low, high=10.0**high, log=True, ticks=tuple((m, _log_text(m)) for m in shown)
    )


def _round_step(least: float) -> float:
    """The smallest of 1, 2 or 5 times a power of ten that is not below `least`."""
    power = math.floor(math.log10(least))
    for factor in (1, 2, 5, 10):
        # As text, so that a step is the number nearest to what it says.
        step = float(f"{factor}e{power}")
        if step >= least:
            return step
    return float(f"1e{power + 1}")


def _linear_text(value: float, step: float, size: float) -> str:
    """A multiple of a step, with as many digits as the step has."""
    place = _power(step)
    if place >= -8 and size < 1e7:
        return f"{value:.{max(0, -place)}f}"
    return _short(f"{value:.{_power(abs(value)) - place}e}") if value else "0"


def _power(value: float) -> int:
    """Exponent of the first digit; a hair below a power of ten counts as that."""
    return math.floor(math.log10(value) + 1e-9)


def _log_text(value: float) -> str:
    return f"{value:g}" if 1e-3 <= value < 1e5 else _short(f"{value:.0e}")


def _short(text: str) -> str:
    """A number with an exponent, without its leading zeros: 1e-05 becomes 1e-5."""
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}"
