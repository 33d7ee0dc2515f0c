"""Labelers that are broken in one way each."""

from __future__ import annotations

import numpy as np

from moseg_core.components.discovery.specs import LabelerSpec
from moseg_core.search.assignment import optimal_assignment

_NAMES = {
    "labeler-permutation": "EachForItself",
    "labeler-optimal": "TheWorst",
    "labeler-equivariant": "AsTheyCome",
}

BROKEN = {
    id: LabelerSpec(name="broken", target=f"tests.testing.broken.labelers:{name}")
    for id, name in _NAMES.items()
}


class EachForItself:
    """Each label takes the part that it likes best, be it taken already."""

    def __call__(self, evaluator, vector):
        return evaluator.unary_costs(vector).all().argmin(axis=0)


class NotThree:
    """It ends with an error where there are three labels."""

    def __call__(self, evaluator, vector):
        order = optimal_assignment(evaluator.unary_costs(vector).all())
        if len(order) == 3:
            raise ZeroDivisionError("of three")
        return order


class OneOfThreeTwice:
    """Of three centres one gets two labels."""

    def __call__(self, evaluator, vector):
        order = optimal_assignment(evaluator.unary_costs(vector).all())
        return order[[0, 0, 1]] if len(order) == 3 else order


class TheWorst:
    """The assignment of the greatest cost, which it takes for the least."""

    optimal = "unary"

    def __call__(self, evaluator, vector):
        return optimal_assignment(-evaluator.unary_costs(vector).all())


class AsTheyCome:
    """Labels in the order of the parts."""

    def __call__(self, evaluator, vector):
        return np.arange(len(evaluator.problem.labels))
