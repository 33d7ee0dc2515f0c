"""Consistency errors against their definition, element by element."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.agreement import Consistency, consistency_errors
from tests.agreement import references
from tests.agreement.labellings import pairs_of_labellings, renumbered, shuffled


def values(*arrays):
    errors = consistency_errors(*arrays)
    return errors.global_error, errors.local_error


@given(pairs_of_labellings())
@settings(max_examples=100)
def test_the_errors_are_those_of_the_definition(case):
    first, second, weights = case
    by_faces = references.consistency_errors(first, second, [1.0] * len(first))
    assert values(first, second) == pytest.approx(by_faces, abs=1e-12)
    by_area = references.consistency_errors(first, second, weights)
    assert values(first, second, weights) == pytest.approx(by_area, abs=1e-10)


@given(pairs_of_labellings(), st.integers(1, 5), st.floats(0.001, 1000.0))
@settings(max_examples=60)
def test_the_errors_know_no_names_no_order_and_no_units(case, seed, factor):
    first, second, weights = case
    errors = values(first, second, weights)
    assert 0.0 <= errors[1] <= errors[0] + 1e-12 < 1.0
    assert values(first, renumbered(first, seed), weights) == (0.0, 0.0)
    for other in (
        values(second, first, weights),
        values(renumbered(first, seed), renumbered(second, seed + 1), weights),
        values(*shuffled((first, second, weights), seed)),
        values(first, second, factor * weights),
    ):
        assert other == pytest.approx(errors, abs=1e-10)


@given(pairs_of_labellings())
@settings(max_examples=60)
def test_a_refinement_is_no_error(case):
    first, second, weights = case
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    finer = np.array([pairs.index(pair) for pair in pairs])
    for coarser in (first, second, np.zeros(len(first), int)):
        assert values(coarser, finer, weights) == (0.0, 0.0)
    assert values(first, np.arange(len(first)), weights) == (0.0, 0.0)


def test_refined_here_in_one_and_there_in_the_other_is_a_global_error_alone():
    # Each cuts another half of the four into two: 2 of 4 elements are cut by the other by 1/2.
    assert values(np.array([0, 1, 2, 2]), np.array([0, 0, 1, 2])) == (0.25, 0.0)


def test_a_cut_in_another_place():
    assert values(np.array([0, 0, 1, 1]), np.array([0, 1, 1, 1])) == (0.25, 0.125)
    # By area the first has parts of 2 and 4, the second of 1 and 5; their cuts cross one part each.
    areas = np.array([1.0, 1.0, 4.0])
    forth = (1.0 * 1 / 2 + 1.0 * 1 / 2) / 6.0
    back = (1.0 * 4 / 5 + 4.0 * 1 / 5) / 6.0
    assert values(np.array([0, 0, 1]), np.array([0, 1, 1]), areas) == pytest.approx(
        (min(forth, back), (0.0 + 1.0 * 1 / 2 + 0.0) / 6.0)
    )


def test_nothing_weighs_nothing():
    assert consistency_errors(np.array([0, 1]), np.array([0, 0]), np.zeros(2)) == Consistency(0, 0)
