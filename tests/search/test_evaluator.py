"""The evaluator: whatever it leaves out, the winner and its cost are those of exact evaluation."""

from __future__ import annotations

import math
import sys
import types
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import FieldSpec, MeasureSpec, ObjectiveSpec
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import FunctionObjective, objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Batch, Centers
from moseg_core.errors import PluginError, ShapeError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.pins import Pins
from tests.made_up import (
    GROWING,
    INF,
    STRIP,
    area,
    counted,
    evaluator_of,
    exact_costs,
    numbers,
    problems,
)


def some_pins(seed, n):
    """Up to three pinned elements."""
    rng = np.random.default_rng(seed)
    elements = rng.choice(8, rng.integers(0, 4), replace=False)
    return Pins(elements=elements, labels=rng.integers(0, n, len(elements)))


def with_pins(costs, labellings, pins):
    pairs = list(zip(pins.elements.tolist(), pins.labels.tolist(), strict=True))
    return [
        Cost(cost.empty + sum(labels[f] != label for f, label in pairs), cost.value)
        for cost, labels in zip(costs, labellings, strict=True)
    ]


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


@given(problems(), st.integers(0, 9), st.sampled_from([0.0, 1e-9, -1e-9, 0.5]), st.booleans())
@settings(max_examples=150, deadline=None)
def test_a_cutoff_leaves_what_is_below_it_exact(case, which, more, remember):
    problem, labellings = case
    expected = exact_costs(problem, labellings)
    at = expected[which % len(expected)]
    cutoff = Cost(at.empty, at.value + more)
    evaluator = evaluator_of(problem, labellings, memo=None if remember else Memo(size=0))
    found = evaluator.costs(Batch(vectors=numbers(len(labellings)), cutoff=cutoff))
    for cost, true in zip(found, expected, strict=True):
        assert cost <= true
        assert cost == true if true < cutoff else cost >= cutoff


@given(problems(), st.booleans(), st.integers(0, 99))
@settings(max_examples=300, deadline=None)
def test_the_best_of_a_batch_is_that_of_exact_evaluation(case, remember, seed):
    problem, labellings = case
    pins = some_pins(seed, len(problem.labels))
    expected = with_pins(exact_costs(problem, labellings), labellings, pins)
    memo = None if remember else Memo(size=0)
    evaluator = evaluator_of(problem, labellings, pins=pins, memo=memo)
    found = evaluator.costs(Batch(vectors=numbers(len(labellings)), best_only=True))
    winner = min(range(len(expected)), key=lambda k: (expected[k], k))
    assert min(range(len(found)), key=lambda k: (found[k], k)) == winner
    assert found[winner] == expected[winner]
    for cost, true in zip(found, expected, strict=True):
        assert expected[winner] <= cost <= true


@given(problems(), st.integers(0, 9), st.sampled_from([0.0, 1e-9, -1e-9, 0.5]), st.integers(-1, 1))
@settings(max_examples=300, deadline=None)
def test_the_best_of_a_batch_below_a_cutoff_is_that_of_exact_evaluation(case, which, more, fewer):
    problem, labellings = case
    expected = exact_costs(problem, labellings)
    at = expected[which % len(expected)]
    cutoff = Cost(at.empty + fewer, at.value + more)
    batch = Batch(vectors=numbers(len(labellings)), cutoff=cutoff, best_only=True)
    found = evaluator_of(problem, labellings).costs(batch)
    winner = min(range(len(expected)), key=lambda k: (expected[k], k))
    assert all(cost <= true for cost, true in zip(found, expected, strict=True))
    if expected[winner] < cutoff:
        assert min(range(len(found)), key=lambda k: (found[k], k)) == winner
        assert found[winner] == expected[winner]
    else:
        assert min(found) >= cutoff


# --- what is left out ----------------------------------------------------------------------------


@pytest.mark.parametrize("order", [1, -1])
def test_an_expensive_term_is_skipped_where_it_cannot_matter(order):
    slow, calls = counted(0, 1, lambda part: 1.0)
    problem = Problem(["a", "b"], "slow(a) + 2*area(a)", objectives={"slow": slow, "area": area})
    evaluator = evaluator_of(problem, GROWING[::order])
    found = evaluator.costs(Batch(vectors=numbers(7), best_only=True))[::order]
    assert calls == [1]
    assert found == [Cost(0, 3.0), *(Cost(0, 2.0 * k) for k in range(2, 8))]


def test_with_a_negative_weight_the_upper_end_of_the_range_is_what_counts():
    slow, calls = counted(0, 3, lambda part: 0.0)
    problem = Problem(["a", "b"], "2*area(a) - slow(a)", objectives={"slow": slow, "area": area})
    found = evaluator_of(problem, GROWING).costs(Batch(vectors=numbers(7), best_only=True))
    # 2 for the first; the second could come to 4 - 3, the third cannot come below 3.
    assert calls == [1, 2]
    assert found == [Cost(0, 2.0), Cost(0, 4.0), *(Cost(0, 2.0 * k - 3) for k in range(3, 8))]


@pytest.mark.parametrize(
    ("cutoff", "expected"), [(None, [1, 2, 3]), (Cost(0, 7.5), [1, 2, 3, 4]), (Cost(0, 2.5), [])]
)
def test_a_lower_bound_stands_in_for_the_least_value(cutoff, expected):
    # Costs of 6, 7, 8 and so on, known to be no less than 2.5, 4, 5.5 and so on.
    plain, calls = counted(0, INF, lambda part: 5.0)
    traits = replace(plain.traits, at_least=lambda parts: 0.5 * parts.areas + 1.0)
    slow = FunctionObjective(plain._function, traits)
    problem = Problem(["a", "b"], "slow(a) + area(a)", objectives={"slow": slow, "area": area})
    batch = Batch(vectors=numbers(7), cutoff=cutoff, best_only=cutoff is None)
    found = evaluator_of(problem, GROWING).costs(batch)
    assert calls == expected
    exact = [Cost(0, k + 5.0) for k in range(1, 8)]
    assert found[: len(calls)] == exact[: len(calls)]
    assert all(cost <= true for cost, true in zip(found, exact, strict=True))


def test_a_lower_bound_of_what_is_wanted_high_is_not_asked():
    def at_least(parts):
        raise AssertionError("nobody asks")

    fair = objective(range=(0, 9), at_least=at_least)(area._function)
    problem = Problem(["a", "b"], "-fair(a)", objectives={"fair": fair})
    evaluator_of(problem, GROWING).costs(Batch(vectors=numbers(7), best_only=True))


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (lambda parts: parts.areas[0], "must return an array of 7 real numbers"),
        (lambda parts: np.full(len(parts), np.nan), "values must be finite"),
        (lambda parts: parts.areas + 99.0, "it declares values from 0 to 9"),
        (lambda parts: 1 / 0, "the lower bound of objective 'python:fair' .* ZeroDivisionError"),
    ],
)
def test_a_lower_bound_that_is_none_is_named(answer, says):
    fair = objective(range=(0, 9), at_least=answer)(area._function)
    problem = Problem(["a", "b"], "fair(a)", objectives={"fair": fair})
    with pytest.raises(PluginError, match=says):
        evaluator_of(problem, GROWING).costs(Batch(vectors=numbers(7), best_only=True))


@pytest.mark.parametrize(
    ("low", "high", "text"), [(-INF, 1, "area(a) + slow(a)"), (0, INF, "area(a) - slow(a)")]
)
def test_nothing_is_skipped_where_the_range_is_unlimited(low, high, text):
    slow, calls = counted(low, high, lambda part: 0.5)
    problem = Problem(["a", "b"], text, objectives={"slow": slow, "area": area})
    evaluator_of(problem, GROWING).costs(Batch(vectors=numbers(7), best_only=True))
    assert sorted(calls) == [1, 2, 3, 4, 5, 6, 7]


def test_a_cutoff_skips_what_cannot_be_below_it():
    slow, calls = counted(0, 1, lambda part: 0.25)
    problem = Problem(["a", "b"], "area(a) + slow(a)", objectives={"slow": slow, "area": area})
    batch = Batch(vectors=numbers(7), cutoff=Cost(0, 3.0))
    found = evaluator_of(problem, GROWING).costs(batch)
    assert calls == [1, 2]
    assert found == [Cost(0, value) for value in (1.25, 2.25, 3, 4, 5, 6, 7)]


def test_moderate_terms_come_before_expensive_ones():
    slow, slow_calls = counted(0, 1, lambda part: 0.0)
    fair, fair_calls = counted(0, 9, lambda part: part.area, cost="moderate")
    cheap, cheap_calls = counted(0, 1, lambda part: 1.0, cost="cheap")
    problem = Problem(
        ["a", "b"],
        "slow(a) + fair(a) + cheap(a)",
        objectives={"slow": slow, "fair": fair, "cheap": cheap},
    )
    evaluator_of(problem, GROWING).costs(Batch(vectors=numbers(7), best_only=True))
    assert cheap_calls == [1, 2, 3, 4, 5, 6, 7]
    # All cheap terms are equal, so the candidates are taken in order; the first is the best.
    assert fair_calls == [1, 2, 3, 4, 5, 6, 7]
    assert slow_calls == [1]


def test_an_earlier_candidate_that_could_tie_with_the_best_is_evaluated():
    # The second, cheaper at first, comes to 1.5; the first starts there, and ends above it.
    slow, calls = counted(0, 1, lambda part: 0.5)
    fair, _ = counted(0, 9, lambda part: {2: 1.5, 1: 1.0}[part.n_elements], cost="cheap")
    problem = Problem(["a", "b"], "fair(a) + slow(a)", objectives={"slow": slow, "fair": fair})
    listed = [GROWING[1], GROWING[0]]
    found = evaluator_of(problem, listed).costs(Batch(vectors=numbers(2), best_only=True))
    assert found == [Cost(0, 2.0), Cost(0, 1.5)]
    assert calls == [1, 2]
    # In the other order it cannot win any more, for of equal candidates the first is taken.
    calls.clear()
    found = evaluator_of(problem, listed[::-1]).costs(Batch(vectors=numbers(2), best_only=True))
    assert found == [Cost(0, 1.5), Cost(0, 1.5)]
    assert calls == [1]


def test_candidates_with_more_empty_parts_are_not_evaluated():
    slow, calls = counted(0, 1, lambda part: 0.5, cost="cheap")
    problem = Problem(["a", "b", "c"], "slow(a, b, c)", objectives={"slow": slow})
    labellings = [[0] * 8, [0, 1] * 4, [0] * 4 + [1] * 3 + [2], [2] * 8]
    batch = Batch(vectors=numbers(4), best_only=True)
    found = evaluator_of(problem, labellings, memo=Memo(size=0)).costs(batch)
    assert [cost.empty for cost in found] == [2, 1, 0, 2]
    assert found[2] == Cost(0, 1.5)
    assert calls == [4, 3, 1]


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
