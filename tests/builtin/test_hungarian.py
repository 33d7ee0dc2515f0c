"""Labels by assignment against a look at all permutations."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from moseg_core.builtin.hungarian import Hungarian
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Labeler
from moseg_core.problem.problem import Problem
from moseg_core.search.assignment import optimal_assignment
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import least_assignment_cost

square = st.integers(1, 6).flatmap(
    lambda n: hnp.arrays(np.float64, (n, n), elements=st.floats(-100, 100) | st.integers(-2, 2))
)


@given(square)
@settings(max_examples=200)
def test_the_assignment_costs_as_little_as_the_best_permutation(costs):
    order = optimal_assignment(costs)
    n = len(costs)
    assert sorted(order.tolist()) == list(range(n))
    found = math.fsum(costs[order[label], label] for label in range(n))
    best = least_assignment_cost(costs.tolist())
    assert found == pytest.approx(best, abs=1e-9)
    assert (optimal_assignment(costs.copy()) == order).all()


def test_the_entry_of_a_label_is_its_centre():
    # Segment 2 is cheap as label 0, 0 as 1, 1 as 2: a cycle that is not its own inverse.
    costs = np.full((3, 3), 9.0)
    costs[2, 0] = costs[0, 1] = costs[1, 2] = 1.0
    assert optimal_assignment(costs).tolist() == [2, 0, 1]


@objective(range=(0, 100))
def off(part: Part, *, size: float) -> float:
    return abs(part.area - size)


@pytest.mark.parametrize("start", list(itertools.permutations(range(3))))
def test_centres_in_any_order_get_the_labels_that_suit_them(start):
    # A strip cut into 2, 3 and 7 squares; the labels ask for other sizes in the same order.
    shape = Shape.from_mesh(*shapes.strip(12))
    positions = np.array([[1.0, 0.5, 0], [3.0, 0.5, 0], [7.0, 0.5, 0]])[list(start)]
    problem = Problem(
        ["small", "large", "middle"],
        "off(small, size=1) + 2*off(large, size=9) + off(middle, size=4)",
        objectives={"off": off},
    )
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 3))
    vector = evaluator.parameterization.encode(Centers(positions=positions, weights=np.ones(3)))
    labeler = Hungarian()
    assert isinstance(labeler, Labeler)
    order = labeler(evaluator, vector)
    labels = evaluator.labels(evaluator.parameterization.permute(vector, order))
    sizes = np.bincount(labels, minlength=3)
    assert sizes[0] < sizes[2] < sizes[1]
    best = min(
        evaluator.evaluate(evaluator.parameterization.permute(vector, np.array(other))).cost
        for other in itertools.permutations(range(3))
    )
    assert evaluator.evaluate(evaluator.parameterization.permute(vector, order)).cost == best


@pytest.mark.parametrize("text", ["off(b, size=5)", "off(a, size=3) - off(c, size=1)"])
def test_empty_parts_take_the_labels_that_cost_least_without_a_part(text):
    shape = Shape.from_mesh(*shapes.strip(6))
    problem = Problem(["a", "b", "c"], text, objectives={"off": off})
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 3))
    positions = np.array([[0.5, 0.5, 0], [0.5, 0.5, 0], [3.0, 0.5, 0]])  # the second is empty
    vector = evaluator.parameterization.encode(Centers(positions=positions, weights=np.ones(3)))

    def cost(order):
        return evaluator.evaluate(evaluator.parameterization.permute(vector, order)).cost

    order = Hungarian()(evaluator, vector)
    assert sorted(order.tolist()) == [0, 1, 2]
    costs = [cost(np.array(other)) for other in itertools.permutations(range(3))]
    assert {c.empty for c in costs} == {1}
    assert cost(order) == min(costs)
