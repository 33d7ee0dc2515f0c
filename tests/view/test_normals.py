"""Normals for shading: shared across soft edges, broken at creases and between parts."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.normals import corner_normals

SIZE = (480, 240)


def polygons(mesh):
    return PolygonMesh.from_faces(np.array(mesh.vertices), np.array(mesh.faces))


def roof(bend, *, other=(2, 1, 3)):
    """Two faces along an edge, bent by an angle in degrees."""
    c, s = np.cos(np.radians(bend)), np.sin(np.radians(bend))
    points = [[-1, 0.5, 0], [0, 0, 0], [0, 1, 0], [c, 0.5, -s]]
    return PolygonMesh.from_faces(points, [[0, 1, 2], list(other)])


def flat_normals(mesh):
    a, b, c = np.swapaxes(mesh.vertices[mesh.triangles], 0, 1)
    normals = np.cross(b - a, c - a)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_normals_are_shared_across_a_soft_edge():
    mesh = roof(30)
    normals = corner_normals(mesh, np.array([0, 0]))
    middle = flat_normals(mesh).sum(axis=0)
    middle /= np.linalg.norm(middle)
    for normal in (normals[0, 1], normals[0, 2], normals[1, 0], normals[1, 1]):
        np.testing.assert_allclose(normal, middle, atol=1e-12)
    np.testing.assert_allclose(normals[0, 0], flat_normals(mesh)[0], atol=1e-12)
    np.testing.assert_allclose(normals[1, 2], flat_normals(mesh)[1], atol=1e-12)


@pytest.mark.parametrize(
    ("mesh", "labels"),
    [
        pytest.param(roof(50), [0, 0], id="crease"),
        pytest.param(roof(30), [0, 1], id="two parts"),
        pytest.param(roof(30, other=(1, 2, 3)), [0, 0], id="wound against each other"),
        pytest.param(roof(165, other=(1, 2, 3)), [0, 0], id="folded back, wound alike"),
    ],
)
def test_normals_are_not_shared(mesh, labels):
    normals = corner_normals(mesh, np.array(labels))
    expected = np.repeat(flat_normals(mesh)[:, None], 3, axis=1)
    np.testing.assert_allclose(normals, expected, atol=1e-12)


def test_normals_of_a_ball_are_radial():
    ball = polygons(trimesh.creation.icosphere(subdivisions=3))
    normals = corner_normals(ball, np.zeros(len(ball.triangles), np.int64))
    radial = ball.vertices[ball.triangles]
    assert (np.einsum("tki,tki->tk", normals, radial) > np.cos(np.radians(2))).all()


def test_normals_do_not_depend_on_shared_vertices():
    # As an STL file has it: every face with vertices of its own.
    ball = trimesh.creation.icosphere(subdivisions=2)
    labels = np.zeros(len(ball.faces), np.int64)
    soup = PolygonMesh.from_faces(
        np.array(ball.triangles).reshape(-1, 3), np.arange(3 * len(ball.faces)).reshape(-1, 3)
    )
    np.testing.assert_allclose(
        corner_normals(soup, labels), corner_normals(polygons(ball), labels), atol=1e-12
    )


def test_normals_around_an_edge_of_three_faces_are_flat():
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [0, 1, 0], [1, 0, 0.1], [-1, 0, 0.1], [1, 0, 0.3]],
        [[0, 2, 1], [1, 3, 0], [0, 4, 1]],
    )
    normals = corner_normals(mesh, np.zeros(3, np.int64))
    expected = np.repeat(flat_normals(mesh)[:, None], 3, axis=1)
    np.testing.assert_allclose(normals, expected, atol=1e-12)


def test_faces_without_area_have_unit_normals_too():
    mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2], [0, 0, 0]])
    normals = corner_normals(mesh, np.zeros(2, np.int64))
    np.testing.assert_allclose(np.linalg.norm(normals, axis=2), 1.0)
