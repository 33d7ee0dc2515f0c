"""Exchanges of labels: none that is left lowers the cost, centres go along, some may not move."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import FunctionObjective, Traits, objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.exchange import best_order, exchanged_vector
from moseg_core.shape.pins import read_pins
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import (
    LETTERS,
    RANGES,
    STRIP,
    area,
    centers_at,
    cost_of,
    evaluator_of,
    lower_by_exchange,
    made,
    numbers,
    on_strip,
)
from tests.reflections import known

BALL = Shape.from_mesh(*shapes.jitter(shapes.sphere(2), 1), name="ball")


def reordered(labels, order):
    """Label j goes to the part of label order[j]."""
    return np.argsort(order)[labels]


@st.composite
def labelled(draw):
    """A problem of 2 to 6 labels with terms of all kinds, and a labelling of the strip."""
    names = LETTERS[: draw(st.integers(2, 6))]
    objectives, terms = {}, []
    for k in range(draw(st.integers(1, 5))):
        arity = draw(st.sampled_from(["unary", "nary", "global"]))
        objectives[f"f{k}"] = made(
            arity,
            draw(st.sampled_from(RANGES)),
            draw(st.sampled_from(["cheap", "moderate", "expensive"])),
            levels=draw(st.sampled_from([2, 3, 1000])),
        )
        few = draw(st.integers(2 if arity == "nary" else 1, len(names)))
        chosen = [] if arity == "global" else draw(st.permutations(names))[:few]
        terms.append(f"{draw(st.sampled_from(['- 3', '+ 1', '+ 0.1']))}*f{k}({', '.join(chosen)})")
    labels = draw(st.lists(st.integers(0, len(names) - 1), min_size=8, max_size=8))
    return Problem(names, "".join(terms), objectives=objectives), np.array(labels, np.int32)


@given(labelled())
@settings(max_examples=150, deadline=None)
def test_no_exchange_that_is_left_lowers_the_cost(case):
    problem, labels = case
    evaluator = evaluator_of(problem, [labels])
    order = best_order(evaluator, numbers(1)[0], labels)
    assert sorted(order.tolist()) == list(range(len(problem.labels)))
    found = reordered(labels, order)
    assert lower_by_exchange(problem, STRIP, found) == []
    assert cost_of(problem, STRIP, found) <= cost_of(problem, STRIP, labels)
    if not lower_by_exchange(problem, STRIP, labels) and len(problem.labels) == 2:
        assert order.tolist() == [0, 1]


def preferring(wanted):
    """An objective for each label: how many squares its part is from having `wanted` of them."""

    def of(count):
        def off(part):
            return float(abs(part.n_elements - count))

        return FunctionObjective(off, Traits(arity="unary", range=(0, math.inf), cost="cheap"))

    return {f"like{k}": of(count) for k, count in enumerate(wanted)}


def test_labels_that_go_round_in_a_circle_are_put_right():
    # Parts of 1, 2 and 3 squares; no single exchange of two gives all three what they want.
    problem = Problem(
        ["a", "b", "c"], "like0(a) + like1(b) + like2(c)", objectives=preferring([1, 2, 5])
    )
    labels = np.array([1, 2, 2, 0, 0, 0, 0, 0], np.int32)
    evaluator = evaluator_of(problem, [labels])
    order = best_order(evaluator, numbers(1)[0], labels)
    assert reordered(labels, order).tolist() == [0, 1, 1, 2, 2, 2, 2, 2]


def test_the_vector_has_the_centres_and_weights_of_its_labels():
    evaluator = on_strip("area(a)")
    centers = centers_at(1, 6, weights=[3.0, 1.0])  # the large part bears the label to be small
    vector = evaluator.parameterization.encode(centers)
    cost = evaluator.evaluate(vector).cost
    found, lower = exchanged_vector(evaluator, vector, cost)
    assert lower < cost
    assert lower == evaluator.evaluate(found).cost
    moved = evaluator.parameterization.decode(found)
    assert moved.positions == pytest.approx(centers.positions[[1, 0]])
    assert moved.weights.tolist() == [1.0, 3.0]
    assert (evaluator.labels(found) == 1 - evaluator.labels(vector)).all()
    # What is best already is given back as it is.
    again, same = exchanged_vector(evaluator, found, lower)
    assert again is found
    assert same is lower


def test_frozen_labels_keep_their_parts():
    problem = Problem(["a", "b", "c"], "like0(a)", objectives=preferring([1]))
    labels = np.array([0, 0, 0, 0, 0, 1, 1, 2], np.int32)
    evaluator = evaluator_of(problem, [labels])
    vector = numbers(1)[0]
    assert best_order(evaluator, vector, labels).tolist() == [2, 1, 0]
    assert best_order(evaluator, vector, labels, frozen=[1]).tolist() == [2, 1, 0]
    assert best_order(evaluator, vector, labels, frozen=[2]).tolist() == [1, 0, 2]
    assert best_order(evaluator, vector, labels, frozen=[0]).tolist() == [0, 1, 2]


def test_a_pinned_element_is_worth_more_than_any_value():
    labels = np.array([0, 0, 0, 0, 0, 0, 1, 1], np.int32)
    problem = Problem(["a", "b"], "area(a)", objectives={"area": area})
    vector = numbers(1)[0]
    kept = evaluator_of(problem, [labels], pins=read_pins({"a": [2]}, problem.labels, 8))
    assert best_order(kept, vector, labels).tolist() == [0, 1]
    broken = evaluator_of(problem, [1 - labels], pins=read_pins({"a": [2]}, problem.labels, 8))
    assert best_order(broken, vector, 1 - labels).tolist() == [1, 0]


def test_alike_labels_are_left_alone():
    # Sums of three numbers round differently in another order, and that is no gain.
    thirds = FunctionObjective(
        lambda part: part.n_elements * 0.1, Traits(arity="unary", range=(0, 9), cost="cheap")
    )
    problem = Problem(["a", "b", "c"], "thirds(a, b, c)", objectives={"thirds": thirds})
    vector = numbers(1)[0]
    for counts in itertools.permutations([1, 2, 5]):
        labels = np.repeat([0, 1, 2], counts).astype(np.int32)
        evaluator = evaluator_of(problem, [labels])
        assert best_order(evaluator, vector, labels).tolist() == [0, 1, 2]


def test_parts_of_different_numbers_of_centres_change_places_only_by_their_labels():
    problem = Problem(["a", "b"], "area(a)", objectives={"area": area})
    partition = Voronoi(STRIP, 2, centers="a=2", labels=["a", "b"])
    evaluator = ProblemEvaluator(STRIP, problem, partition)
    vector = evaluator.parameterization.encode(
        Centers(positions=STRIP.points[[1, 4, 7]], weights=np.ones(3), parts=np.array([0, 0, 1]))
    )
    labels = evaluator.labels(vector)
    assert best_order(evaluator, vector, labels).tolist() == [1, 0]
    assert best_order(evaluator, vector, labels, whole=True).tolist() == [0, 1]
    cost = evaluator.evaluate(vector).cost
    assert exchanged_vector(evaluator, vector, cost) == (vector, cost)


@objective(range=(-9, 9))
def rightness(part: Part) -> float:
    return float(part.centroid[0])


def test_under_constraints_what_comes_out_obeys_them():
    # Pairs change places as pairs, and mirror images with each other.
    problem = Problem(
        ["a", "b", "c", "d"],
        "- 3*rightness(a) + rightness(b) - 0.5*rightness(c) + 2*rightness(d)",
        objectives={"rightness": rightness},
        constraints=["mirror(b, a)", "mirror(d, c)"],
        registry=known(),
    )
    evaluator = ProblemEvaluator(BALL, problem, Voronoi(BALL, 4))
    partition, constraints = evaluator.parameterization, evaluator.constraints
    exchanges = [[1, 0, 2, 3], [0, 1, 3, 2], [2, 3, 0, 1]]
    rng = np.random.default_rng(4)
    moved = 0
    for _ in range(8):
        positions = BALL.points[rng.choice(BALL.n_elements, 4, replace=False)]
        centers = Centers(positions=positions, weights=rng.uniform(0.5, 2, 4))
        vector = constraints.feasible(partition.encode(centers))
        before = evaluator.evaluate(vector).cost
        found, cost = exchanged_vector(evaluator, vector, before)
        moved += found is not vector
        assert np.abs(constraints.feasible(found) - found).max() <= 1e-12
        for order in exchanges:
            other = partition.permute(found, np.array(order))
            assert np.abs(constraints.feasible(other) - other).max() <= 1e-12
            assert evaluator.evaluate(other).cost.value >= cost.value - 1e-9
        across = partition.permute(found, np.array([2, 1, 0, 3]))
        assert np.abs(constraints.feasible(across) - across).max() > 0.01
    assert moved >= 4
