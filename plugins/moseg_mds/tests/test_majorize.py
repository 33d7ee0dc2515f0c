from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_mds.majorize import _inverse, majorize, place, stress, stress_weights

seeds = st.integers(0, 2**32 - 1)
exponents = st.sampled_from([0.0, 1.0, 2.0])


def random_distances(rng, n):
    table = rng.random((n, n)) + 0.1
    table = table + table.T
    np.fill_diagonal(table, 0)
    return table


def guttman(distances, places, weights):
    """``V^+ B(z) z`` by the book (Gansner et al., Eq. 8)."""
    n = len(places)
    v, b = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            if i == j:
                continue
            gap = np.linalg.norm(places[i] - places[j])
            v[i, j] = -weights[i, j]
            b[i, j] = -weights[i, j] * distances[i, j] / gap if gap > 0 else 0.0
        v[i, i], b[i, i] = -v[i].sum(), -b[i].sum()
    return np.linalg.pinv(v) @ b @ places


@given(seed=seeds, n=st.integers(3, 20), exponent=exponents)
@settings(max_examples=40, deadline=None)
def test_a_step_is_the_guttman_transform(seed, n, exponent):
    rng = np.random.default_rng(seed)
    distances, start = random_distances(rng, n), rng.normal(size=(n, 3))
    weights = stress_weights(distances, exponent)
    found = majorize(distances, start, weights=weights, steps=1)
    np.testing.assert_allclose(found, guttman(distances, start, weights), atol=1e-9)


@given(seed=seeds, n=st.integers(3, 20), exponent=exponents)
@settings(max_examples=40, deadline=None)
def test_no_step_raises_the_stress(seed, n, exponent):
    rng = np.random.default_rng(seed)
    distances, start = random_distances(rng, n), rng.normal(size=(n, 3))
    weights = stress_weights(distances, exponent)
    values = [
        stress(distances, majorize(distances, start, weights=weights, steps=steps), weights)
        for steps in range(8)
    ]
    assert all(after <= before * (1 + 1e-12) for before, after in itertools.pairwise(values))


def test_points_in_space_stay(make):
    places = np.random.default_rng(0).normal(size=(12, 3))
    found = majorize(make.apart(places), places)
    np.testing.assert_allclose(found, places - places.mean(axis=0), atol=1e-12)


def test_landmarks_that_coincide_do_no_harm(make):
    places = np.array([[0, 0, 0], [0, 0, 0], [1, 0, 0.0]])
    found = majorize(make.apart(places), places)
    assert np.isfinite(found).all()


def test_all_steps_may_be_left_out():
    start = np.array([[0, 0, 0], [4, 0, 0.0]])
    assert majorize(np.array([[0, 1.0], [1, 0]]), start, steps=0).tolist() == [
        [-2, 0, 0],
        [2, 0, 0],
    ]


@given(seed=seeds, exponent=exponents)
@settings(max_examples=30, deadline=None)
def test_placing_never_raises_a_points_own_stress(seed, exponent):
    rng = np.random.default_rng(seed)
    landmarks, start = rng.normal(size=(9, 3)), rng.normal(size=(600, 3))
    distances = rng.random((9, 600)) + 0.1
    weights = stress_weights(distances, exponent)

    def own(places):
        gaps = np.linalg.norm(landmarks[:, None] - places, axis=2)
        return (weights * (gaps - distances) ** 2).sum(axis=0)

    values = [
        own(place(distances, landmarks, start, weights=weights, steps=steps)) for steps in range(5)
    ]
    for before, after in itertools.pairwise(values):
        assert (after <= before * (1 + 1e-9)).all()


def test_points_among_landmarks_are_found_again(make):
    rng = np.random.default_rng(3)
    landmarks, points = rng.normal(size=(20, 3)), rng.normal(size=(50, 3))
    distances = np.linalg.norm(landmarks[:, None] - points, axis=2)
    start = points + 0.1 * rng.normal(size=points.shape)
    np.testing.assert_allclose(place(distances, landmarks, start, steps=400), points, atol=1e-6)


def test_weights():
    assert stress_weights(np.array([[0.0, 1e-9, 0.5, 1.0]]), 2.0)[0].tolist() == pytest.approx(
        [1e6, 1e6, 4, 1]
    )
    assert stress_weights(np.zeros((2, 2)), 2.0).tolist() == [[1, 1], [1, 1]]
    assert stress_weights(np.array([[0.2, 4.0]]), 0.0).tolist() == [[1, 1]]


@given(seed=seeds, n=st.integers(1, 30))
@settings(max_examples=20, deadline=None)
def test_the_inverse_is_one(seed, n):
    root = np.random.default_rng(seed).normal(size=(n, n))
    matrix = np.einsum("ij,kj->ik", root, root) + np.eye(n)
    np.testing.assert_allclose(matrix @ _inverse(matrix), np.eye(n), atol=1e-9)
