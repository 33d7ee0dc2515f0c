"""Thickness against closed forms, whatever the orientation, and the same in every run."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.fields import thickness as module
from moseg_objectives_basic.fields.thickness import log_thickness, thickness
from scipy.spatial.transform import Rotation

from moseg_core import Shape

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def fine(mesh, edge):
    return trimesh.remesh.subdivide_to_size(mesh.vertices, mesh.faces, edge)


def lengths(shape):
    """In model units."""
    return thickness(shape) * shape.box_diagonal


def test_a_plate_is_as_thick_as_it_is(make):
    shape = Shape.from_mesh(*fine(trimesh.creation.box((4, 3, 0.2)), 0.3))
    inner = (np.abs(shape.points) < [1.8, 1.3, 1]).all(axis=1)
    assert lengths(shape)[inner] == pytest.approx(0.2 / np.cos(np.pi / 8), rel=1e-3)


def test_a_cylinder_is_about_as_thick_as_its_diameter():
    shape = Shape.from_mesh(*fine(trimesh.creation.cylinder(0.5, 6, sections=48), 0.4))
    inner = np.abs(shape.points[:, 2]) < 2
    assert lengths(shape)[inner] == pytest.approx(1.0, rel=0.08)


@pytest.mark.parametrize("flipped", ["none", "all", "some"])
def test_a_ball_is_about_as_thick_as_its_diameter(make, flipped):
    vertices, faces = make.ball(3)
    turned = (
        np.random.default_rng(0).random(len(faces)) < {"none": 0, "all": 1, "some": 0.4}[flipped]
    )
    shape = Shape.from_mesh(vertices, np.where(turned[:, None], faces[:, ::-1], faces))
    assert lengths(shape) == pytest.approx(2 * np.cos(np.pi / 8), rel=0.01)


def test_the_wall_around_a_cavity(make):
    vertices, faces = make.ball(3)
    both = np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    shape = Shape.from_mesh(np.concatenate([vertices, vertices * 0.8]), both)
    assert lengths(shape) == pytest.approx(0.2 * 1.07, rel=0.05)


def test_an_open_surface_has_a_value_everywhere(make):
    vertices, faces = make.ball(3)
    bowl = Shape.from_mesh(vertices, faces[vertices[faces].mean(axis=1)[:, 2] > -0.3])
    assert ((lengths(bowl) > 0.8) & (lengths(bowl) <= 2)).all()
    assert thickness(Shape.from_mesh(*make.rectangle(2, 1))).tolist() == [1.0]
    soup = vertices[faces[:40]].reshape(-1, 3)
    apart = Shape.from_mesh(
        soup * 2.0 + np.repeat(np.arange(40), 3)[:, None], np.arange(120).reshape(-1, 3)
    )
    assert (thickness(apart) > 0).all()


def test_faces_without_area_have_the_value_of_their_neighbours(make):
    vertices, faces = make.ball(2)
    shape = Shape.from_mesh(vertices, [*faces.tolist(), [3, 3, 7]])
    assert thickness(shape)[-1] in thickness(shape)[:-1]


def test_motion_size_and_reflection_change_nothing(make):
    vertices, faces = make.ball(2)
    vertices = vertices * [3, 2, 1] + 0.2 * np.sin(4 * vertices[:, [1, 2, 0]])
    before = thickness(Shape.from_mesh(vertices, faces))
    moved = make.moved((vertices, faces), turn=GENERIC, scale=30, shift=[40, 50, 60])
    assert thickness(Shape.from_mesh(*moved)) == pytest.approx(before, rel=1e-5)
    assert log_thickness(Shape.from_mesh(*moved)) == pytest.approx(np.log(before), abs=1e-5)
    mirrored = Shape.from_mesh(vertices * [1, -1, 1], faces[:, ::-1])
    assert thickness(mirrored) == pytest.approx(before, rel=1e-5)


def test_the_logarithm_of_the_thickness(make):
    shape = Shape.from_mesh(*make.ball(3))
    across = 2 * np.cos(np.pi / 8) / shape.box_diagonal
    found = log_thickness(shape)
    assert found == pytest.approx(np.log(across), abs=0.01)
    assert found == pytest.approx(np.log(thickness(shape)), abs=1e-12)
    sheet = Shape.from_mesh(*make.rectangle(2, 1))
    assert log_thickness(sheet).tolist() == [0.0]


def test_large_shapes_are_looked_at_in_some_places(make, monkeypatch):
    vertices, faces = make.ball(4)
    shape = Shape.from_mesh(vertices * [3, 2, 1], faces)
    exact = thickness(shape)
    monkeypatch.setattr(module, "_MOST", 1000)
    rough = thickness(shape)
    assert len(set(rough.tolist())) <= 1000
    error = np.abs(rough / exact - 1)
    assert np.median(error) < 0.03
    assert (rough @ shape.areas) == pytest.approx(exact @ shape.areas, rel=0.01)


def test_the_same_to_the_last_bit_in_another_process():
    code = (
        "import moseg_core as m, hashlib;"
        "v = m.field_values(m.load(m.sample_path('hammer')), 'basic:thickness');"
        "print(hashlib.sha256(v.tobytes()).hexdigest())"
    )
    runs = [
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        for _ in range(2)
    ]
    assert runs[0].stdout == runs[1].stdout != ""
