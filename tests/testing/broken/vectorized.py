"""Objectives whose vectorised forms are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.part_array import PartArray

BROKEN = {
    "objective-vectorized-equals-single": ObjectiveSpec(
        name="broken", target="tests.testing.broken.vectorized:says_two_things"
    ),
    "objective-not-below-its-bound": ObjectiveSpec(
        name="broken", target="tests.testing.broken.vectorized:promises_more_than_it_has"
    ),
}


def shares_of(parts: PartArray) -> np.ndarray:
    return parts.areas / parts.shape.area


@objective(range=(0, 1), vectorized=lambda parts: shares_of(parts) ** 2)
def says_two_things(part: Part) -> float:
    """Its vectorised form squares what it does not."""
    return part.area / part.shape.area


def normalized(parts: PartArray) -> np.ndarray:
    """Divided by the mean over all calls and multiplied with it, which rounds."""
    shares = shares_of(parts)
    middle = 3.7 * shares.mean()
    return np.clip(shares / middle * middle, 0, 1)


@objective(range=(0, 1), vectorized=normalized)
def looks_at_its_neighbours(part: Part) -> float:
    """Its last digits depend on which other parts are asked about."""
    return part.area / part.shape.area


@objective(range=(-1, 1), vectorized=lambda parts: shares_of(parts) - shares_of(parts).mean())
def compares_with_the_others(part: Part) -> float:
    """A part is alone in a call, and 0 there, whatever other parts have."""
    return 0.0


@objective(range=(0, 1), vectorized=lambda parts: shares_of(parts).mean())
def sums_up(part: Part) -> float:
    """It returns a single number for all calls."""
    return part.area / part.shape.area


def written(parts: PartArray) -> np.ndarray:
    """It divides in place what others read too."""
    shares = parts.areas
    shares /= parts.shape.area
    return shares


@objective(range=(0, 1), vectorized=written)
def writes_to_areas(part: Part) -> float:
    """Its vectorised form writes to an array that it was given."""
    return part.area / part.shape.area


def scaled(parts: PartArray, *, factor: float) -> np.ndarray:
    """It has no default."""
    return factor * shares_of(parts)


@objective(range=(0, 100), vectorized=scaled)
def has_other_defaults(part: Part, *, factor: float = 1.0) -> float:
    """A call need not give what its vectorised form must have."""
    return factor * part.area / part.shape.area


@objective(range=(0, 1), at_least=lambda parts: np.where(shares_of(parts) > 0.99, 0.6, 0.0))
def promises_more_than_it_has(part: Part) -> float:
    """The lower bound of a part that is everything is above its value."""
    return 0.5 * part.area / part.shape.area


@objective(range=(0, 1), at_least=lambda parts: shares_of(parts).mean())
def bounds_all_at_once(part: Part) -> float:
    """Its lower bound is a single number for all calls."""
    return part.area / part.shape.area


@objective(range=(0, 1), at_least=lambda parts: 0.9 * shares_of(parts))
def keeps_its_bound(part: Part) -> float:
    """Nothing is wrong."""
    return part.area / part.shape.area


@objective(range=(0, 1), vectorized=shares_of)
def agrees(part: Part) -> float:
    """Nothing is wrong."""
    return part.area / part.shape.area
