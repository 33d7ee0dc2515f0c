"""1 - Rand Index against a look at all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.agreement import rand_index_error
from tests import references
from tests.agreement.labellings import pairs_of_labellings, renumbered, shuffled


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
    assert 0.0 <= error <= 1.0 + 1e-12
    assert rand_index_error(first, first, weights) == 0.0
    assert rand_index_error(first, renumbered(first, seed), weights) == 0.0
    for other in (
        rand_index_error(second, first, weights),
        rand_index_error(renumbered(first, seed), renumbered(second, seed + 1), weights),
        rand_index_error(*shuffled((first, second, weights), seed)),
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
