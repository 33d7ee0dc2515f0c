"""Objectives that are broken in one way each."""

from __future__ import annotations

import math
from typing import Annotated
from weakref import WeakKeyDictionary

import numpy as np

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.objectives import objective
from moseg_core.components.parameters import Interval
from moseg_core.components.part import Part

_NAMES = {
    "objective-returns": "divides_by_the_height",
    "objective-in-range": "promises_too_much",
    "objective-sees-its-parts": "counts_labels",
    "objective-requires-what-it-reads": "looks_for_a_volume",
    "objective-keeps-shapes-apart": "goes_by_the_name",
    "objective-expects-a-share": "expects_whatever_is_said",
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
