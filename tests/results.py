"""A result made by hand, without a search, for tests of what is done with results."""

from __future__ import annotations

from typing import Any

import numpy as np

from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.problem.problem import Problem
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape


@objective(range=(0, float("inf")))
def area(part: Part) -> float:
    """The area of a part."""
    return part.area


def result_on(shape: Shape, **more: Any) -> Result:
    """The first half of a shape's elements is "first", the rest is "second"."""
    labels = (np.arange(shape.n_elements) >= shape.n_elements // 2).astype(np.int32)
    problem = Problem(["first", "second"], "2*area(first)", objectives={"area": area})
    fields: dict[str, Any] = {
        "shape": shape,
        "problem": problem,
        "labels": labels,
        "evaluation": problem.evaluate(shape, labels),
        "centers": Centers(positions=shape.points[[0, -1]], weights=np.array([1.0, 2.0])),
        "history": {
            "seeding": ({"round": 1, "largest_step": 0.5}, {"round": 2, "largest_step": 0.1}),
            "search": ({"iteration": 0, "value": 9.0}, {"iteration": 1, "value": 8.0}),
        },
        "method": {"seeder": "core:kmeans"},
        "seed": 3,
        "versions": {"core:kmeans": "moseg-core 0.1.0"},
        "reason": "converged",
    }
    return Result(**{**fields, **more})
