"""Seeders that are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.components.discovery.specs import SeederSpec
from moseg_core.components.protocols import Progress, Seeding

_NAMES = {
    "seeder-count": "OneTooFew",
    "seeder-distinct": "WithReplacement",
    "seeder-near-shape": "UnitCoordinates",
    "seeder-weights": "WeighsNothing",
    "seeder-reproducible": "RemembersTheLast",
    "seeder-heeds-report": "GoesOn",
}

BROKEN = {
    id: SeederSpec(name="broken", target=f"tests.testing.broken.seeders:{name}")
    for id, name in _NAMES.items()
}


class Drawn:
    """Elements at random; nothing is wrong with it."""

    def chosen(self, evaluator, rng):
        n = len(evaluator.problem.labels)
        return evaluator.shape.points[rng.choice(evaluator.shape.n_elements, n, replace=False)]

    def __call__(self, evaluator, *, rng, report):
        return Seeding(centers=self.chosen(evaluator, rng))


class OneTooFew(Drawn):
    """One of several centres is missing."""

    def chosen(self, evaluator, rng):
        centers = super().chosen(evaluator, rng)
        return centers if len(centers) < 4 else centers[1:]


class OneTooFewOfThree(Drawn):
    """One of three centres is missing; of more or fewer there is none."""

    def chosen(self, evaluator, rng):
        centers = super().chosen(evaluator, rng)
        return centers[1:] if len(centers) == 3 else centers


class NotThree(Drawn):
    """It ends with an error where there are three labels."""

    def chosen(self, evaluator, rng):
        centers = super().chosen(evaluator, rng)
        if len(centers) == 3:
            raise ZeroDivisionError("of three")
        return centers


class WithReplacement(Drawn):
    """One element may be drawn twice."""

    def chosen(self, evaluator, rng):
        n = len(evaluator.problem.labels)
        return evaluator.shape.points[rng.choice(evaluator.shape.n_elements, n)]


class UnitCoordinates(Drawn):
    """Centres in the coordinates of vectors."""

    def chosen(self, evaluator, rng):
        return evaluator.shape.frame.to_unit(super().chosen(evaluator, rng))


class WeighsNothing(Drawn):
    """The first of several labels has a weight of 0."""

    def __call__(self, evaluator, *, rng, report):
        centers = self.chosen(evaluator, rng)
        weights = np.arange(1.0, 1 + len(centers))
        return Seeding(centers=centers, weights=weights - (len(centers) > 1))


class RemembersTheLast(Drawn):
    """The second call goes on from the first."""

    def __init__(self):
        self.calls = 0

    def chosen(self, evaluator, rng):
        self.calls += 1
        for _ in range(self.calls):
            centers = super().chosen(evaluator, rng)
        return centers


class GoesOn(Drawn):
    """Three rounds, whatever the answer to its reports."""

    def __call__(self, evaluator, *, rng, report):
        for done in range(3):
            report(Progress(stage="drawing", done=done))
        return super().__call__(evaluator, rng=rng, report=report)
