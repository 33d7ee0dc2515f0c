"""Constraints that are broken in one way each.

All are about two labels, the first of which has the height of the second's centre, that is the
same ``z``, and otherwise numbers of its own: ``x, y`` and the weight.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core.components.constraint_function import constraint
from moseg_core.components.discovery.specs import ConstraintSpec
from moseg_core.components.parameters import Interval
from moseg_core.errors import UsageError

_NAMES = {
    "constraint-dimensions": "ReadsWhatItDetermines",
    "constraint-in-bounds": "BoundsTooNarrow",
    "constraint-reduce-expand": "ANumberForNothing",
    "constraint-feasible": "LeavesThemWhereTheyAre",
    "constraint-unchanged": "AlwaysMoves",
    "constraint-touches-only-its-own": "ReadsInSecret",
}

BROKEN = {
    id: ConstraintSpec(name="broken", target=f"tests.testing.broken.constraints:{name}")
    for id, name in _NAMES.items()
}


class Level:
    """The first label at the height of the second; nothing is wrong with it."""

    def __init__(self, shape, labels):
        if len(labels) != 2:
            raise UsageError("constraint 'level' takes two labels")
        self.follower, self.source = labels

    @property
    def determines(self):
        return (self.follower,)

    @property
    def reads(self):
        return (self.source,)

    @property
    def lower(self):
        return np.array([-np.inf, -np.inf, np.finfo(float).tiny])

    @property
    def upper(self):
        return np.full(3, np.inf)

    def expand(self, free, centers):
        rows = centers.copy()
        rows[self.follower] = free[0], free[1], centers[self.source, 2], free[2]
        return rows

    def reduce(self, centers):
        rows = centers.copy()
        rows[[self.follower, self.source], 2] = centers[[self.follower, self.source], 2].mean()
        return rows[self.follower, [0, 1, 3]], rows


@constraint(start=[0.3, 1.0])
def opposite(free):
    """Two centres on opposite sides of the middle; nothing is wrong with it."""
    x, w = free
    return [[x, 0, 0, w], [-x, 0, 0, w]]


class Refusing(Level):
    """It refuses one value of its parameter, as it may; nothing is wrong with it."""

    def __init__(self, shape, labels, *, order: Annotated[int, Interval(0, 5)] = 2):
        super().__init__(shape, labels)
        if order == 0:
            raise UsageError("constraint 'refusing' takes no order of 0 here")


class Dividing(Level):
    """It ends with an error for a value that its declaration allows."""

    def __init__(self, shape, labels, *, order: Annotated[int, Interval(0, 5)] = 2):
        super().__init__(shape, labels)
        self.share = 1 / order


class ReadsWhatItDetermines(Level):
    """Its own row is among those that it says it reads."""

    @property
    def reads(self):
        return (self.follower, self.source)


class BoundsTooNarrow(Level):
    """Weights below 1 are out of bounds, and not clipped."""

    @property
    def lower(self):
        return np.array([-np.inf, -np.inf, 1.0])


class ANumberForNothing(Level):
    """A fourth number that has no effect."""

    @property
    def lower(self):
        return np.append(super().lower, -np.inf)

    @property
    def upper(self):
        return np.append(super().upper, np.inf)

    def reduce(self, centers):
        free, rows = super().reduce(centers)
        return np.append(free, 0.0), rows


class LeavesThemWhereTheyAre(Level):
    """The centres that it returns are those that it was given."""

    def reduce(self, centers):
        return super().reduce(centers)[0], centers.copy()


class AlwaysMoves(Level):
    """Centres that are level already are moved all the same."""

    def reduce(self, centers):
        free, rows = super().reduce(centers)
        rows[self.source, 0] += 0.01
        return free, rows


class ReadsInSecret(Level):
    """It does not say that it reads the second label."""

    @property
    def reads(self):
        return ()
