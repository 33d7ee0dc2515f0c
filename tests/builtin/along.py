"""A field that rises along an axis, and an objective that is its mean, for terms about places."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import FieldSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.shape.shape import Shape


def along(shape: Shape, *, axis: int, times: float = 1.0) -> np.ndarray:
    return times * shape.points[:, axis]


@objective(mean_of=lambda given: ("made:along", given))
def far(part: Part, *, axis: int, times: float = 1.0) -> float:
    return part.field("made:along", axis=axis, times=times).mean


@objective()
def area(part: Part) -> float:
    return part.area


def registry_with_along(monkeypatch: pytest.MonkeyPatch) -> Registry:
    """A registry that has the field alone, as ``made:along``."""
    module = types.ModuleType("made_along")
    module.along = along
    monkeypatch.setitem(sys.modules, "made_along", module)
    spec = FieldSpec(name="along", target="made_along:along")
    found = (Component("made", "moseg-made 1.0", spec),)
    return Registry([Bundle("made", "moseg-made", "1.0", "made_along", found)])
