from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.surface_distance import (
    _sub_centroids,
    normalized_mean,
    surface_samples,
    surface_tree,
)
from scipy.spatial.transform import Rotation

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 20])
def test_sub_centroids_tile_the_triangle(n):
    table = _sub_centroids(n)
    assert table.shape == (n * n, 3)
    np.testing.assert_allclose(table.sum(axis=1), 1, atol=1e-15)
    assert (table > 0).all()
    # The pieces of the grid, literally: those that point up, and those that point down.
    expected = []
    for i in range(n):
        for j in range(n - i):
            piece = np.array([[i, j], [i + 1, j], [i, j + 1]])
            expected.append(piece.mean(axis=0) / n)
            if i + j < n - 1:
                piece = np.array([[i + 1, j], [i, j + 1], [i + 1, j + 1]])
                expected.append(piece.mean(axis=0) / n)
    found = table[:, 1:]
    np.testing.assert_allclose(
        found[np.lexsort(found.T.round(9))],
        np.array(expected)[np.lexsort(np.array(expected).T.round(9))],
        atol=1e-15,
    )
    # Pieces of equal area: their mean is the whole's centroid.
    np.testing.assert_allclose(table.mean(axis=0), 1 / 3, atol=1e-15)


@given(data=st.data())
@settings(max_examples=10, deadline=None)
def test_weights_add_up_to_the_area(data, make):
    for part in data.draw(make.shapes).segmentation().parts:
        points, weights = surface_samples(part)
        assert len(points) == len(weights)
        assert weights.sum() == pytest.approx(part.area, rel=1e-13)
        # Centroids integrate linear functions exactly.
        np.testing.assert_allclose(weights @ points / part.area, part.centroid, atol=1e-13)


def test_weights_on_nasty_parts(nasty):
    for name, part in nasty.items():
        points, weights = surface_samples(part)
        assert np.isfinite(points).all(), name
        assert (weights >= 0).all(), name
        assert weights.sum() == pytest.approx(part.area, rel=1e-9), name


@pytest.mark.parametrize("seed", range(60))
def test_samples_are_a_twentieth_of_the_box_apart_at_most(make, seed):
    # One rectangle: two triangles, whose longest side is the whole diagonal, wherever it lies.
    turn = Rotation.random(rng=seed)
    part = make.part(make.moved(make.rectangle(4, 3), turn=turn, shift=seed))
    points, weights = surface_samples(part)
    assert len(points) == 2 * 20**2
    np.testing.assert_allclose(weights, 6 / 20**2, rtol=1e-9)


def test_fine_meshes_are_left_as_they_are(make):
    fine = make.part(make.ball(4))
    points, _ = surface_samples(fine)
    middles = fine.vertices[fine.triangles].mean(axis=1)
    np.testing.assert_allclose(points, middles, atol=1e-15)


@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
def test_low_polynomials(make, turn):
    a, b = 4.0, 3.0
    mesh = make.rectangle(a, b)
    part = make.part(make.moved(mesh, turn=turn, shift=[5, 6, 7]))
    points, weights = surface_samples(part)
    x, y, z = (turn.inv().apply(points - [5, 6, 7])).T
    np.testing.assert_allclose(z, 0, atol=1e-13)
    for function, exact in (
        (np.ones_like(x), a * b),
        (x, a**2 * b / 2),
        (y, a * b**2 / 2),
        (3 * x - 2 * y + 1, 3 * a**2 * b / 2 - a * b**2 + a * b),
    ):
        assert weights @ function == pytest.approx(exact, rel=1e-13)
    # Centroids miss the spread of a square within a piece, up to (sum of squared sides) / 36.
    missing = 3 * (np.hypot(a, b) / 20) ** 2 / 36 * a * b
    for function, exact in (
        (x**2, a**3 * b / 3),
        (y**2, a * b**3 / 3),
        (x**2 + y**2, (a**3 * b + a * b**3) / 3),
    ):
        assert 0 <= exact - weights @ function <= missing
    assert weights @ (x * y) == pytest.approx(a**2 * b**2 / 4, abs=missing)


def test_coarse_meshes_are_integrated_as_finely_as_dense_ones(make):
    values = []
    for sections in (8, 80):
        part = make.part(make.tube(1, 12, sections, caps=False))
        points, weights = surface_samples(part)
        local = (points - part.centroid) @ part.axes.T
        values.append(weights @ local[:, 0] ** 2 / part.area)
        assert values[-1] == pytest.approx(12**2 / 12, rel=5e-3)
    assert values[0] == pytest.approx(values[1], rel=5e-3)


@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=15, deadline=None)
def test_distances_to_the_surface(data, make, seed):
    rng = np.random.default_rng(seed)
    part = data.draw(make.shapes).segmentation().parts[rng.integers(3)]
    corners = part.vertices[part.triangles]
    points = np.concatenate(
        [rng.normal(size=(60, 3)), part.vertices[:20], surface_samples(part)[0][:20]]
    )
    found = surface_tree(part).squared_distances(points)
    np.testing.assert_allclose(found, make.squared_distances(points, corners), atol=1e-14)


def test_distance_is_to_faces_and_not_to_vertices(make):
    tree = surface_tree(make.part(make.box(2, 2, 2)))
    at = np.array([[0, 0, 0], [0, 0, 3], [3, 3, 0], [2, 2, 2], [1, 0.3, -0.2], [0.5, 0.1, 0.2]])
    expected = [1, 4, 8, 3, 0, 0.25]
    np.testing.assert_allclose(tree.squared_distances(at), expected, atol=1e-15)


def test_faces_of_no_area_do_no_harm(nasty):
    part = nasty["faces of no area"]
    points, _ = surface_samples(part)
    np.testing.assert_allclose(surface_tree(part).squared_distances(points), 0, atol=1e-28)


def test_normalisation(make):
    part = make.part(make.rectangle(4, 3))
    squared, weights = np.array([1.0, 4.0]), np.array([3.0, 1.0])
    expected = (3 * 1 + 1 * 4) / 4 / 25
    assert normalized_mean(part, squared, weights) == pytest.approx(expected, rel=1e-12)
    assert math.isclose(part.box_diagonal, 5)
