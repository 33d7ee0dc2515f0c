"""Parts as rigid bodies: masses, inertias, hulls and names, against closed forms."""

from __future__ import annotations

import io
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from moseg_robotics.bodies import (
    MOST_VERTICES,
    bodies_of,
    mesh_files,
    number,
    turn_upright,
)
from trimesh.transformations import euler_matrix

from moseg_core import Shape, UsageError

PLACE = np.array([1000.0, 0.0, 50.0])


def cuboid_inertia(x, y, z):
    """Of a box of density 1 about its middle."""
    return x * y * z / 12.0 * np.diag([y * y + z * z, x * x + z * z, x * x + y * y])


def test_mass_and_inertia_are_those_of_the_closed_parts(mallet):
    root, (handle, head) = bodies_of(mallet, root="mallet")
    assert root == "mallet"
    assert (handle.name, head.name) == ("handle", "head")
    for body, size, middle in ((handle, (4, 1, 1), -2.5), (head, (1, 1, 3), 0.0)):
        assert body.solid
        assert body.mass == pytest.approx(np.prod(size))
        assert body.center == pytest.approx(PLACE + np.array([middle, 0.0, 0.0]))
        assert body.inertia == pytest.approx(cuboid_inertia(*size), abs=1e-6)
        assert body.hull.volume == pytest.approx(np.prod(size))
        assert len(body.hull.vertices) == 8
        assert not body.surface.is_watertight
        assert body.remark == "mass of the part, its cuts capped; hull of 8 vertices"


def test_meshes_are_about_the_middle_and_lose_nothing(mallet):
    _, bodies = bodies_of(mallet, root="mallet")
    files = mesh_files(bodies, "m_meshes")
    assert sorted(files) == [
        "m_meshes/handle.obj", "m_meshes/handle_hull.stl",
        "m_meshes/head.obj", "m_meshes/head_hull.stl",
    ]  # fmt: skip
    hull = trimesh.load(io.BytesIO(files["m_meshes/handle_hull.stl"]), file_type="stl")
    assert hull.is_watertight
    assert hull.bounds == pytest.approx(np.array([[-2, -0.5, -0.5], [2, 0.5, 0.5]]), abs=1e-6)
    seen = trimesh.load(io.BytesIO(files["m_meshes/head.obj"]), file_type="obj")
    assert seen.extents == pytest.approx([1, 1, 3])
    assert seen.area == pytest.approx(13.0)


def test_what_is_no_solid_weighs_as_its_hull(labelled):
    ball = trimesh.creation.icosphere(subdivisions=3)
    dots = Shape.from_points(np.array(ball.vertices), name="dots")
    _, (low, high) = bodies_of(labelled(dots, ball.vertices[:, 2] > 0, "low", "high"), root="dots")
    assert not low.solid
    assert low.mass == pytest.approx(low.hull.volume)
    assert len(high.hull.vertices) <= MOST_VERTICES
    assert high.shortfall > 0
    assert "mass of the hull; hull of 64 vertices; the part sticks out by 0.0" in high.remark
    assert len(low.surface.faces) == len(low.hull.faces)
    corners = [[x, y, 0] for x in (0, 1, 2) for y in (0, 1)]
    sheet = Shape.from_mesh(corners, [[0, 2, 3, 1], [2, 4, 5, 3]])
    _, (flat,) = bodies_of(labelled(sheet, [0, 0], "sheet", "nothing"), root="sheet")
    assert not flat.solid
    assert flat.mass > 0
    assert np.linalg.eigvalsh(flat.inertia).min() > 0


def test_names_are_safe_and_differ(mallet):
    labels = ("../a <b>", "mallet")
    problem = SimpleNamespace(labels=labels)
    root, bodies = bodies_of(replace(mallet, problem=problem), root="mallet")
    assert [body.name for body in bodies] == ["a_-b", "mallet"]
    assert [body.hull_name for body in bodies] == ["a_-b-_hull", "mallet_hull"]
    assert root == "mallet-2"


def test_parts_of_one_point_have_no_bodies(labelled):
    dot = Shape.from_points([[0, 0, 0], [1, 0, 0]], areas=[1, 1], name="dot")
    with pytest.raises(UsageError, match="no part of 'dot' has an extent"):
        bodies_of(labelled(dot, [0, 1], "a", "b"), root="dot")


def test_numbers_are_short():
    assert number(1e-7, -2.50, 1 / 3) == "1e-07 -2.5 0.333333333333"


@pytest.mark.parametrize("up", ["x", "-x", "y", "-y", "z", "-z"])
def test_what_points_up_is_turned_to_z(up):
    axis = np.eye(3)["xyz".index(up[-1])] * (-1 if up[0] == "-" else 1)
    turned = euler_matrix(*turn_upright(up))[:3, :3] @ axis
    assert turned == pytest.approx([0, 0, 1])
