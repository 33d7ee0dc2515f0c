"""Convex hulls as meshes: closed, outside out, all points within; few vertices, flat points."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from moseg_core.shape.convex import convex_hull
from tests import shapes


def solid(hull):
    return trimesh.Trimesh(hull.vertices, hull.triangles, process=False)


def beyond(hull, points):
    planes = ConvexHull(hull.vertices).equations
    return (points @ planes[:, :3].T + planes[:, 3]).max()


@given(st.integers(0, 10_000), st.integers(5, 60), st.sampled_from([1e-6, 1.0, 1e9]))
@settings(max_examples=30)
def test_all_points_are_within_a_closed_hull(seed, count, size):
    rng = np.random.default_rng(seed)
    points = size * (rng.normal(size=(count, 3)) * [3, 2, 1] + 5.0)
    hull = convex_hull(points)
    assert solid(hull).is_watertight
    assert solid(hull).volume == pytest.approx(ConvexHull(points / size).volume * size**3)
    assert beyond(hull, points) <= 1e-9 * size
    assert hull.shortfall == 0.0
    assert not hull.thickened


def test_points_in_the_planes_of_a_box_are_no_vertices():
    vertices, _ = shapes.box(5, 4, 3)
    turned = vertices @ shapes.rotation(3).T
    hull = convex_hull(turned)
    assert (len(hull.vertices), len(hull.triangles)) == (8, 12)
    assert solid(hull).is_watertight
    assert solid(hull).volume == pytest.approx(60.0)


def test_few_vertices_are_the_farthest_and_it_is_known_what_is_missed():
    points = shapes.sphere(3)[0]
    short, volume = [], []
    for most in (4, 8, 16, 32, 64):
        hull = convex_hull(points, most=most)
        assert len(hull.vertices) == most
        assert solid(hull).is_watertight
        assert hull.shortfall == pytest.approx(beyond(hull, points))
        assert beyond(convex_hull(points), hull.vertices) < 1e-9
        short.append(hull.shortfall)
        volume.append(solid(hull).volume)
    assert short == sorted(short, reverse=True)
    assert volume == sorted(volume)
    assert short[-1] < 0.1
    assert volume[-1] > 0.85 * 4 / 3 * np.pi


def test_a_box_of_eight_vertices_is_that_box():
    points = np.concatenate([shapes.box(5, 4, 3)[0], [[2.0, 2.0, 1.0]]])
    hull = convex_hull(points, most=8)
    assert solid(hull).volume == pytest.approx(60.0)
    assert hull.shortfall == 0.0


@pytest.mark.parametrize("spread", [[4, 2, 0], [4, 0, 0], [4, 2, 1e-9]])
def test_what_is_flat_is_made_a_thin_solid(spread):
    points = np.random.default_rng(1).uniform(size=(20, 3)) * spread @ shapes.rotation(2).T
    hull = convex_hull(points + 7.0)
    assert hull.thickened
    assert solid(hull).is_watertight
    assert solid(hull).volume > 0
    thick = np.linalg.svd(hull.vertices - hull.vertices.mean(axis=0))[1][-1]
    assert thick < 0.02 * np.linalg.norm(np.ptp(points, axis=0))


def test_one_place_has_no_hull():
    assert convex_hull(np.ones((5, 3))) is None
    assert convex_hull(np.array([[0.0, 0, 0], [1, 0, 0]])).thickened
