"""The nearest points of each: a search tree's, and others in the place where there are many."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from moseg_core.shape.nearest import nearest_points

RNG = np.random.default_rng(0)


def test_where_no_place_is_crowded_they_are_those_of_a_tree():
    points = np.repeat(RNG.random((40, 3)), 3, axis=0)
    distances, numbers = nearest_points(points, 8)
    expected = cKDTree(points).query(points, 8)
    assert (distances == expected[0]).all()
    assert (numbers == expected[1]).all()


@pytest.mark.parametrize("count", [1, 2, 9])
def test_beside_crowded_places_distances_are_those_of_all_pairs(count):
    places = RNG.random((30, 3))
    points = np.concatenate([places, np.repeat(places[:2], [50, 70], axis=0)])
    points = points[RNG.permutation(len(points))]
    distances, numbers = nearest_points(points, count)
    pairs = np.linalg.norm(points[:, None] - points, axis=2)
    assert distances == pytest.approx(np.sort(pairs, axis=1)[:, :count], abs=1e-12)
    assert np.take_along_axis(pairs, numbers, axis=1) == pytest.approx(distances, abs=1e-12)
    assert all(len(set(row)) == count for row in numbers.tolist())


def test_points_in_one_place_have_each_other_in_a_ring():
    numbers = nearest_points(np.zeros((100_000, 3)), 3)[1]
    assert numbers[[0, 5]].tolist() == [[0, 99_999, 1], [5, 4, 6]]
