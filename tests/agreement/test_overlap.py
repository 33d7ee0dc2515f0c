"""The contingency table against sets of elements."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from moseg_core.agreement import (
    consistency_errors,
    directional_hamming,
    hamming_distance,
    labelled,
    overlap,
    rand_index_error,
)
from moseg_core.errors import UsageError
from tests.agreement import references
from tests.agreement.labellings import pairs_of_labellings, partly_labelled_pairs


@given(pairs_of_labellings())
@settings(max_examples=100)
def test_the_table_holds_what_parts_have_in_common(case):
    first, second, weights = case
    table = overlap(first, second, weights)
    ours, others = references.parts(first), references.parts(second)
    expected = {
        (i, j): references.weigh(mine & other, weights)
        for i, mine in enumerate(ours)
        for j, other in enumerate(others)
        if mine & other
    }
    cells = list(zip(table.first.tolist(), table.second.tolist(), strict=True))
    assert len(set(cells)) == len(cells)
    assert dict(zip(cells, table.shared.tolist(), strict=True)) == pytest.approx(expected)
    assert table.first_sizes == pytest.approx([references.weigh(part, weights) for part in ours])
    assert table.second_sizes == pytest.approx([references.weigh(part, weights) for part in others])
    assert table.total == pytest.approx(sum(weights))
    assert table.squares == pytest.approx(sum(w * w for w in weights))


@given(partly_labelled_pairs())
@settings(max_examples=100)
def test_elements_without_a_label_are_as_if_they_were_not_there(case):
    first, second, weights, known = case
    np.testing.assert_array_equal(labelled(first, second), known)
    if not known.any():
        with pytest.raises(UsageError, match="nothing to compare"):
            overlap(first, second, weights)
        return
    here = overlap(first, second, weights)
    there = overlap(first[known], second[known], weights[known])
    for name in ("first", "second", "shared", "first_sizes", "second_sizes", "squares"):
        np.testing.assert_array_equal(getattr(here, name), getattr(there, name))


def test_a_part_for_every_element_on_both_sides_needs_no_square_table():
    n = 300_000  # a full table would take 720 GB
    table = overlap(np.arange(n), np.arange(n)[::-1])
    assert len(table.shared) == n
    assert table.total == n


@pytest.mark.parametrize("sizes", [(3, 4, 3), (3, 3, 2), (1, 3, 3)])
def test_arrays_of_different_lengths_are_refused(sizes):
    first, second, weights = (np.zeros(size, int) for size in sizes)
    with pytest.raises(UsageError, match="these have {}, {} and {}".format(*sizes)):
        overlap(first, second, weights)


@pytest.mark.parametrize(
    "measure",
    [overlap, hamming_distance, directional_hamming, rand_index_error, consistency_errors],
)
def test_nothing_known_in_common_is_no_agreement(measure):
    with pytest.raises(UsageError, match="nothing has a label in both labellings"):
        measure(np.array([-1, 0]), np.array([0, -1]), np.ones(2))
