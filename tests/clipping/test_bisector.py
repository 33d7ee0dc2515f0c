"""Roots on edges against bisection, junctions in triangles against their definition."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.clipping.bisector import Bisectors
from tests.clipping.checks import weighted


def random_bisectors(seed: int, n: int = 2, *, equal: bool = False) -> Bisectors:
    rng = np.random.default_rng(seed)
    weights = np.ones(n) if equal else rng.uniform(0.3, 3.0, n)
    return Bisectors(rng.uniform(-1, 1, (n, 3)), weights)


def bisected(pair: Bisectors, start: np.ndarray, end: np.ndarray) -> float:
    """Where the nearer centre changes from 0 to 1, by halving 80 times."""
    low, high = 0.0, 1.0
    for _ in range(80):
        t = (low + high) / 2
        first, second = weighted((start + t * (end - start))[None], pair.centers, pair.weights)[0]
        low, high = (low, t) if first > second else (t, high)
    return low


@given(seed=st.integers(0, 10_000), equal=st.booleans(), scale=st.sampled_from([1e-3, 1.0, 1e3]))
@settings(max_examples=150)
def test_crossings_are_where_bisection_finds_them(seed, equal, scale):
    pair = random_bisectors(seed, equal=equal)
    pair = Bisectors(pair.centers * scale, pair.weights)
    ends = np.random.default_rng(seed + 1).uniform(-2, 2, (40, 2, 3)) * scale
    near = weighted(ends.reshape(-1, 3), pair.centers, pair.weights).argmin(axis=1).reshape(-1, 2)
    ends = np.concatenate(
        [ends[(near == [0, 1]).all(axis=1)], ends[(near == [1, 0]).all(axis=1), ::-1]]
    )
    zero = np.zeros(len(ends), np.int64)
    found = pair.crossing(ends[:, 0], ends[:, 1], zero, zero + 1)
    for t, (start, end) in zip(found, ends, strict=True):
        assert t == pytest.approx(bisected(pair, start, end), abs=1e-9)


@given(seed=st.integers(0, 10_000), factor=st.floats(0.1, 10))
def test_only_ratios_of_weights_matter(seed, factor):
    one = random_bisectors(seed)
    other = Bisectors(one.centers, one.weights * factor)
    ends = np.random.default_rng(seed).uniform(-2, 2, (2, 9, 3))
    zero = np.zeros(9, np.int64)
    np.testing.assert_allclose(
        one.crossing(*ends, zero, zero + 1), other.crossing(*ends, zero, zero + 1), atol=1e-9
    )


def test_an_end_on_the_bisector_is_the_crossing():
    pair = Bisectors(np.array([[-1.0, 0, 0], [1, 0, 0]]), np.ones(2))
    start = np.array([[0.0, 2, 0], [-1, 0, 0]])
    end = np.array([[1.0, 2, 0], [0, 5, 0]])
    zero = np.zeros(2, np.int64)
    assert pair.crossing(start, end, zero, zero + 1).tolist() == [0.0, 1.0]


def test_an_edge_that_leaves_a_sphere_of_apollonius_through_its_far_side():
    # Points less than half as far from (0, 0, 0) as from (3, 0, 0): the ball around (-1, 0, 0)
    # of radius 2.
    pair = Bisectors(np.array([[0.0, 0, 0], [3, 0, 0]]), np.array([1.0, 2]))
    start, end = np.array([[-1.0, 0, 0]]), np.array([[-1.0, 0, 8]])
    zero = np.array([0])
    assert pair.crossing(start, end, zero, zero + 1)[0] == pytest.approx(0.25, abs=1e-15)


def conditions(three: Bisectors, corners: np.ndarray) -> np.ndarray:
    """How near to parallel two bisecting planes are, as seen in the plane of each triangle."""
    normals = three.centers[1:] - three.centers[:1]
    sides = corners[:, 1:] - corners[:, :1]
    return np.linalg.cond(np.einsum("kd,tsd->tks", normals, sides))


@given(seed=st.integers(0, 10_000), equal=st.booleans())
@settings(max_examples=100)
def test_junctions_are_equally_near_to_all_three(seed, equal):
    rng = np.random.default_rng(seed)
    three = random_bisectors(seed, 3, equal=equal)
    corners = rng.uniform(-1, 1, (20, 3, 3))
    triples = np.tile(rng.permutation(3), (20, 1))
    share = three.junction(corners, triples, np.full((20, 3), 1 / 3))
    found = np.isfinite(share).all(axis=1)
    if equal:  # planes meet in the plane of every triangle; spheres need not
        # Elsewhere they meet so far outside that the last step of Newton's method is rounding:
        # of all seeds here the first such triangle has a condition of 5000.
        close = conditions(three, corners) < 1e3
        assert close.any()
        assert found[close].all()
    inside = found & (np.abs(np.where(found[:, None], share, 0.0)) < 10).all(axis=1)
    np.testing.assert_allclose(share[inside].sum(axis=1), 1.0, atol=1e-12)
    points = np.einsum("tk,tkd->td", share[inside], corners[inside])
    near = weighted(points, three.centers, three.weights)
    np.testing.assert_allclose(near, np.repeat(near[:, :1], 3, axis=1), rtol=1e-7)


def test_where_there_is_no_junction_none_is_found():
    # Three centres in a row have parallel bisectors.
    row = Bisectors(np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.ones(3))
    corners = np.array([[[0.0, 0, 0], [2, 0, 0], [1, 1, 0]]])
    share = row.junction(corners, np.array([[0, 2, 1]]), np.full((1, 3), 1 / 3))
    assert np.isnan(share).all()
