"""Winding numbers: known answers, and the sum over all pieces taken literally."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.winding_tree import WindingTree
from tests import shapes


def literal(corners, queries):
    """Van Oosterom and Strackee, triangle by triangle."""
    total = np.zeros(len(queries))
    for triangle in corners:
        a, b, c = (corner - queries for corner in triangle)
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        above = np.einsum("qi,qi->q", a, np.cross(b, c))
        below = la * lb * lc
        for (p, q), length in (((a, b), lc), ((b, c), la), ((c, a), lb)):
            below = below + np.einsum("qi,qi->q", p, q) * length
        total += 2 * np.arctan2(above, below)
    return total / (4 * np.pi)


def tree_of(mesh):
    return WindingTree.of(PolygonMesh.from_faces(*mesh))


@given(seed=st.integers(0, 1000), n=st.integers(1, 40))
@settings(max_examples=30)
def test_an_exact_sum_of_any_soup(seed, n):
    vertices, faces = shapes.soup(seed, n)
    queries = np.random.default_rng(seed).uniform(-1.5, 1.5, (20, 3))
    found = tree_of((vertices, faces)).winding(queries, np.inf)
    np.testing.assert_allclose(found, literal(vertices[np.array(faces)], queries), atol=1e-9)


@pytest.mark.parametrize("mesh", [shapes.cube(), shapes.sphere(2), shapes.tee(), shapes.prism()])
def test_inside_is_1_and_outside_0(mesh):
    tree = tree_of(mesh)
    middle = mesh[0].mean(axis=0)
    size = np.ptp(mesh[0], axis=0).max()
    out = middle + 2 * size * np.random.default_rng(0).normal(size=(10, 3))
    assert np.abs(tree.winding(out, np.inf)).max() < 1e-9
    inside = mesh[0][mesh[1][0][0]] * 0.99 + 0.01 * middle  # behind a corner of a convex place
    expected = literal(tree.corners, inside[None])
    np.testing.assert_allclose(tree.winding(inside[None], np.inf), expected, atol=1e-9)
    assert expected[0] == pytest.approx(1.0) or expected[0] == pytest.approx(0.0, abs=1e-9)


def test_a_hemisphere_winds_half_around_its_middle():
    vertices, faces = shapes.sphere(4)
    upper = [face for face in faces if vertices[list(face)].mean(axis=0)[2] > 0]
    winding = tree_of((vertices, upper)).winding(np.zeros((1, 3)), np.inf)
    assert winding[0] == pytest.approx(0.5, abs=0.01)


def test_points_are_dipoles():
    rng = np.random.default_rng(2)
    points, normals, areas = rng.normal(size=(30, 3)), rng.normal(size=(30, 3)), rng.random(30)
    tree = WindingTree.of(PointCloud.from_points(points, normals=normals, areas=areas))
    query = rng.normal(size=(5, 3))
    apart = points - query[:, None]
    unit = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    squared = (apart**2).sum(axis=2) + 0.01 * areas
    expected = (areas * (apart * unit).sum(axis=2) / squared**1.5).sum(axis=1) / (4 * np.pi)
    np.testing.assert_allclose(tree.winding(query, np.inf), expected, rtol=1e-9)
    at_a_point = tree.winding(points[:1], np.inf)
    assert np.isfinite(at_a_point).all()
