"""Boundaries from distances alone: against the closed form where there is one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.clipping.bisector import Bisectors
from moseg_core.clipping.boundaries import DistanceField
from moseg_core.clipping.clip import clip_along, clip_boundaries
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.clipping.checks import assert_valid, weighted


def both(seed, n):
    """The bisectors of random centres, and the same boundaries known by distances only."""
    rng = np.random.default_rng(seed)
    exact = Bisectors(rng.uniform(-1, 1, (n, 3)), rng.uniform(0.5, 2.0, n))
    return exact, DistanceField(lambda points: weighted(points, exact.centers, exact.weights))


@given(seed=st.integers(0, 10_000))
@settings(max_examples=50)
def test_crossings_are_those_of_bisectors(seed):
    exact, field = both(seed, 2)
    ends = np.random.default_rng(seed + 1).uniform(-2, 2, (40, 2, 3))
    near = field.distances(ends.reshape(-1, 3)).argmin(axis=1).reshape(-1, 2)
    ends = ends[(near == [0, 1]).all(axis=1)]
    zero = np.zeros(len(ends), np.int64)
    given = (ends[:, 0], ends[:, 1], zero, zero + 1)
    np.testing.assert_allclose(field.crossing(*given), exact.crossing(*given), atol=1e-9)


def test_junctions_within_triangles_are_those_of_bisectors():
    sought = missed = 0
    for seed in range(60):
        exact, field = both(seed, 3)
        corners = np.random.default_rng(seed + 1).uniform(-1, 1, (20, 3, 3))
        triples, start = np.tile([0, 1, 2], (20, 1)), np.full((20, 3), 1 / 3)
        known = exact.junction(corners, triples, start)
        inside = np.isfinite(known).all(axis=1) & (known > 0.0).all(axis=1)
        shares = field.junction(corners[inside], triples[inside], start[inside])
        found = np.isfinite(shares).all(axis=1)
        points = np.einsum("tk,tkd->td", shares[found], corners[inside][found])
        np.testing.assert_allclose(np.ptp(field.distances(points), axis=1), 0.0, atol=1e-6)
        sought, missed = sought + len(found), missed + int((~found).sum())
    assert sought > 50
    assert missed <= 0.03 * sought  # where Newton's method ends nowhere, a face has another middle


def test_there_is_no_junction_where_three_parts_never_meet():
    # Three centres in a row have parallel bisectors.
    row = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    field = DistanceField(lambda points: np.linalg.norm(points[:, None] - row, axis=2))
    triangle = np.array([[[0.0, 0, 0], [2, 0, 0], [1, 1, 0]]])
    found = field.junction(triangle, np.array([[0, 1, 2]]), np.full((1, 3), 1 / 3))
    assert not ((found > 0.0) & (found < 1.0)).all()


def test_nobody_is_asked_about_no_points():
    field = DistanceField(lambda points: pytest.fail("asked"))
    none = np.empty((0, 3))
    assert field.crossing(none, none, np.empty(0, int), np.empty(0, int)).shape == (0,)
    corners, triples = np.empty((0, 3, 3)), np.empty((0, 3), int)
    assert field.junction(corners, triples, none).shape == (0, 3)


def test_a_mesh_is_clipped_as_along_bisectors():
    shape = Shape.from_mesh(*shapes.jitter(shapes.sphere(3), 4, 0.01))
    exact, field = both(5, 3)
    labels = field.distances(shape.points).argmin(axis=1)
    assert set(labels) == {0, 1, 2}
    mesh = shape.geometry
    known = clip_boundaries(mesh, labels, shape.points, exact.centers, exact.weights)
    found = clip_along(mesh, labels, shape.points, field, n_parts=3)
    assert (found.labels == known.labels).all()
    assert (found.source == known.source).all()
    np.testing.assert_allclose(found.mesh.vertices, known.mesh.vertices, atol=1e-7)
    assert_valid(mesh, labels, found)
