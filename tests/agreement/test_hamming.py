"""The Hamming distance against sets of elements."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.agreement import Hamming, directional_hamming, hamming_distance
from tests.agreement import references
from tests.agreement.labellings import pairs_of_labellings, renumbered, shuffled


def values(*arrays):
    found = hamming_distance(*arrays)
    return found.distance, found.missing, found.false_alarm


@given(pairs_of_labellings())
@settings(max_examples=100)
def test_the_rates_are_those_of_the_definition(case):
    found, truth, weights = case
    for mass, arrays in ((np.ones(len(found)), ()), (weights, (weights,))):
        forth = references.directional_hamming(found, truth, mass)
        back = references.directional_hamming(truth, found, mass)
        assert directional_hamming(found, truth, *arrays) == pytest.approx(forth, abs=1e-9)
        expected = np.array([(forth + back) / 2, forth, back]) / mass.sum()
        assert values(found, truth, *arrays) == pytest.approx(expected, abs=1e-10)


@given(pairs_of_labellings(), st.integers(1, 5), st.floats(0.001, 1000.0))
@settings(max_examples=60)
def test_the_rates_know_no_names_no_order_and_no_units(case, seed, factor):
    found, truth, weights = case
    distance, missing, false_alarm = values(found, truth, weights)
    assert 0.0 <= min(missing, false_alarm) <= distance <= max(missing, false_alarm) < 1.0
    assert values(found, renumbered(found, seed), weights) == (0.0, 0.0, 0.0)
    swapped = values(truth, found, weights)
    assert swapped == pytest.approx((distance, false_alarm, missing), abs=1e-12)
    for other in (
        values(renumbered(found, seed), renumbered(truth, seed + 1), weights),
        values(*shuffled((found, truth, weights), seed)),
        values(found, truth, factor * weights),
    ):
        assert other == pytest.approx((distance, missing, false_alarm), abs=1e-10)


def test_one_part_misses_nothing_and_is_alarmed_at_all_but_the_greatest():
    truth = np.array([0, 0, 0, 1, 1, 2])
    assert values(np.zeros(6, int), truth) == pytest.approx((1 / 4, 0.0, 1 / 2))


def test_too_many_parts_are_missing_alone():
    truth = np.array([0, 0, 0, 1, 1, 2])
    assert values(np.arange(6), truth) == pytest.approx((1 / 4, 1 / 2, 0.0))


def test_areas_decide_which_part_fits_best():
    found, truth = np.array([0, 0, 1]), np.array([0, 0, 0])
    assert directional_hamming(found, truth) == 1.0
    assert directional_hamming(found, truth, np.array([1.0, 2.0, 9.0])) == 3.0


def test_nothing_weighs_nothing():
    assert hamming_distance(np.array([0, 1]), np.array([0, 0]), np.zeros(2)) == Hamming(0, 0, 0)
