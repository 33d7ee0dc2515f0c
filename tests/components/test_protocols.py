"""Centres of parts that have one or several."""

from __future__ import annotations

import numpy as np

from moseg_core.components.protocols import Centers

AT = np.arange(18.0).reshape(6, 3)
WEIGHTS = np.arange(1.0, 7.0)
SEVERAL = Centers(positions=AT, weights=WEIGHTS, parts=np.array([0, 1, 1, 1, 2, 2]))
SINGLE = Centers(positions=AT[:3], weights=WEIGHTS[:3])


def weights(centers):
    parts = None if centers.parts is None else centers.parts.tolist()
    assert (centers.positions[:, 0] == 3 * (centers.weights - 1)).all()
    return centers.weights.tolist(), parts


def test_one_each_is_said_by_no_parts():
    assert SINGLE.per_part.tolist() == [1, 1, 1]
    assert SINGLE.first is SINGLE
    assert weights(SINGLE.ordered(np.array([2, 0, 1]))) == ([3, 1, 2], None)
    assert weights(SINGLE.of(1)) == ([2], None)


def test_a_part_is_taken_with_all_its_centres():
    assert SEVERAL.per_part.tolist() == [1, 3, 2]
    assert weights(SEVERAL.first) == ([1, 2, 5], None)
    assert weights(SEVERAL.of(0)) == ([1], None)
    assert weights(SEVERAL.of(1)) == ([2, 3, 4], [0, 0, 0])
    assert weights(SEVERAL.ordered(np.array([2, 0, 1]))) == ([5, 6, 1, 2, 3, 4], [0, 0, 1, 2, 2, 2])


def test_fitted_centres_are_the_first_or_in_the_place_of_the_first():
    assert SEVERAL.fitted(np.array([1, 3, 2])) is SEVERAL
    assert weights(SEVERAL.fitted(np.array([2, 2, 3]))) == (
        [1, 1, 2, 3, 5, 6, 5],
        [0, 0, 1, 1, 2, 2, 2],
    )
    assert weights(SINGLE.fitted(np.array([1, 2, 1]))) == ([1, 2, 2, 3], [0, 1, 1, 2])


def test_parts_are_joined_in_order():
    assert weights(Centers.joined([SEVERAL.of(2), SEVERAL.first, SEVERAL.of(0)])) == (
        [5, 6, 1, 2, 5, 1],
        [0, 0, 1, 2, 3, 4],
    )
    assert weights(Centers.joined([SINGLE, SINGLE.of(0)])) == ([1, 2, 3, 1], None)
