"""Labels by unary costs: the matrix, its bounds, and the assignment that costs least."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.problem import Problem
from tests.made_up import (
    GROWING,
    RANGES,
    STRIP,
    area,
    counted,
    evaluator_of,
    exact_costs,
    made,
    numbers,
    problems,
)
from tests.references import least_assignment_cost


def permutations(n):
    return [np.array(order) for order in itertools.permutations(range(n))]


@given(problems())
@settings(max_examples=100, deadline=None)
def test_the_cost_matrix_gives_every_part_every_label(case):
    problem, labellings = case
    n = len(problem.labels)
    costs = evaluator_of(problem, labellings).unary_costs(numbers(1)[0])
    segmentation = Segmentation.from_labels(STRIP, labellings[0], n)
    empty = segmentation.summary.empty(STRIP)
    expected = np.zeros((n, n))
    for i, j in itertools.product(range(n), range(n)):
        for term in problem.terms:
            if term.objective.traits.arity == "unary" and (j,) in term.calls and not empty[i]:
                expected[i, j] += term.weight * term.objective(segmentation.parts[i])
    assert (costs.lower <= expected + 1e-12).all()
    assert costs.lower[costs.known] == pytest.approx(expected[costs.known], abs=1e-12)
    assert np.isfinite(costs.lower).all()

    order = costs.assign()
    assert sorted(order.tolist()) == list(range(n))
    found = math.fsum(expected[order[j], j] for j in range(n))
    assert found == pytest.approx(least_assignment_cost(expected.tolist()), abs=1e-9)
    assert costs.all() == pytest.approx(expected, abs=1e-12)
    assert costs.known.all()


def test_the_cost_matrix_is_not_spoilt_by_other_terms():
    problem = Problem(
        ["a", "b"],
        "area(a) - 2*area(b) + 3*area(a) + pair(a, b)",
        objectives={"area": area, "pair": made("nary", (0.0, 1.0), "cheap")},
    )
    found = evaluator_of(problem, GROWING).unary_costs(numbers(3)[2])
    assert found.all().tolist() == [[12.0, -6.0], [20.0, -10.0]]


@given(
    st.lists(st.sampled_from([0.3, 1.0, 4.0, -0.3, -1.0, -4.0]), min_size=2, max_size=6),
    st.lists(st.sampled_from(RANGES), min_size=6, max_size=6),
    st.sampled_from(["cheap", "moderate", "expensive"]),
    st.integers(0, 2**32),
)
@settings(max_examples=60, deadline=None)
def test_an_assignment_on_bounds_is_as_good_as_on_all_costs(weights, ranges, cost, seed):
    names = ["a", "b", "c", "d"]
    objectives = {
        f"f{k}": made("unary", ranges[k], "cheap" if k == 0 else cost, levels=1000)
        for k in range(len(weights))
    }
    text = "".join(
        f"{'-' if w < 0 else '+'} {abs(w)}*f{k}({names[(k + seed) % 4]})"
        for k, w in enumerate(weights)
    )
    labels = np.random.default_rng(seed).permutation([0, 0, 1, 1, 2, 2, 3, 3])
    evaluator = evaluator_of(Problem(names, text, objectives=objectives), [labels])
    order = evaluator.unary_costs(np.zeros(1)).assign()
    exact = evaluator.unary_costs(np.zeros(1)).all()
    found = math.fsum(exact[order[j], j] for j in range(4))
    assert found == pytest.approx(least_assignment_cost(exact.tolist()), abs=1e-9)


def test_an_assignment_asks_expensive_objectives_only_where_it_must():
    slow, calls = counted(0, 1, lambda part: 1.0)
    problem = Problem(
        ["a", "b", "c"],
        "10*area(a) + area(c) + slow(b)",
        objectives={"slow": slow, "area": area},
    )
    evaluator = evaluator_of(problem, [[0, 1, 1, 2, 2, 2, 2, 2]])
    assert evaluator.unary_costs(np.zeros(1)).assign().tolist() == [0, 2, 1]
    assert calls == [5]


@given(problems())
@settings(max_examples=60, deadline=None)
def test_labels_and_costs_of_parts_that_have_none_yet(case):
    problem, labellings = case
    n = len(problem.labels)
    evaluator = evaluator_of(problem, labellings)
    found = evaluator.labelled_costs(numbers(len(labellings)))
    assert evaluator.evaluations == len(labellings)
    for k, (order, cost) in enumerate(found):
        assert sorted(order.tolist()) == list(range(n))
        relabelled = [int(np.argmax(order == part)) for part in labellings[k]]
        assert cost == exact_costs(problem, [relabelled])[0]
        unary = evaluator.unary_costs(numbers(k + 1)[k]).all()
        best = least_assignment_cost(unary.tolist())
        assert sum(unary[order[j], j] for j in range(n)) == pytest.approx(best, abs=1e-9)


@given(problems())
@settings(max_examples=60, deadline=None)
def test_other_labels_for_the_same_parts(case):
    problem, labellings = case
    n = len(problem.labels)
    evaluator = evaluator_of(problem, labellings)
    segmentation = evaluator.segmentation(labellings[0])
    for order in permutations(n):
        permuted = segmentation.permuted(order)
        again = Segmentation.from_labels(STRIP, permuted.labels, n)
        for j in range(n):
            assert (permuted.labels == j).tolist() == (labellings[0] == order[j]).tolist()
            assert permuted.parts[j].membership == again.parts[j].membership
            assert permuted.parts[j].moments.tobytes() == again.parts[j].moments.tobytes()
            assert permuted.parts[j].elements.tolist() == again.parts[j].elements.tolist()
        assert (permuted.summary.counts == again.summary.counts).all()
        expected = exact_costs(problem, [permuted.labels])[0]
        assert evaluator.order_cost(segmentation, order) == expected
