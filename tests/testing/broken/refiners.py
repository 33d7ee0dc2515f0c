"""Refiners that are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.components.discovery.specs import RefinerSpec
from moseg_core.components.protocols import Progress

_NAMES = {
    "refiner-labels": "Averages",
    "refiner-keeps-parts": "SwallowsTheSmall",
    "refiner-obeys-pins": "Spreads",
    "refiner-heeds-report": "NeverEnds",
}

BROKEN = {
    id: RefinerSpec(name="broken", target=f"tests.testing.broken.refiners:{name}")
    for id, name in _NAMES.items()
}


class Averages:
    """The mean of the labels all around, which is none of them."""

    def __call__(self, evaluator, labels, *, report):
        return labels + 0.5


class SwallowsTheSmall:
    """Elements without a neighbour of their own label take that of another."""

    def __call__(self, evaluator, labels, *, report):
        refined = labels.copy()
        if evaluator.shape.adjacency is None:
            return refined
        pairs = evaluator.shape.adjacency.pairs
        alone = np.ones(len(labels), bool)
        alone[pairs[labels[pairs[:, 0]] == labels[pairs[:, 1]]]] = False
        alone[evaluator.pins.elements] = False
        for one, other in np.concatenate([pairs, pairs[:, ::-1]]):
            if alone[one]:
                refined[one] = labels[other]
        return refined


class Spreads:
    """The first part by one element on all sides, whatever is pinned there."""

    def __call__(self, evaluator, labels, *, report):
        refined = labels.copy()
        if evaluator.shape.adjacency is None:
            return refined
        for one, other in evaluator.shape.adjacency.pairs:
            if sorted(labels[[one, other]]) == [0, 1]:
                refined[[one, other]] = 0
        lost = np.setdiff1d(labels, refined)
        refined[np.isin(labels, lost)] = labels[np.isin(labels, lost)]
        return refined


class NeverEnds:
    """It reports, and goes on whatever it is told."""

    def __call__(self, evaluator, labels, *, report):
        for done in range(3):
            report(Progress(stage="broken", done=done))
        return labels.copy()


class OneTooMany:
    """Labels that are counted from 1."""

    def __call__(self, evaluator, labels, *, report):
        return labels + 1


class AsTheyAre:
    """It moves nothing, and breaks nothing."""

    def __call__(self, evaluator, labels, *, report):
        return labels
