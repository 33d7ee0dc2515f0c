"""Hulls of points in general position and in none, against Qhull and against all triangles."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.quickhull import quickhull_volume
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation


def volume_of_all_facets(points):
    """From every triangle of points that has no point in front of it; of no four in a plane."""
    middle, total = points.mean(axis=0), 0.0
    for a, b, c in combinations(points, 3):
        normal = np.cross(b - a, c - a)
        heights = (points - a) @ normal
        if (heights < 1e-15).all() or (heights > -1e-15).all():
            total += abs((middle - a) @ normal) / 6
    return total


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(4, 16))
@settings(max_examples=25, deadline=None)
def test_few_points_against_every_triangle_of_them(seed, n):
    points = np.random.default_rng(seed).random((n, 3))
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0)
    assert quickhull_volume(points) == pytest.approx(volume_of_all_facets(points), rel=1e-12)


@given(seed=st.integers(0, 2**32 - 1), n=st.integers(5, 400), steps=st.integers(1, 8))
@settings(max_examples=60, deadline=None)
def test_many_points_in_few_planes_and_places(seed, n, steps):
    """Points of a small grid: most lie in common planes and lines, and many coincide."""
    points = np.random.default_rng(seed).integers(0, steps, (n, 3), endpoint=True) / steps
    points[:2] = [[0, 0, 0], [1, 1, 1]]
    flat = np.linalg.matrix_rank(points) < 3
    exact = 0.0 if flat else ConvexHull(points).volume
    assert quickhull_volume(points) == pytest.approx(exact, rel=1e-13, abs=1e-15)


@given(seed=st.integers(0, 2**32 - 1), thickness=st.sampled_from([1, 1e-3, 1e-6]))
@settings(max_examples=60, deadline=None)
def test_a_turned_box_of_many_points_is_a_box(seed, thickness):
    """Its points are in six planes up to rounding, which is much where a thin box is stretched."""
    rng = np.random.default_rng(seed)
    axes = [np.linspace(0, 1, k) for k in rng.integers(2, 14, 3)]
    box = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    sides = np.array([1.0, thickness ** rng.random(), thickness])
    turn = Rotation.random(rng=rng)
    points = turn.inv().apply(turn.apply(box * sides)) / sides
    assert quickhull_volume(points) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("n", [10, 3000])
def test_points_on_a_ball_are_corners_all(n):
    points = np.random.default_rng(n).normal(size=(n, 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points /= np.ptp(points, axis=0)
    assert quickhull_volume(points) == pytest.approx(ConvexHull(points).volume, rel=1e-13)


def test_where_points_are_does_not_matter():
    points = np.random.default_rng(0).random((200, 3))
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0)
    away = quickhull_volume(points + np.array([3.0, -4.0, 5.0]))
    assert away == pytest.approx(quickhull_volume(points), rel=1e-14)


def test_points_in_a_plane_and_too_few_have_no_volume():
    square = np.array([[x, y, x] for x in (0.0, 0.5, 1) for y in (0, 1)])
    assert quickhull_volume(square) == 0.0
    assert quickhull_volume(np.eye(3)) == 0.0
