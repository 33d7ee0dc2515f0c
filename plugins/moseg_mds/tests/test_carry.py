from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_mds.carry import carry_along, handedness, turned_like
from scipy.spatial.transform import Rotation

seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds, mirrored=st.booleans())
@settings(max_examples=30, deadline=None)
def test_what_moves_like_a_body_is_moved_like_it(make, seed, mirrored):
    rng = np.random.default_rng(seed)
    points, landmarks = rng.normal(size=(40, 3)), rng.normal(size=(8, 3))
    distances = np.linalg.norm(landmarks[:, None] - points, axis=2)
    turn, shift = Rotation.random(rng=rng), rng.normal(size=3)
    moved = turn.apply(landmarks) + shift
    np.testing.assert_allclose(
        carry_along(points, distances, landmarks, moved), turn.apply(points) + shift, atol=1e-6
    )
    if mirrored:
        moved = -moved
    # Never inside out, and the mirror image is told from the original.
    carried = carry_along(points[:4], distances[:, :4], landmarks, moved)
    assert np.isfinite(carried).all()
    assert handedness(make.apart(landmarks), landmarks, moved) * (-1 if mirrored else 1) > 0


def test_each_point_against_a_literal_fit():
    """Against scipy's solution of Wahba's problem, point by point."""
    rng = np.random.default_rng(0)
    points, before = rng.normal(size=(30, 3)), rng.normal(size=(7, 3))
    after = before + 0.3 * rng.normal(size=before.shape)
    distances = rng.random((7, 30)) + 0.2
    found = carry_along(points, distances, before, after)
    for k in range(30):
        w = distances[:, k] ** -4.0
        p, r = np.average(before, axis=0, weights=w), np.average(after, axis=0, weights=w)
        turn, _ = Rotation.align_vectors(after - r, before - p, weights=w)
        np.testing.assert_allclose(found[k], turn.apply(points[k] - p) + r, atol=1e-9)


def test_a_landmark_is_where_its_landmark_is():
    rng = np.random.default_rng(1)
    before, after = rng.normal(size=(9, 3)), rng.normal(size=(9, 3))
    distances = np.linalg.norm(before[:, None] - before, axis=2)
    np.testing.assert_allclose(carry_along(before, distances, before, after), after, atol=1e-6)


def test_on_a_plane_there_is_no_hand(make):
    flat = np.random.default_rng(2).normal(size=(9, 3)) * [1, 1, 0]
    assert handedness(make.apart(flat), flat, flat) == pytest.approx(0, abs=1e-12)


@given(seed=seeds)
@settings(max_examples=30, deadline=None)
def test_turning_is_rigid_and_finds_back(make, seed):
    rng = np.random.default_rng(seed)
    model = rng.normal(size=(12, 3))
    turned = Rotation.random(rng=rng).apply(model) + rng.normal(size=3)
    np.testing.assert_allclose(turned_like(turned, model), model - model.mean(axis=0), atol=1e-9)
    mirrored = turned_like(-turned, model)
    np.testing.assert_allclose(make.apart(mirrored), make.apart(model), atol=1e-9)
    assert np.linalg.det(mirrored[1:4] - mirrored[0]) == pytest.approx(
        -np.linalg.det(model[1:4] - model[0])
    )
