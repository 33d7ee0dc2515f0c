"""Agreement of labellings against a look at all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.metrics import fold, named_right, rand_index_error
from tests import references


@st.composite
def pairs_of_labellings(draw):
    size = draw(st.integers(2, 25))
    labels = st.lists(st.integers(-3, 4), min_size=size, max_size=size)
    weights = st.lists(st.floats(0.0, 100.0), min_size=size, max_size=size)
    return np.array(draw(labels)), np.array(draw(labels)), np.array(draw(weights))


@given(pairs_of_labellings())
@settings(max_examples=150)
def test_the_rand_index_is_that_over_all_pairs(case):
    first, second, _ = case
    expected = references.rand_index_error(first, second, np.ones(len(first)))
    assert rand_index_error(first, second) == pytest.approx(expected, abs=1e-12)


@given(pairs_of_labellings())
@settings(max_examples=150)
def test_the_weighted_rand_index_is_that_over_all_pairs(case):
    first, second, weights = case
    weights = weights + 0.1
    expected = references.rand_index_error(first, second, weights)
    assert rand_index_error(first, second, weights) == pytest.approx(expected, abs=1e-10)


@given(pairs_of_labellings(), st.integers(1, 5), st.floats(0.001, 1000.0))
@settings(max_examples=60)
def test_the_rand_index_knows_no_names_no_order_and_no_units(case, seed, factor):
    first, second, weights = case
    weights = weights + 0.1
    error = rand_index_error(first, second, weights)
    order = np.random.default_rng(seed).permutation(len(first))
    assert 0.0 <= error <= 1.0 + 1e-12
    assert rand_index_error(first, first, weights) == pytest.approx(0.0, abs=1e-12)
    for other in (
        rand_index_error(second, first, weights),
        rand_index_error(first * 7 - 3, -second, weights),
        rand_index_error(first[order], second[order], weights[order]),
        rand_index_error(first, second, factor * weights),
    ):
        assert other == pytest.approx(error, abs=1e-10)


def test_an_element_without_weight_does_not_count():
    first, second = np.array([0, 0, 1, 1]), np.array([0, 0, 1, 0])
    assert rand_index_error(first, second, np.array([1.0, 2.0, 3.0, 0.0])) == 0.0
    assert rand_index_error(first, second) == pytest.approx(3 / 6)


def test_one_element_agrees_with_itself():
    assert rand_index_error(np.array([3]), np.array([0])) == 0.0


def test_all_in_one_against_all_apart():
    assert rand_index_error(np.zeros(9, int), np.arange(9)) == pytest.approx(1.0)


@given(st.integers(0, 2**32), st.integers(1, 20))
@settings(max_examples=60)
def test_the_share_named_right_is_that_of_the_area_under_the_right_name(seed, size):
    rng = np.random.default_rng(seed)
    names, truth_names = ["leg1", "leg2", "body", "head1"], ["body", "leg7", "head", "tail"]
    kinds, truth_kinds = ["leg", "leg", "body", "head"], ["body", "leg", "head", "tail"]
    labels, truth = rng.integers(0, 4, size), rng.integers(0, 4, size)
    areas = rng.uniform(0.1, 5.0, size)
    right = sum(
        area
        for label, true, area in zip(labels, truth, areas, strict=True)
        if kinds[label] == truth_kinds[true]
    )
    found = named_right(labels, names, truth, truth_names, areas)
    assert found == pytest.approx(right / areas.sum())


@pytest.mark.parametrize(
    ("name", "folded"),
    [("leg", "leg"), ("leg12", "leg"), ("leg1_2", "leg1_"), ("007", "007"), ("a1b", "a1b")],
)
def test_instance_numbers_are_folded(name, folded):
    assert fold(name) == folded
