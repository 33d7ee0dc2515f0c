"""The furthest pair against a look at all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.diameter import farthest_pair
from tests import references, shapes


@given(st.integers(0, 2**32), st.integers(1, 40), st.sampled_from(["cloud", "grid", "line", "far"]))
@settings(max_examples=150, deadline=None)
def test_the_pair_is_that_of_brute_force(seed, size, kind):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(size, 3))
    if kind == "grid":  # many pairs tie: the lowest is asked for
        points = rng.integers(0, 3, (size, 3)).astype(np.float64)
    if kind == "line":
        points = rng.integers(0, 9, (size, 1)) * np.array([[1.0, 2.0, -1.0]])
    if kind == "far":
        points = points + np.array([1e6, -3e6, 2e6])
    assert farthest_pair(points) == references.farthest_pair(points.tolist())


@pytest.mark.parametrize(
    "mesh",
    [shapes.sphere(2), shapes.box(2, 2, 2), shapes.disc(40), shapes.bent_capsule()],
    ids=["sphere", "box", "disc", "capsule"],
)
def test_the_pair_is_that_of_brute_force_on_round_and_regular_shapes(mesh):
    points = mesh[0]
    assert farthest_pair(points) == references.farthest_pair(points.tolist())


@pytest.mark.parametrize("size", [1, 2, 7])
def test_points_that_all_coincide(size):
    assert farthest_pair(np.full((size, 3), 0.1)) == (0, 0)


def test_the_order_of_the_points_decides_only_among_equal_pairs():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert farthest_pair(points) == (0, 2)
    assert farthest_pair(points[[3, 0, 1, 2]]) == (0, 2)
    assert farthest_pair(np.vstack([points, [[5.0, 0, 0]]])) == (3, 4)
