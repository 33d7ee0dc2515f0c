"""Objectives that declare an invariance which they do not have."""

from __future__ import annotations

import math

import numpy as np

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation

_NAMES = {
    "objective-rigid": "to_the_right",
    "objective-scale": "large",
    "objective-reflection": "to_one_side",
    "objective-order": "near_its_first",
    "objective-tessellation": "many",
    "objective-symmetric": "less_than",
    "objective-label-order": "the_first",
}

BROKEN = {
    id: ObjectiveSpec(name="broken", target=f"tests.testing.broken.invariances:{name}")
    for id, name in _NAMES.items()
}


@objective(range=(0, 1), invariant_to=["rigid"])
def to_the_right(part: Part) -> float:
    """Where along the file's first axis a part is."""
    return 0.5 + 0.5 * math.tanh(part.centroid[0])


@objective(range=(0, math.inf), invariant_to=["scale"])
def large(part: Part) -> float:
    """The area, in the user's units."""
    return part.area


@objective(range=(0, 1), invariant_to=["reflection"])
def to_one_side(part: Part) -> float:
    """On which side of the origin a part is."""
    return 0.5 + 0.5 * math.tanh(part.centroid[0])


@objective(range=(0, math.inf), invariant_to=["order"])
def near_its_first(part: Part) -> float:
    """How far a part is from its first element."""
    return float(np.linalg.norm(part.centroid - part.points[0]))


@objective(range=(0, math.inf), invariant_to=["tessellation"])
def many(part: Part) -> float:
    """How many elements a part has."""
    return float(part.n_elements)


@objective(range=(0, 1), invariant_to=["labels"])
def less_than(first: Part, second: Part) -> float:
    """How much of two parts is the first."""
    return first.area / (first.area + second.area)


@objective(range=(0, 1), invariant_to=["labels"])
def the_first(segmentation: Segmentation) -> float:
    """How much of the whole is the first part."""
    return segmentation.parts[0].area / segmentation.shape.area
