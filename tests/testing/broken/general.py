"""Components that are not found, cannot be made, or do not answer."""

from __future__ import annotations

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.specs import MeasureSpec, ObjectiveSpec, SeederSpec
from moseg_core.components.protocols import Seeding

_HERE = "tests.testing.broken.general"

BROKEN = {
    "target-resolves": ObjectiveSpec(name="broken", target=f"{_HERE}:not_there"),
    "signature-fits": ObjectiveSpec(name="broken", target=f"{_HERE}:undecorated"),
    "default-construction": SeederSpec(name="broken", target=f"{_HERE}:WantsAFile"),
    "protocol-answered": SeederSpec(name="broken", target=f"{_HERE}:TellsNobody"),
    "bundle-imports-light": MeasureSpec(name="broken", target="tests.testing.broken.heavy:spread"),
}

BUNDLES = {"bundle-imports-light": "tests.testing.broken.heavy"}
"""Modules of bundles that are not light themselves."""


def undecorated(part):
    """A formula that is no objective yet."""
    return part.area


class WantsAFile:
    """A seeder that reads a file when it is made, and there is none."""

    def __init__(self):
        raise FileNotFoundError("places.txt")


class TellsNobody:
    """A seeder that does not take the function to report to."""

    def __call__(self, evaluator, rng):
        return Seeding(centers=evaluator.shape.points[: evaluator.parameterization.n_parts])


class DistancesOfNoPoints(Voronoi):
    """It looks clippable, and does not take the points that boundaries are clipped at."""

    def distances(self, vector):
        return super().distances(vector, self._shape.points)
