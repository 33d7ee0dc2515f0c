"""Candidates: whatever is left out, the winner and its cost are those of exact evaluation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.cost import Cost
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import FunctionObjective, objective
from moseg_core.components.protocols import Batch
from moseg_core.errors import PluginError
from moseg_core.problem.problem import Problem
from moseg_core.search.candidates import PlannedTerms
from moseg_core.shape.pins import Pins
from tests.made_up import (
    GROWING,
    INF,
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


# --- the plan ------------------------------------------------------------------------------------


def test_terms_are_planned_by_form_and_cost_class():
    slow, _ = counted(0, 1, lambda part: 0.5)
    fair, _ = counted(-2, 9, lambda part: 0.5, cost="moderate")
    at_once = objective(range=(0, 1), vectorized=lambda parts: 0.0 * parts.areas)(area._function)
    bound = objective(range=(0, 9), at_least=lambda parts: parts.areas)(area._function)
    objectives = {"slow": slow, "fair": fair, "at_once": at_once, "bound": bound}
    problem = Problem(
        ["a", "b"], "slow(a) - 2*fair(b) + at_once(a) + bound(b)", objectives=objectives
    )
    planned = PlannedTerms.of(problem)
    assert planned.least == [[0], [9], [0], [0]]
    assert planned.least_sum == -18
    assert [t for t, _ in planned.vectorized] == [2]
    assert [t for t, _ in planned.bounded] == [3]
    ranks = [[t for t, _ in terms] for terms in planned.by_rank.values()]
    assert ranks == [[3], [1], [0]]  # cheap, moderate, expensive
    assert list(planned.by_rank) == sorted(planned.by_rank)
