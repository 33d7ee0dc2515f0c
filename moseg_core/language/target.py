"""Targets: what people know of a quantity, a typical value and how far from it is still usual.

``area=0.06+-0.02`` says that a leg has about 6 % of the area, give or take 2. A target is a value
of a parameter like a number or a word: the parser reads it, :func:`str` writes it, components
declare that they take one (:mod:`moseg_core.components.parameters`) and ask it how far off a
measured value is.

That is measured in spreads, ``z``, and counted by Huber's function: as a square near the target,
and linearly beyond two spreads, so that a single part that is far off does not outweigh all
others, and a search is still led back to the target from afar.

References
----------
Huber 1964, "Robust Estimation of a Location Parameter", Ann. Math. Statist. 35(1), 73-101,
doi:10.1214/aoms/1177703732.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from moseg_core.errors import UsageError
from moseg_core.language.tokens import format_number

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

_BEND = 2.0
"""From how many spreads on the cost grows linearly."""

_MOST = 1e300
"""Spreads beyond which more make no difference, so that costs are finite."""

LEAST_LOG_RATIO = math.log(1e-6)
"""Least logarithm of a ratio to the target, which 0 and negative values have as well."""


@dataclass(frozen=True)
class Target:
    """A typical value and how far from it is still usual: ``0.06+-0.02``.

    Parameters
    ----------
    value : float
        Finite.
    spread : float
        Positive and finite, in the unit of the value.

    Raises
    ------
    UsageError
        A value or spread that is not a finite number; a spread that is not positive.

    Examples
    --------
    >>> str(Target(0.06, 0.02))
    '0.06+-0.02'
    >>> round(Target(0.06, 0.02).cost(0.08), 9)
    1.0
    """

    value: float
    spread: float

    def __post_init__(self) -> None:
        for name in ("value", "spread"):
            given = getattr(self, name)
            try:
                number = float(given)
            except (TypeError, ValueError, OverflowError):
                number = math.nan
            if not math.isfinite(number) or isinstance(given, bool | str):
                raise UsageError(f"the {name} of a target must be a finite number, not {given!r}")
            object.__setattr__(self, name, number)
        if self.spread <= 0:
            raise UsageError(
                f"the spread of a target must be positive, not {self.spread:g}; it says how far"
                f" from {self.value:g} is still usual"
            )

    def __str__(self) -> str:
        return f"{format_number(self.value)}+-{format_number(self.spread)}"

    def cost(self, value: float) -> float:
        """How far a value is off, ``h(z)`` with ``z = (value - self.value) / self.spread``.

        ``h(z) = z^2`` where ``|z| <= 2``, else ``4 |z| - 4``: continuous, and of the same slope
        where the two meet (Huber 1964, doi:10.1214/aoms/1177703732).

        Parameters
        ----------
        value : float
            In the unit of the target.

        Returns
        -------
        float
            0 or more; 0 is best, at the target, and 1 one spread from it.

        Examples
        --------
        >>> target = Target(10, 2)
        >>> [target.cost(value) for value in (10, 12, 8, 14, 20)]
        [0.0, 1.0, 1.0, 4.0, 16.0]
        """
        return _huber((value - self.value) / self.spread)

    def ratio_cost(self, value: float) -> float:
        """How far a value is off by ratio: for areas, lengths, thicknesses.

        ``h(z)`` as in :meth:`cost`, with
        ``z = ln(value / self.value) / ln(1 + self.spread / self.value)``: half as much is as far
        off as twice as much, and ``z`` is 1 at ``self.value + self.spread``.

        Parameters
        ----------
        value : float
            In the unit of the target. What is below ``1e-6 * self.value`` counts as that.

        Returns
        -------
        float
            0 or more; 0 is best, at the target, and 1 one spread above it.

        Raises
        ------
        UsageError
            The target's own value is not positive: ratios to it mean nothing.

        Examples
        --------
        >>> target = Target(0.1, 0.1)
        >>> [round(target.ratio_cost(value), 9) for value in (0.1, 0.2, 0.05, 0.4, 0.8)]
        [0.0, 1.0, 1.0, 4.0, 8.0]
        """
        self.require_positive()
        off = LEAST_LOG_RATIO
        if not value <= 0:  # NaN goes on, and comes out
            off = max(math.log(value) - self.log_value, off)
        return _huber(off / self.log_spread)

    def require_positive(self) -> None:
        """Refuse to compare by ratio with a value that is not positive.

        Raises
        ------
        UsageError
        """
        if self.value <= 0:
            raise UsageError(
                f"the target {self} must have a positive value, since ratios to it are compared"
            )

    @cached_property
    def log_value(self) -> float:
        """The natural logarithm of the value."""
        return math.log(self.value)

    @cached_property
    def log_spread(self) -> float:
        """How far the logarithm of a value one spread above the target is from that of this one."""
        # A spread that is next to nothing beside the value has a logarithm of 0.
        return math.log1p(self.spread / self.value) or sys.float_info.min


def hubers(z: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """``h(z)`` of each number; see :meth:`Target.cost`."""
    import numpy as np

    size = np.abs(z)
    beyond = 2.0 * _BEND * np.minimum(size, _MOST) - _BEND * _BEND
    return np.where(size <= _BEND, size * size, beyond)


def _huber(z: float) -> float:
    size = abs(z)
    if size <= _BEND:
        return size * size
    return 2.0 * _BEND * min(size, _MOST) - _BEND * _BEND
