"""Components with nothing wrong that are unlike most, and one that takes its process with it."""

from __future__ import annotations

import math
import os
from typing import Annotated

from moseg_core.components.constraint_function import constraint
from moseg_core.components.objectives import Traits, objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part
from moseg_core.language import Target


@constraint(start=[0.3, 1.0])
def opposite(free):
    """A constraint that is a function: two centres at equal distances from the middle."""
    x, w = free
    return [[x, 0.0, 0.0, w], [-x, 0.0, 0.0, w]]


class Share:
    """An objective that is an object of a class of its own, with state."""

    traits = Traits(arity="unary", range=(0.0, 1.0), invariant_to=frozenset({"rigid", "order"}))
    parameters = ()

    def __init__(self, power):
        self.power = power

    def __call__(self, part, /):
        return (part.area / part.shape.area) ** self.power


share = Share(2.0)


@objective(range=(0, 1))
def near(part: Part, *, share: Annotated[float, Interval(0, 1)], sharp: bool = False) -> float:
    """An objective with a parameter that must be given."""
    apart = min(1.0, abs(part.area / part.shape.area - share))
    return apart if sharp else apart**2


@objective(range=(0, math.inf), invariant_to=["rigid", "scale", "reflection"])
def sized(
    part: Part,
    *,
    area: Annotated[Target, Interval(0, 1)],
    length: Target | None = None,
    slender: Annotated[Target | None, Interval(0)] = Target(0.3, 0.2),
) -> float:
    """An objective with targets: one that must be given, one without bounds, one by default."""
    found = area.cost(part.area / part.shape.area)
    if length is not None:
        found += length.ratio_cost(float(part.scales[0]) / part.shape.area**0.5)
    if slender is not None:
        found += slender.cost(float(part.scales[1] / part.scales[0]))
    return found


@objective(range=(0, 1), invariant_to=["labels"])
def four(first: Part, second: Part, third: Part, fourth: Part) -> float:
    """An objective on more parts than the zoo has."""
    areas = [part.area for part in (first, second, third, fourth)]
    return min(areas) / max(areas)


def end(part):
    """A measure that ends its process."""
    os._exit(1)
