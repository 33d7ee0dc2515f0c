from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_mds.scaling import classical_mds, landmark_mds, normalized_stress

seeds = st.integers(0, 2**32 - 1)


@given(seed=seeds, n=st.integers(4, 40))
@settings(max_examples=40, deadline=None)
def test_points_in_space_are_recovered(make, seed, n):
    table = make.apart(np.random.default_rng(seed).normal(size=(n, 3)))
    found = classical_mds(table)
    np.testing.assert_allclose(make.apart(found), table, atol=1e-7)
    np.testing.assert_allclose(found.mean(axis=0), 0, atol=1e-9)
    variance = (found**2).sum(axis=0)
    assert (np.diff(variance) <= 1e-9).all()
    assert (found[np.abs(found).argmax(axis=0), range(3)] > 0).all()


@given(seed=seeds, n=st.integers(5, 40))
@settings(max_examples=40, deadline=None)
def test_points_in_space_are_recovered_from_landmarks(make, seed, n):
    rng = np.random.default_rng(seed)
    table = make.apart(rng.normal(size=(n, 3)))
    landmarks = rng.permutation(n)[: max(5, n // 2)]
    found = landmark_mds(table[landmarks], landmarks)
    among = table[np.ix_(landmarks, landmarks)]
    np.testing.assert_allclose(found[landmarks], classical_mds(among), atol=1e-7)
    # Landmarks may lie almost in a plane: then only little is known of what is off it.
    flatness = np.linalg.svd(found[landmarks])[1][2]
    np.testing.assert_allclose(make.apart(found), table, atol=1e-9 / flatness**2 + 1e-7)


def test_classical_scaling_is_the_best_of_its_kind(make):
    """Against the definition: no other products of rank 3 are nearer to B."""
    rng = np.random.default_rng(1)
    table = make.apart(rng.normal(size=(9, 5)))
    center = np.eye(9) - 1 / 9
    b = -0.5 * center @ table**2 @ center
    found = classical_mds(table)
    error = np.linalg.norm(b - found @ found.T)
    assert error == pytest.approx(np.sqrt((np.linalg.eigvalsh(b)[:-3] ** 2).sum()))


@pytest.mark.parametrize("dimensions", [1, 2, 3, 5])
def test_axes_that_are_not_needed_are_zero(dimensions):
    line = np.abs(np.subtract.outer(np.arange(4.0), np.arange(4.0)))
    found = classical_mds(line, dimensions=dimensions)
    assert found.shape == (4, dimensions)
    np.testing.assert_allclose(np.abs(found[:, 0]), [1.5, 0.5, 0.5, 1.5])
    assert (found[:, 1:] == 0).all()
    rest = landmark_mds(line[[0, 3]], [0, 3], dimensions=dimensions)
    np.testing.assert_allclose(np.abs(rest[:, 0]), [1.5, 0.5, 0.5, 1.5])
    assert (rest[:, 1:] == 0).all()


def test_stress_is_what_its_formula_says():
    rng = np.random.default_rng(0)
    x, y, d = rng.normal(size=(4, 3)), rng.normal(size=(3000, 3)), rng.random((4, 3000))
    off = total = 0.0
    for i in range(4):
        for j in range(3000):
            off += (np.linalg.norm(x[i] - y[j]) - d[i, j]) ** 2
            total += d[i, j] ** 2
    assert normalized_stress(d, x, y) == pytest.approx((off / total) ** 0.5)
    assert normalized_stress(np.zeros((2, 2)), np.zeros((2, 3))) == 0
