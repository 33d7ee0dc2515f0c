from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_mds.landmarks import farthest_points


def rows_of(table):
    return lambda k: table[k].copy()


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 30))
@settings(max_examples=30, deadline=None)
def test_each_is_farthest_from_those_before(make, seed, count):
    table = make.apart(np.random.default_rng(seed).normal(size=(25, 3)))
    landmarks, found = farthest_points(rows_of(table), count)
    assert len(landmarks) == min(count, 25)
    assert len(set(landmarks.tolist())) == len(landmarks)
    np.testing.assert_array_equal(found, table[landmarks])
    for k in range(1, len(landmarks)):
        gaps = table[landmarks[:k]].min(axis=0)
        assert gaps[landmarks[k]] == gaps.max()


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_the_order_of_vertices_does_not_matter(make, seed):
    rng = np.random.default_rng(seed)
    # On a line the ends of a longest way are unique, so that no start leads elsewhere.
    places = rng.normal(size=(25, 3)) * [10, 0.1, 0.1]
    order = rng.permutation(25)
    landmarks, _ = farthest_points(rows_of(make.apart(places)), 8)
    others, _ = farthest_points(rows_of(make.apart(places[order])), 8)
    np.testing.assert_array_equal(order[others], landmarks)


def test_places_that_coincide_count_once(make):
    places = np.repeat(np.eye(3), 4, axis=0)
    assert len(farthest_points(rows_of(make.apart(places)), 10)[0]) == 3


def test_tips_come_first():
    """Arms of a star: all tips before anything between."""
    arms, steps = 8, 10
    arm, step = np.divmod(np.arange(arms * steps), steps)
    step = step + 1
    table = np.where(arm[:, None] == arm, np.abs(step[:, None] - step), step[:, None] + step)
    landmarks, _ = farthest_points(rows_of(table.astype(float)), arms)
    assert sorted(arm[landmarks].tolist()) == list(range(arms))
    assert (step[landmarks] == steps).all()


@pytest.mark.parametrize("count", [1, 2])
def test_few(count):
    table = np.array([[0, 1.0], [1.0, 0]])
    assert len(farthest_points(rows_of(table), count)[0]) == count
