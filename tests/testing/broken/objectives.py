"""Objectives that are broken in one way each."""

from __future__ import annotations

import math
from typing import Annotated
from weakref import WeakKeyDictionary

import numpy as np

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.field import field_values
from moseg_core.components.objectives import objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation

_NAMES = {
    "objective-returns": "divides_by_the_height",
    "objective-in-range": "promises_too_much",
    "objective-sees-its-parts": "counts_labels",
    "objective-requires-what-it-reads": "looks_for_a_volume",
    "objective-fields-exist": "hopes_for_a_field",
    "objective-declares-its-fields": "reads_in_secret",
    "objective-keeps-shapes-apart": "goes_by_the_name",
    "objective-expects-a-share": "expects_whatever_is_said",
    "objective-is-the-mean-it-says": "is_in_the_middle",
    "objective-tells-details": "tells_tales",
    "objective-memo-equals-fresh": "looks_into_the_memo",
    "objective-batch-equals-loop": "gets_tired",
}

BROKEN = {
    id: ObjectiveSpec(name="broken", target=f"tests.testing.broken.objectives:{name}")
    for id, name in _NAMES.items()
}


@objective(range=(0, math.inf))
def divides_by_the_height(part: Part) -> float:
    """A flat part has none."""
    return float(part.scales[0]) / float(part.scales[2])


@objective(range=(0, 0.5))
def promises_too_much(part: Part) -> float:
    """A flat round part has more than a half."""
    return float(part.scales[1] / part.scales[0])


@objective(range=(0, 1), invariant_to=("rigid", "scale", "order"))
def answers_in_words(part: Part) -> float:
    """A text, which Python would take for a number."""
    return str(part.area / part.shape.area)


@objective(range=(0, 1))
def leaves(part: Part) -> float:
    """It ends the program."""
    raise SystemExit(0)


@objective(range=(0, math.inf))
def counts_labels(part: Part) -> float:
    """It depends on how the rest of the shape is labelled."""
    return float(len(np.unique(part._level_labels)))


@objective(range=(0, 1))
def looks_for_a_volume(part: Part) -> float:
    """Most shapes that are scanned have none, and it did not ask for one."""
    volume = part.shape.volume
    return 1.0 if volume is None else min(1.0, part.area**1.5 / volume / 100)


@objective(range=(0, math.inf))
def counts_triangles(part: Part) -> float:
    """A cloud has none, which it does not notice."""
    return float(len(part.triangles))


@objective(range=(0, math.inf))
def counts_triangles_or_points(part: Part) -> float:
    """It can do without: nothing is wrong."""
    return float(len(part.triangles) or len(part.points))


@objective(range=(0, math.inf))
def counts_pieces(part: Part) -> float:
    """Of a cloud nobody knows how many there are."""
    return float(part.n_components)


@objective(range=(0, math.inf))
def follows_its_boundary(part: Part) -> float:
    """Of a cloud nobody knows which points touch, and it did not say that it needs to know."""
    return part.boundary.length


@objective(range=(0, math.inf))
def follows_all_boundaries(segmentation: Segmentation) -> float:
    """The same of all parts together."""
    return segmentation.boundaries.length


@objective(range=(0, math.inf), fields=("given:higth",))
def hopes_for_a_field(part: Part) -> float:
    """It declares a field that nobody has."""
    return part.area


@objective(range=(0, math.inf), fields=lambda parameters: parameters["factor"])
def asks_what_was_not_said(part: Part, *, factor: float = 1.0) -> float:
    """A parameter that a call does not give is not among those of the call."""
    return part.area * factor


@objective(range=(0, math.inf))
def reads_in_secret(part: Part) -> float:
    """It reads a field that it does not declare."""
    return part.field("given:height").spread


@objective(fields=("given:height",))
def reads_by_another_way(part: Part) -> float:
    """It asks for the values of a field on the whole shape, which it does not declare."""
    values = field_values(part.shape, "given:thirds", lookup=part.lookup)
    return float(part.areas @ values[part.elements])


cache: dict = {}


@objective(range=(0, 1))
def goes_by_the_name(part: Part) -> float:
    """It remembers values under the name of the shape, which several have."""
    key = part.shape.name, part.membership
    if key not in cache:
        cache[key] = float(part.scales[1] / part.scales[0])
    return cache[key]


@objective(range=(0, 1), share=lambda given: given.get("share"))
def expects_whatever_is_said(part: Part, *, share: Annotated[float, Interval(0, 1)] = 0.5) -> float:
    """With a share of 0 no part is content."""
    return abs(part.area / part.shape.area - share)


@objective(fields=("given:height",), mean_of=lambda given: ("given:height", {}))
def is_in_the_middle(part: Part) -> float:
    """It is halfway between the least and the greatest value, and not the mean."""
    height = part.field("given:height")
    return (height.least + height.greatest) / 2


@objective(fields=("given:height",), mean_of=lambda given: "given:height")
def names_a_field_alone(part: Part) -> float:
    """It does not say which parameters the field has."""
    return part.field("given:height").mean


@objective(mean_of=lambda given: ("given:higth", {}))
def is_a_mean_of_nothing(part: Part) -> float:
    """Nobody has the field that it is said to be the mean of."""
    return part.area


@objective(
    fields=("given:height",), mean_of=lambda given: ("given:height", {"factor": given["factor"]})
)
def scales_what_was_not_said(
    part: Part, *, factor: Annotated[float, Interval(0, 10)] = 1.0
) -> float:
    """A call need not give a parameter that has a default."""
    return part.field("given:height", factor=factor).mean


@objective(range=(0, 1), details=lambda part: [("area", part.area)])
def tells_tales(part: Part, *, most: Annotated[float, Interval(0, 1)] = 1.0) -> float:
    """What it tells is no Detail, and is not asked with its parameters."""
    return min(most, part.area / part.shape.area)


@objective(range=(0, 1))
def looks_into_the_memo(part: Part) -> float:
    """It depends on whether there is room in the core's memory."""
    return 0.25 if part.memo.size else 0.75


calls: WeakKeyDictionary = WeakKeyDictionary()


@objective(range=(0, 1))
def gets_tired(part: Part) -> float:
    """After twenty calls on a shape it has had enough."""
    calls[part.shape] = calls.get(part.shape, 0) + 1
    return 0.25 if calls[part.shape] <= 20 else 0.75
