"""Thinned meshes: few enough, in the same place, with the labels that they had."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.view.page.thinning import Triangles, _clustered, thinned


@pytest.fixture(scope="module")
def ball():
    """20,480 triangles on the unit sphere, in four labels by their place."""
    mesh = trimesh.creation.icosphere(subdivisions=5)
    middle = mesh.triangles_center
    return Triangles(
        vertices=np.array(mesh.vertices),
        triangles=np.array(mesh.faces),
        labels=(2 * (middle[:, 2] > 0.2) + (middle[:, 0] > 0)).astype(np.int64),
        source=np.arange(len(mesh.faces)),
    )


def areas(triangles):
    corners = triangles.vertices[triangles.triangles]
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.linalg.norm(np.cross(*sides), axis=1) / 2


@pytest.mark.parametrize("most", [500, 4000])
def test_as_many_as_are_wanted_are_left_in_the_same_place(ball, most):
    few = thinned(ball, most=most)
    assert 0.6 * most < len(few.triangles) <= most
    radii = np.linalg.norm(few.vertices, axis=1)
    assert radii.min() > 0.97
    assert radii.max() <= 1.0 + 1e-9


def test_parts_keep_their_labels_and_their_areas(ball):
    few = thinned(ball, most=4000)
    before = np.bincount(ball.labels, areas(ball)) / areas(ball).sum()
    after = np.bincount(few.labels, areas(few)) / areas(few).sum()
    np.testing.assert_allclose(after, before, atol=0.02)


def test_each_triangle_stands_for_one_of_its_label_nearby(ball):
    few = thinned(ball, most=4000)
    assert (ball.labels[few.source] == few.labels).all()
    meant = ball.vertices[ball.triangles[few.source]].mean(axis=1)
    drawn = few.vertices[few.triangles].mean(axis=1)
    assert np.linalg.norm(meant - drawn, axis=1).max() < 0.1


def test_the_label_with_the_most_area_wins():
    """Two triangles over the same three cells, the larger of label 1."""
    rng = np.random.default_rng(0)
    grid = [
        Triangles(
            vertices=np.array(
                [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0.5, 0, 0], [8.6, 0, 0], [0, 8.6, 0]]
            ),
            triangles=np.array([[3, 4, 5], [0, 1, 2], [0, 1, 2]])[order],
            labels=np.array([0, 1, 2])[order],
            source=np.arange(3)[order],
        )
        for order in (np.array([0, 1, 2]), rng.permutation(3))
    ]
    for given in grid:
        sizes = np.array([40.0, 50.0, 45.0])[given.source]
        left = _clustered(given, sizes, 4)
        assert left.labels.tolist() == [1]


def test_few_enough_are_left_alone(ball):
    assert thinned(ball, most=len(ball.triangles)) is ball


def test_a_soup_that_hardly_thins_is_thinned_all_the_same():
    rng = np.random.default_rng(1)
    soup = Triangles(
        vertices=rng.random((3000, 3)),
        triangles=rng.permutation(3000).reshape(1000, 3),
        labels=np.zeros(1000, np.int64),
        source=np.arange(1000),
    )
    assert 0 < len(thinned(soup, most=200).triangles) <= 200


def test_equal_input_gives_equal_output(ball):
    one, other = (thinned(ball, most=2000) for _ in range(2))
    np.testing.assert_array_equal(one.vertices, other.vertices)
    np.testing.assert_array_equal(one.triangles, other.triangles)
