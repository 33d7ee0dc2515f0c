"""Objectives whose parameters are not what they declare."""

from __future__ import annotations

from typing import Annotated

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.objectives import objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part

_HERE = "tests.testing.broken.declarations"

BROKEN = {
    "parameters-round-trip": ObjectiveSpec(name="broken", target=f"{_HERE}:by_default_too_much"),
    "parameters-in-range": ObjectiveSpec(name="broken", target=f"{_HERE}:divides_by_it"),
    "parameter-out-of-range": ObjectiveSpec(name="broken", target=f"{_HERE}:takes_anything"),
}


class Lenient(Interval):
    """Bounds that are written down and not kept."""

    def __contains__(self, value):
        return True


@objective(range=(0, 1))
def by_default_too_much(part: Part, *, most: Annotated[float, Interval(0, 1)] = 2.0) -> float:
    """Its default is out of its own bounds."""
    return min(1.0, max(0.0, most - part.area / part.shape.area))


@objective(range=(0, 1))
def divides_by_it(part: Part, *, power: Annotated[float, Interval(0, 4)] = 1.0) -> float:
    """It allows 0, and divides by it."""
    return (part.area / part.shape.area) ** (1.0 / power)


@objective(range=(0, 1))
def takes_anything(part: Part, *, most: Annotated[float, Lenient(0, 1)] = 1.0) -> float:
    """It refuses no number."""
    return min(1.0, abs(most - part.area / part.shape.area))
