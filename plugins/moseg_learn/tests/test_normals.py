"""Normals point outward, however a file orients its components."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_learn.normals import outward_normals

from moseg_core import Shape


@pytest.mark.parametrize("turned", [(), (0,), (1,), (0, 1)])
def test_of_two_balls_of_which_the_file_turns_some(turned):
    ball = trimesh.creation.icosphere(subdivisions=2)
    faces = [ball.faces[:, ::-1] if k in turned else ball.faces for k in range(2)]
    centers = np.array([[0.0, 0, 0], [5, 1, 0]])
    shape = Shape.from_mesh(
        np.concatenate([ball.vertices + center for center in centers]),
        np.concatenate([faces[0], faces[1] + len(ball.vertices)]),
    )
    away = shape.points - np.repeat(centers, len(ball.faces), axis=0)
    away /= np.linalg.norm(away, axis=1)[:, None]
    assert (outward_normals(shape) * away).sum(axis=1).min() > 0.99


def test_of_a_bowl_the_convex_side_is_the_outside():
    ball = trimesh.creation.icosphere(subdivisions=2)
    bowl = ball.faces[ball.vertices[ball.faces].mean(axis=1)[:, 2] < -0.2]
    for faces in (bowl, bowl[:, ::-1]):
        shape = Shape.from_mesh(ball.vertices, faces)
        assert (outward_normals(shape) * shape.points).sum(axis=1).min() > 0.9


def test_polygons_and_what_has_no_area():
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]]
    faces = [[0, 3, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 1, 1]]
    found = outward_normals(Shape.from_mesh(corners, faces))
    assert found[0] == pytest.approx([0, 0, -1])
    assert found[1] == pytest.approx([0, -1, 0])
    assert np.linalg.norm(found[:5], axis=1) == pytest.approx(1)
    assert found[5].tolist() == [0, 0, 0]
