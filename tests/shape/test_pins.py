"""Pinned elements: counted before everything else."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Batch, Centers
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.segment import segment
from moseg_core.shape.pins import NO_PINS, read_pins
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
PROBLEM = Problem(["stem", "bar"], "narrow(stem) + compact(bar)")


def test_they_are_read_by_label():
    pins = read_pins({"bar": [5, 3, 5], "stem": np.array([9])}, ["stem", "bar"], 10)
    assert pins.elements.tolist() == [3, 5, 9]
    assert pins.labels.tolist() == [1, 1, 0]
    assert pins.broken(np.zeros(10, np.int32)) == 2
    assert len(NO_PINS) == NO_PINS.broken(np.zeros(10, np.int32)) == 0


def test_pins_outside_a_part_are_counted_for_the_assignment():
    pins = read_pins({"a": [0, 1], "b": [2]}, ["a", "b"], 4)
    parts = np.array([0, 1, 1, 0], np.int32)
    # Part 0 as label a leaves out element 1, as b element 2; part 1 as a leaves out element 0.
    assert pins.broken_by_part(parts, 2).tolist() == [[1, 1], [1, 0]]


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"head": [1]}, "unknown label 'head'"),
        ({"bar": [10]}, "no element 10; elements are 0 to 9"),
        ({"bar": [-1]}, "no element -1"),
        ({"bar": [1], "stem": [1]}, "element 1 is pinned to two labels"),
        ({"bar": [1.5]}, "must be integers"),
    ],
)
def test_mistakes_are_named(given, says):
    with pytest.raises(UsageError, match=says):
        read_pins(given, ["stem", "bar"], 10)


def test_a_candidate_that_breaks_fewer_pins_wins_whatever_it_costs():
    voronoi = Voronoi(SHAPE, 2)
    rng = np.random.default_rng(1)
    vectors = np.stack(
        [
            voronoi.encode(
                Centers(
                    positions=SHAPE.points[rng.choice(SHAPE.n_elements, 2, replace=False)],
                    weights=np.ones(2),
                )
            )
            for _ in range(60)
        ]
    )
    pins = read_pins({"bar": [0, 7, 30], "stem": [20]}, PROBLEM.labels, SHAPE.n_elements)
    exact = ProblemEvaluator(SHAPE, PROBLEM, voronoi, pins=pins)
    costs = exact.costs(Batch(vectors=vectors))
    labels = voronoi.labels(vectors)
    plain = ProblemEvaluator(SHAPE, PROBLEM, voronoi).costs(Batch(vectors=vectors))
    for cost, other, row in zip(costs, plain, labels, strict=True):
        assert cost.empty == other.empty + pins.broken(row)
        assert cost.value == other.value
    best = ProblemEvaluator(SHAPE, PROBLEM, voronoi, pins=pins).costs(
        Batch(vectors=vectors, best_only=True)
    )
    assert min(best) == min(costs)
    assert best.index(min(best)) == costs.index(min(costs))


def test_the_assignment_of_labels_keeps_pins():
    # By its proportions alone the long part would be the stem; the pin says that it is the bar.
    shape = Shape.from_mesh(*shapes.strip(12))
    problem = Problem(["stem", "bar"], "narrow(stem)")
    voronoi = Voronoi(shape, 2)
    vector = voronoi.encode(
        Centers(positions=np.array([[1.0, 0.5, 0], [5, 0.5, 0]]), weights=np.ones(2))
    )
    assert ProblemEvaluator(shape, problem, voronoi).unary_costs(vector).assign().tolist() == [1, 0]
    pins = read_pins({"bar": [11]}, problem.labels, shape.n_elements)
    pinned = ProblemEvaluator(shape, problem, voronoi, pins=pins)
    assert pinned.unary_costs(vector).assign().tolist() == [0, 1]
    order, cost = pinned.labelled_costs(vector[None])[0]
    assert order.tolist() == [0, 1]
    assert cost.empty == 0


@pytest.mark.parametrize("seeder", ["kmeans", "evolution(population=10, iterations=4)"])
def test_a_run_keeps_its_pins(seeder):
    free = segment(SHAPE, PROBLEM, seeder=seeder)
    # Pin what came out the other way round.
    wanted = {"bar": np.flatnonzero(free.labels == 0)[:2]}
    pinned = segment(SHAPE, PROBLEM, seeder=seeder, pins=wanted)
    assert (pinned.labels[wanted["bar"]] == 1).all()
    assert pinned.evaluation.broken_pins == 0
    assert pinned.cost >= free.cost - 1e-12 or seeder != "kmeans"


def test_pins_that_cannot_be_kept_are_warned_of():
    # Three in a row, the middle one of another part: no two connected parts do that.
    shape = Shape.from_mesh(*shapes.strip(6))
    problem = Problem(["stem", "bar"], "narrow(stem)")
    result = segment(shape, problem, pins={"stem": [0, 5], "bar": [3]})
    assert result.evaluation.broken_pins == 1
    assert any("pinned elements bear another label" in text for text in result.warnings)
    assert result.evaluation.cost.empty == 1
