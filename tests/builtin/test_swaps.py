"""Swaps are the best there are, for the two labels, among all ways to divide their elements."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.swaps import Energy


@st.composite
def problems(draw, n_labels):
    """A few elements with costs and links, and a labelling that is allowed."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    k, n = draw(st.integers(1, 7)), draw(n_labels)
    pairs = [pair for pair in itertools.combinations(range(k), 2) if rng.random() < 0.6]
    first, second = np.array(pairs, np.int64).reshape(-1, 2).T
    costs = rng.random((k, n)) * draw(st.sampled_from([0.0, 0.5, 3.0]))
    costs[rng.random((k, n)) < 0.2] = np.inf
    labels = rng.integers(0, n, k)
    costs[np.arange(k), labels] = rng.random(k)
    weights = rng.random(len(pairs)) * draw(st.sampled_from([1e-6, 1.0, 1e6]))
    return Energy(costs=costs, first=first, second=second, weights=weights), labels


def literal(energy, labels):
    """What a labelling costs, one element and one link after another."""
    cost = sum(energy.costs[element, label] for element, label in enumerate(labels))
    for i, j, weight in zip(energy.first, energy.second, energy.weights, strict=True):
        cost += weight if labels[i] != labels[j] else 0.0
    return cost


def rounding(energy):
    """By how much a labelling may be dearer than the best, from whole numbers as capacities."""
    finite = energy.costs[np.isfinite(energy.costs)].sum()
    return 1e-7 * (finite + energy.weights.sum())


@settings(deadline=None)
@given(problems(st.integers(1, 3)))
def test_the_cost_is_a_sum_over_elements_and_cut_links(problem):
    energy, labels = problem
    assert energy.of(labels) == pytest.approx(literal(energy, labels))


@settings(deadline=None, max_examples=200)
@given(problems(st.just(2)))
def test_of_two_labels_the_swap_is_the_best_labelling(problem):
    energy, labels = problem
    swapped = energy.swapped(labels, 0, 1)
    best = min(literal(energy, tried) for tried in itertools.product((0, 1), repeat=len(labels)))
    assert literal(energy, swapped) <= best + rounding(energy)


@settings(deadline=None, max_examples=200)
@given(problems(st.just(3)))
def test_of_three_labels_two_are_divided_in_the_best_way(problem):
    energy, labels = problem
    swapped = energy.swapped(labels, 0, 2)
    ways = [(0, 2) if label != 1 else (1,) for label in labels]
    best = min(literal(energy, tried) for tried in itertools.product(*ways))
    assert literal(energy, swapped) <= best + rounding(energy)
    assert ((swapped == 1) == (labels == 1)).all()


@settings(deadline=None)
@given(problems(st.just(3)), st.integers(0, 2**32))
def test_changes_are_told_apart_where_they_have_nothing_to_do_with_each_other(problem, seed):
    energy, labels = problem
    allowed = np.isfinite(energy.costs)
    other = np.array([np.random.default_rng(seed).choice(np.flatnonzero(a)) for a in allowed])
    groups = energy.improvements(labels, other)
    gained = 0.0
    for group in groups:
        one = labels.copy()
        one[group] = other[group]
        gain = energy.of(labels) - energy.of(one)
        assert gain > 0
        gained += gain
    every = labels.copy()
    for group in groups:
        assert (every[group] == labels[group]).all()  # no element is in two
        every[group] = other[group]
    assert energy.of(labels) - energy.of(every) == pytest.approx(gained)
    # What was left out gains nothing.
    rest = np.where(every == other, labels, other)
    assert not energy.improvements(labels, rest)


def test_what_touches():
    energy = Energy(
        costs=np.zeros((4, 4)),
        first=np.array([0, 1, 2]),
        second=np.array([1, 2, 3]),
        weights=np.ones(3),
    )
    assert energy.touching(np.array([3, 0, 0, 2])) == [(0, 2), (0, 3)]
    assert energy.touching(np.array([1, 1, 1, 1])) == []


def test_nothing_to_divide_is_left_as_it_is():
    energy = Energy(
        costs=np.array([[0.0, np.inf]]),
        first=np.empty(0, np.int64),
        second=np.empty(0, np.int64),
        weights=np.empty(0),
    )
    assert energy.swapped(np.array([0]), 0, 1).tolist() == [0]
    free = Energy(
        costs=np.zeros((1, 2)), first=energy.first, second=energy.first, weights=energy.weights
    )
    assert free.swapped(np.array([1]), 0, 1).tolist() in ([0], [1])


@settings(deadline=None)
@given(problems(st.just(3)), st.data())
def test_where_only_some_may_change_the_others_cost_the_same_whatever_becomes_of_them(
    problem, data
):
    energy, labels = problem
    size = len(labels)
    free = np.array(data.draw(st.lists(st.booleans(), min_size=size, max_size=size)))
    elements, narrowed = energy.narrowed(labels, free)
    assert set(np.flatnonzero(free)) <= set(elements.tolist())
    held = [e for e in range(size) if not free[e]]
    for place, element in enumerate(elements.tolist()):
        allowed = np.flatnonzero(np.isfinite(narrowed.costs[place])).tolist()
        assert allowed == (
            [labels[element]]
            if element in held
            else np.flatnonzero(np.isfinite(energy.costs[element])).tolist()
        )
    left_out = literal(energy, labels) - literal(narrowed, labels[elements])
    for seed in range(3):
        rng = np.random.default_rng(seed)
        other = labels.copy()
        for element in np.flatnonzero(free).tolist():
            other[element] = rng.choice(np.flatnonzero(np.isfinite(energy.costs[element])))
        found = literal(narrowed, other[elements]) + left_out
        assert found == pytest.approx(literal(energy, other), rel=1e-9)
