"""Constraints for tests of the core: symmetric about the plane x = 0 of unit coordinates."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core.components.constraint_function import constraint
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ConstraintSpec
from moseg_core.components.parameters import Interval

TINY = np.finfo(np.float64).tiny
FLIP = np.array([-1.0, 1.0, 1.0, 1.0])


class Mirror:
    """The first label is the mirror image of the second."""

    flip = FLIP

    def __init__(self, shape, labels):
        self.determines, self.reads = (labels[0],), (labels[1],)
        self.lower = self.upper = np.empty(0)

    def expand(self, free, centers):
        whole = centers.copy()
        whole[self.determines[0]] = self.flip * centers[self.reads[0]]
        return whole

    def reduce(self, centers):
        whole = centers.copy()
        (k,), (j,) = self.determines, self.reads
        whole[j] = (centers[j] + self.flip * centers[k]) / 2.0
        whole[k] = self.flip * whole[j]
        return np.empty(0), whole


class Upside(Mirror):
    """The first label is the second upside down: mirrored at y = 0."""

    flip = np.array([1.0, -1.0, 1.0, 1.0])


class OnPlane:
    """Each label has its centre on the plane."""

    each = True

    def __init__(self, shape, labels, *, plane: str = "auto"):
        (self.label,) = labels
        self.plane = plane
        self.determines, self.reads = tuple(labels), ()
        self.lower, self.upper = np.array([-np.inf, -np.inf, TINY]), np.full(3, np.inf)

    def expand(self, free, centers):
        whole = centers.copy()
        whole[self.label] = [0.0, *free]
        return whole

    def reduce(self, centers):
        free = centers[self.label, 1:]
        return free, self.expand(free, centers)


class Tilted(OnPlane):
    """Takes a word and a number."""

    def __init__(
        self, shape, labels, *, plane: str = "auto", share: Annotated[float, Interval(0, 1)] = 0.5
    ):
        super().__init__(shape, labels, plane=plane)
        self.share = share


class Between:
    """The first label is half-way between the second and the third."""

    def __init__(self, shape, labels):
        self.determines, self.reads = (labels[0],), tuple(labels[1:])
        self.lower = self.upper = np.empty(0)

    def expand(self, free, centers):
        whole = centers.copy()
        whole[self.determines[0]] = centers[list(self.reads)].mean(axis=0)
        return whole

    def reduce(self, centers):
        return np.empty(0), self.expand(np.empty(0), centers)


class Itself(Mirror):
    """Claims to follow from the label that it determines."""

    def __init__(self, shape, labels):
        super().__init__(shape, labels)
        self.reads = self.determines


class Misshapen(OnPlane):
    """Returns rows of a wrong shape."""

    def expand(self, free, centers):
        return np.zeros((1, 3))


class Failing(OnPlane):
    """Raises where it should give the centres."""

    def expand(self, free, centers):
        raise ZeroDivisionError("by nothing")


class Nothing:
    """Is no constraint."""

    def __init__(self, shape, labels):
        pass


@constraint(start=[0.3, 0.0, 0.0, 1.0])
def pair(free):
    """Two centres that mirror each other, as a user would write it."""
    return [free, FLIP * free]


def known() -> Registry:
    """Everything installed, and these constraints as the bundle ``test``."""
    names = ["Mirror", "Upside", "OnPlane", "Tilted", "Between", "Itself", "Misshapen", "Failing"]
    names += ["Nothing", "pair"]
    specs = [ConstraintSpec(name=name.lower(), target=f"{__name__}:{name}") for name in names]
    found = tuple(Component("test", "tests 1.0", spec) for spec in specs)
    rest = [bundle for bundle in registry().bundles if bundle.name in ("core", "basic")]
    return Registry([*rest, Bundle("test", "tests", "1.0", __name__, found)])
