"""What an objective's value comes from: the quantities behind it, said as people read them.

The value of an objective says how bad a part is, not what is bad about it. An objective that
compares several quantities may tell: it declares a function ``details``
(:class:`moseg_core.components.objectives.Traits`) that is called like the objective and gives a
:class:`Detail` for each of them. ``moseg explain`` names the costliest of each part, "leg2:
thickness 9 %, typical 4 ± 1"; results hold them all. No search asks for details.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from moseg_core.errors import UsageError
from moseg_core.language import Target


@dataclass(frozen=True, kw_only=True)
class Detail:
    """One of the quantities that the value of an objective comes from.

    Parameters
    ----------
    name : str
        What people call it: "thickness".
    value : float
        As it was measured.
    cost : float
        What it adds to the objective's value; of all details together the value, where that is a
        sum.
    expected : Target or None
        What it was compared with, in the same unit.
    percent : bool
        Whether people read it in percent: a share, or a ratio to the size of the shape.

    Raises
    ------
    UsageError
        A value or cost that is not a finite number.

    Examples
    --------
    >>> usual = Target(0.04, 0.01)
    >>> print(Detail(name="thickness", value=0.09, cost=2.0, expected=usual, percent=True))
    thickness 9 %, typical 4 ± 1
    >>> print(Detail(name="unevenness", value=0.5127, cost=0.1, expected=Target(0.333, 0.25)))
    unevenness 0.51, typical 0.33 ± 0.25
    """

    name: str
    value: float
    cost: float
    expected: Target | None = None
    percent: bool = False

    def __post_init__(self) -> None:
        for name in ("value", "cost"):
            number = float(getattr(self, name))
            if not math.isfinite(number):
                raise UsageError(f"the {name} of detail '{self.name}' must be finite, not {number}")
            object.__setattr__(self, name, number)

    def __str__(self) -> str:
        scale, unit = (100.0, " %") if self.percent else (1.0, "")
        measured = scale * self.value
        if self.expected is None:
            return f"{self.name} {measured:.3g}{unit}"
        spread = scale * self.expected.spread
        places = _decimals(spread)
        said, typical = (
            f"{round(number, places) + 0.0:.{places}f}"  # + 0.0: no "-0"
            for number in (measured, scale * self.expected.value)
        )
        return f"{self.name} {said}{unit}, typical {typical} ± {spread:.{places}f}"


def _decimals(size: float) -> int:
    """How many decimals show two digits of a number, fewer where the last would be 0."""
    places = max(0, 1 - math.floor(math.log10(size)))
    while places > 0 and round(size, places) == round(size, places - 1):
        places -= 1
    return places
