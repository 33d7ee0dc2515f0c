"""Distances by a tree of boxes against distances to all triangles, and against libigl's."""

from __future__ import annotations

import igl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.surface_tree import SurfaceTree

import moseg_core as moseg


def surface(seed):
    """Triangles of all sizes, maybe all in a plane or close to one, and points far and near."""
    rng = np.random.default_rng(seed)
    vertices = rng.normal(size=(rng.integers(3, 200), 3)) * [3, 2, 1]
    n = rng.integers(1, 100)
    triangles = np.array([rng.choice(len(vertices), 3, replace=False) for _ in range(n)])
    vertices[:, rng.integers(3)] *= rng.choice([1.0, 1e-3, 0.0])
    corners = vertices[triangles]
    inside = corners[rng.integers(0, len(corners), 40)].mean(axis=1)
    points = [rng.normal(size=(40, 3)) * 4, vertices[rng.integers(0, len(vertices), 20)], inside]
    return vertices, triangles, np.concatenate(points)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=12, deadline=None)
def test_distances_to_all_triangles(seed, make):
    vertices, triangles, points = surface(seed)
    found = SurfaceTree.of(vertices, triangles).squared_distances(points)
    exact = make.squared_distances(points, vertices[triangles])
    np.testing.assert_allclose(found, exact, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("name", ["horse", "hammer"])
def test_libigls_distances_to_the_last_bit(name):
    mesh = moseg.load(moseg.sample_path(name)).geometry
    vertices = np.ascontiguousarray(mesh.vertices)
    triangles = np.ascontiguousarray(mesh.triangles[::2], np.int64)
    size, rng = np.ptp(vertices, axis=0), np.random.default_rng(0)
    points = [
        vertices.min(axis=0) + rng.uniform(-0.2, 1.2, (2000, 3)) * size,
        vertices[::5] + 1e-3 * size * rng.normal(size=vertices[::5].shape),
    ]
    points = np.concatenate(points)
    tree = igl.AABB()
    tree.init(vertices, triangles)
    exact = np.asarray(tree.squared_distance(vertices, triangles, points)[0]).reshape(-1)
    found = SurfaceTree.of(vertices, triangles).squared_distances(points)
    np.testing.assert_array_equal(found, exact)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=12, deadline=None)
def test_the_image_that_comes_closest(seed):
    vertices, triangles, points = surface(seed)
    tree, rng = SurfaceTree.of(vertices, triangles), np.random.default_rng(seed)
    weights = rng.random(len(points))
    images = [points + 0.1 * rng.normal(size=3) for _ in range(4)]
    every = [tree.squared_distances(image) for image in images]
    best = np.argmin([(weights * squared).sum() for squared in every])
    np.testing.assert_array_equal(tree.least_distances(images, weights), every[best])


def test_images_that_come_equally_close():
    tree = SurfaceTree.of(np.eye(3), np.array([[0, 1, 2]]))
    points = np.random.default_rng(0).random((50, 3))
    found = tree.least_distances([points, points.copy()], np.ones(50))
    np.testing.assert_array_equal(found, tree.squared_distances(points))


def test_triangles_in_one_place():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    tree = SurfaceTree.of(vertices, np.array([[0, 1, 2]] * 50))
    assert tree.squared_distances(np.array([[0.2, 0.2, 2.0], [2, 0, 0]])).tolist() == [4.0, 1.0]


def test_to_a_surface_of_no_triangles_it_is_infinitely_far():
    tree = SurfaceTree.of(np.eye(3), np.zeros((0, 3), np.int64))
    assert np.isinf(tree.squared_distances(np.ones((2, 3)))).all()
