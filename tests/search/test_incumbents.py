"""How a search came to its result: what is noted, thinned, rounded and put together."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Centers
from moseg_core.problem.problem import Problem
from moseg_core.problem.statement import Statement
from moseg_core.search.incumbents import (
    Improvement,
    Incumbent,
    ended_with,
    followed,
    kept_incumbents,
    note,
    thinned,
)
from moseg_core.search.segment import segment
from moseg_core.search.variants import segment_variants
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.results import area

TEE = Shape.from_mesh(*shapes.jitter(shapes.subdivided(shapes.tee(), 2), 5), name="tee")
PROBLEM = Problem(["stem", "bar"], "3*narrow(stem) + perpendicular(stem, bar) + convex_parts")


def step(evaluations, *, stage="search", value=1.0, at=0.0, weight=1.0, n=2):
    centers = Centers(positions=np.full((n, 3), at), weights=np.full(n, weight))
    return Incumbent(stage=stage, evaluations=evaluations, cost=Cost(0, value), centers=centers)


@pytest.fixture(scope="module")
def found():
    return segment(TEE, PROBLEM, resolution=60, restarts=3)


# --- a whole search ------------------------------------------------------------------------------


def test_it_begins_with_the_start_and_ends_with_the_result(found):
    first, *_, last = found.incumbents
    assert (first.stage, first.evaluations) == ("start", 1)
    assert last.stage == "end"
    assert last.cost.value == pytest.approx(found.cost, rel=1e-5)
    np.testing.assert_allclose(
        last.centers.positions, found.centers.positions, atol=5e-4 * TEE.frame.scale
    )
    np.testing.assert_allclose(last.centers.weights, found.centers.weights, rtol=1e-3)


def test_within_a_stage_costs_fall_and_evaluations_rise(found):
    assert {"start", "search", "polish", "end"} <= {step.stage for step in found.incumbents}
    for stage in ("search", "polish"):
        those = [step for step in found.incumbents if step.stage == stage]
        for before, after in itertools.pairwise(those):
            assert after.cost <= before.cost
            assert after.evaluations >= before.evaluations
    counts = [step.evaluations for step in found.incumbents]
    assert counts == sorted(counts)


def test_they_are_the_same_from_several_processes(found):
    shared = segment(TEE, PROBLEM, resolution=60, restarts=3, workers=2)
    assert list(map(everything, shared.incumbents)) == list(map(everything, found.incumbents))


def everything(one):
    centers = one.centers
    return (
        one.stage,
        one.evaluations,
        one.cost,
        centers.positions.tolist(),
        centers.weights.tolist(),
    )


def test_a_given_start_is_the_first(found):
    again = segment(TEE, PROBLEM, start=found, resolution="full", restarts=1)
    first = again.incumbents[0]
    assert first.stage == "start"
    np.testing.assert_allclose(
        first.centers.positions, found.centers.positions, atol=5e-4 * TEE.frame.scale
    )


def test_an_exchange_of_labels_is_one_of_them():
    """What is to be small has the larger part, and there is no time but to change the names."""
    start = Centers(positions=TEE.points[[0, -1]], weights=np.array([9.0, 1.0]))
    asked = Problem(["small", "large"], "area(small)", objectives={"area": area})
    found = segment(TEE, asked, start=start, optimizer="pattern_search(max_evaluations=1)")
    assert [step.stage for step in found.incumbents] == ["start", "exchange", "end"]
    first, exchanged, _ = found.incumbents
    assert exchanged.cost < first.cost
    assert exchanged.centers.positions.tolist() == first.centers.positions[::-1].tolist()


def test_of_label_sets_the_one_that_is_chosen_has_its_own():
    statement = Statement(labels=("stem", "bar{0..1}"), minimize="3*narrow(*)")
    found = segment_variants(TEE, statement, restarts=1, resolution=60)
    n = len(found.problem.labels)
    assert found.incumbents
    assert all(len(step.centers.weights) == n for step in found.incumbents)


def test_no_number_is_searched_for_and_there_is_nothing_to_tell():
    start = Centers(positions=TEE.points[[0, -1]], weights=np.ones(2))
    found = segment(TEE, PROBLEM, start=start, freeze=["stem", "bar"])
    assert found.incumbents == ()


# --- thinning and rounding -----------------------------------------------------------------------


@given(
    st.lists(st.integers(1, 10**6), min_size=1, max_size=150).map(sorted),
    st.integers(2, 60),
)
def test_thinning_keeps_the_ends_and_the_order(counts, most):
    steps = [step(count) for count in counts]
    kept = thinned(steps, most)
    assert len(kept) == min(len(steps), most)
    assert kept[0] is steps[0]
    assert kept[-1] is steps[-1]
    places = [steps.index(one) for one in kept]
    assert places == sorted(set(places))


def test_thinning_is_even_in_the_logarithm():
    kept = thinned([step(count) for count in range(1, 1001)], 10)
    gaps = np.diff(np.log([one.evaluations for one in kept]))
    assert gaps.max() < 2.5 * gaps.min()


def test_what_was_changed_after_the_search_has_another_end():
    kept = kept_incumbents([step(1, value=3.0), step(9, value=2.0)], step(9, stage="end"), size=1.0)
    at = Centers(positions=np.full((2, 3), 0.123456), weights=np.ones(2))
    ended = ended_with(kept, cost=Cost(0, 1.23456789), centers=at, size=1.0)
    assert ended[:-1] == kept[:-1]
    assert (ended[-1].stage, ended[-1].evaluations, ended[-1].cost.value) == ("end", 9, 1.23457)
    assert ended[-1].centers.positions.tolist() == [[0.1235] * 3] * 2
    assert ended_with((), cost=Cost(0, 1.0), centers=at, size=1.0) == ()


def test_a_run_keeps_a_bounded_number():
    noted: list[Improvement] = []
    for k in range(2000):
        note(noted, Improvement("search", k + 1, Cost(0, 1.0 / (k + 1)), np.zeros(3)))
        assert len(noted) < 128
    assert (noted[0].evaluations, noted[-1].evaluations) == (1, 2000)


def test_a_search_that_begins_where_another_ended_is_counted_on():
    both = followed([step(1), step(7, at=2.0)], [step(3, at=2.0), step(4, at=3.0)], done=10)
    assert [one.evaluations for one in both] == [1, 7, 14]  # the same candidate once
    other = followed([step(7, at=2.0)], [step(1, at=2.0, value=0.9)], done=10)
    assert [one.evaluations for one in other] == [7, 11]  # on other elements it costs another


def test_many_centres_leave_fewer_of_them():
    several = [step(k + 1, at=k) for k in range(200)]
    assert len(kept_incumbents(several, step(999), size=1.0)) == 40
    broad = [step(k + 1, at=k, n=30) for k in range(200)]
    assert len(kept_incumbents(broad, step(999, n=30), size=1.0)) == 16
    assert kept_incumbents([], step(1), size=1.0) == ()


@pytest.mark.parametrize("size", [1e-9, 1.0, 250.0, 1e12])
@pytest.mark.parametrize("shift", [0.0, 1e3])
def test_numbers_are_short_and_near_and_rounding_again_changes_nothing(size, shift):
    rng = np.random.default_rng(3)
    places = size * (rng.uniform(-1, 1, (50, 3)) + shift)
    centers = Centers(positions=places, weights=rng.uniform(0.1, 9, 50))
    exact = Incumbent(stage="search", evaluations=1, cost=Cost(0, 1 / 3), centers=centers)
    once = kept_incumbents([exact], exact, size=size)
    np.testing.assert_allclose(once[0].centers.positions, places, atol=5.01e-4 * size)
    assert max(len(repr(w)) for w in once[0].centers.weights.tolist()) <= 6
    assert once[0].cost.value == 0.333333
    again = kept_incumbents(once[:1], once[1], size=size)
    assert list(map(everything, again)) == list(map(everything, once))
