"""The evaluator: costs of vectors, labellings and orders, and what they need of shapes."""

from __future__ import annotations

import math
import sys
import types
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import FieldSpec, MeasureSpec, ObjectiveSpec
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Batch, Centers
from moseg_core.errors import PluginError, ShapeError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from tests.made_up import (
    GROWING,
    STRIP,
    area,
    counted,
    evaluator_of,
    exact_costs,
    numbers,
    problems,
)


@given(problems())
@settings(max_examples=100, deadline=None)
def test_without_promises_every_cost_is_exact(case):
    problem, labellings = case
    evaluator = evaluator_of(problem, labellings)
    expected = exact_costs(problem, labellings)
    for _ in range(2):  # anew, then from memory
        assert evaluator.costs(Batch(vectors=numbers(len(labellings)))) == expected
    assert evaluator.evaluations == 2 * len(labellings)
    for k, cost in enumerate(expected):
        assert evaluator.evaluate(numbers(k + 1)[k]).cost == cost


@pytest.mark.parametrize("best_only", [False, True])
def test_equal_labellings_in_a_batch_are_evaluated_once(best_only):
    slow, calls = counted(0, 1, lambda part: 0.5, cost="cheap")
    problem = Problem(["a", "b"], "slow(a)", objectives={"slow": slow})
    evaluator = evaluator_of(problem, GROWING, memo=Memo(size=0))
    vectors = np.array([[3.0], [0], [3], [3], [0]])
    found = evaluator.costs(Batch(vectors=vectors, best_only=best_only))
    assert found == [Cost(0, 0.5)] * 5
    assert sorted(calls) == [1, 4]
    assert evaluator.evaluations == 5


def test_a_batch_of_nothing():
    problem = Problem(["a", "b"], "area(a)", objectives={"area": area})
    for best_only in (False, True):
        batch = Batch(vectors=np.empty((0, 1)), best_only=best_only)
        assert evaluator_of(problem, GROWING).costs(batch) == []
    assert evaluator_of(problem, GROWING).labelled_costs(np.empty((0, 1))) == []


def test_parts_seen_before_are_remembered_between_batches():
    slow, calls = counted(0, 1, lambda part: 0.5)
    problem = Problem(["a", "b"], "slow(a, b)", objectives={"slow": slow})
    evaluator = evaluator_of(problem, GROWING)
    for _ in range(3):
        evaluator.costs(Batch(vectors=numbers(2)))
    assert sorted(calls) == [1, 2, 6, 7]


# --- shapes and registries -----------------------------------------------------------------------


def test_a_shape_that_cannot_be_used_is_refused_before_the_search():
    problem = Problem(list("abcdefghi"), "area(a)", objectives={"area": area})
    with pytest.raises(ShapeError, match="8 faces, too few for 9 labels"):
        ProblemEvaluator(STRIP, problem, Voronoi(STRIP, 9))

    @objective(range=(0, 1), requires=("volume",))
    def needs_volume(part: Part) -> float:
        return 0.0

    problem = Problem(["a"], "closed(a)", objectives={"closed": needs_volume})
    with pytest.raises(ShapeError, match=r"'closed' needs an enclosed volume.*18 boundary edges"):
        ProblemEvaluator(STRIP, problem, Voronoi(STRIP, 1))


def test_labels_and_parts_of_a_vector():
    problem = Problem(["a", "b"], "area(a) - area(b)", objectives={"area": area})
    evaluator = ProblemEvaluator(STRIP, problem, Voronoi(STRIP, 2))
    at = Centers(positions=STRIP.points[[7, 0]], weights=np.array([3.0, 1.0]))
    vector = evaluator.parameterization.encode(at)
    labels = evaluator.labels(vector)
    assert labels.tolist() == [1, 1, 0, 0, 0, 0, 0, 0]
    assert [part.n_elements for part in evaluator.segmentation(labels).parts] == [6, 2]
    found = evaluator.evaluate(vector)
    assert found.cost == Cost(0, 4.0)
    assert [term.weighted for term in found.terms] == [6.0, -2.0]


def test_measures_come_from_the_registry_of_the_problem(monkeypatch):
    @objective(range=(0, math.inf))
    def long(part: Part) -> float:
        return part.measure("length")

    module = types.ModuleType("lengths")
    module.length, module.long = lambda part: float(np.ptp(part.points[:, 0])), long
    monkeypatch.setitem(sys.modules, "lengths", module)
    specs = [
        MeasureSpec(name="length", target="lengths:length"),
        ObjectiveSpec(name="long", target="lengths:long"),
    ]
    components = tuple(Component("mine", "mine 1.0", spec) for spec in specs)
    registry = Registry([Bundle("mine", "mine", "1.0", "lengths", components)])
    problem = Problem(["a", "b"], "long(a)", registry=registry)
    # In the search, and for a labelling from elsewhere.
    assert evaluator_of(problem, GROWING).evaluate(np.array([4.0])).cost.value == 4.0
    assert problem.evaluate(STRIP, GROWING[4]).cost.value == 4.0


def registry_of_a_field(monkeypatch, function):
    module = types.ModuleType("heights")
    module.along = function
    monkeypatch.setitem(sys.modules, "heights", module)
    spec = FieldSpec(name="along", target="heights:along")
    component = Component("mine", "mine 1.0", spec)
    return Registry([Bundle("mine", "mine", "1.0", "heights", (component,))])


@objective(fields=("mine:along",))
def far(part: Part) -> float:
    return part.field("mine:along").mean


def test_declared_fields_are_computed_once_and_before_the_search(monkeypatch):
    computed = []

    def along(shape):
        computed.append(shape.n_elements)
        return shape.points[:, 0]

    registry = registry_of_a_field(monkeypatch, along)
    problem = Problem(["a", "b"], "far(a) - far(b)", objectives={"far": far}, registry=registry)
    shape = replace(STRIP, name="a strip of its own")
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 2))
    assert computed == [STRIP.n_elements]
    at = Centers(positions=shape.points[[7, 0]], weights=np.array([3.0, 1.0]))
    vector = evaluator.parameterization.encode(at)
    labels = evaluator.labels(vector)
    means = [shape.points[labels == k, 0].mean() for k in (0, 1)]
    assert evaluator.evaluate(vector).cost.value == pytest.approx(means[0] - means[1])
    assert computed == [STRIP.n_elements]


def test_a_field_that_fails_is_known_before_the_search(monkeypatch):
    def along(shape):
        raise ZeroDivisionError("no length")

    registry = registry_of_a_field(monkeypatch, along)
    problem = Problem(["a", "b"], "far(a)", objectives={"far": far}, registry=registry)
    shape = replace(STRIP, name="a strip of its own")
    with pytest.raises(PluginError, match=r"field 'mine:along' of mine 1\.0 failed.*no length"):
        ProblemEvaluator(shape, problem, Voronoi(shape, 2))
