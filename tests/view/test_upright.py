"""Which way is up where nobody says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.upright import find_standing, mirror_errors
from tests.view.test_camera import ANIMAL, boxes

TABLE = boxes(
    ([4, 3, 0.2], [0, 0, 2]),
    *(([0.2, 0.2, 2], [x, y, 1]) for x in (-1.8, 1.8) for y in (-1.3, 1.3)),
)


def mesh_of(vertices, faces):
    return PolygonMesh.from_faces(vertices, np.asarray(faces))


def test_what_is_known_is_taken():
    found = find_standing(mesh_of(*TABLE), "-x")
    assert (found.said, found.up.tolist()) == ("up: -x", [-1, 0, 0])


@pytest.mark.parametrize("thing", [TABLE, ANIMAL], ids=["table", "animal"])
@pytest.mark.parametrize("up", ["y", "z"])
def test_what_has_feet_stands_on_them(thing, up):
    vertices, faces = thing
    vertices = vertices if up == "z" else vertices[:, [1, 2, 0]]
    found = find_standing(mesh_of(vertices, faces), None)
    assert (found.said, found.axis) == (f"up: {up}, guessed", up)


def test_what_lies_askew_stands_on_no_axis_of_the_file():
    vertices, faces = TABLE
    turn = Rotation.from_euler("xyz", [35, 25, 50], degrees=True).as_matrix()
    found = find_standing(mesh_of(vertices @ turn.T, faces), None)
    assert found.said == "up: no axis of the file, guessed"
    assert np.abs(found.up @ turn).max() > 0.99  # along an axis of its own


def test_samples_stand_as_their_makers_meant():
    for name in ("horse", "octopus", "bulldog"):
        shape = moseg.load(moseg.sample_path(name))
        assert find_standing(shape.geometry, None).axis == "y", name


def test_size_and_place_do_not_matter():
    mesh = mesh_of(*TABLE)
    for factor, shift in ((1e-9, 0), (1e9, 3e10)):
        moved = replace(mesh, vertices=mesh.vertices * factor + shift)
        assert find_standing(moved, None).axis == "z"


def test_a_mirror_image_is_measured():
    vertices, faces = ANIMAL
    along, across, upright = mirror_errors(vertices[faces], np.eye(3))
    assert across < 1
    assert along > 2
    assert upright > 2


@pytest.mark.parametrize(
    "vertices",
    [[[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[3, 3, 3]] * 3],
    ids=["flat", "a line", "a point"],
)
def test_odd_shapes_stand_somehow(vertices):
    mesh = PolygonMesh.from_faces(vertices, [[0, 1, 2]])
    up = find_standing(mesh, None).up
    assert np.linalg.norm(up) == pytest.approx(1)
