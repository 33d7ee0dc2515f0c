"""Shapes: elements, areas, moments, frames, notes, and what is refused."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Frame, Shape
from tests import shapes
from tests.references import triangle_moments

INDICES = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]


@pytest.mark.parametrize(
    "mesh",
    [shapes.prism(6), shapes.tee(3, 3), shapes.disc(5), shapes.bent_capsule(6, 5)],
    ids=["prism", "tee", "disc", "capsule"],
)
def test_each_element_has_the_moments_of_its_own_triangles(mesh):
    vertices, faces = shapes.jitter(mesh, 1, 0.1)
    vertices = vertices + 7.0
    shape = Shape.from_mesh(vertices, faces)
    center = shape.frame.center
    assert shape.n_elements == len(faces)
    for f in range(shape.n_elements):
        own = shape.geometry.triangles[shape.geometry.triangle_polygon == f]
        assert set(own.reshape(-1).tolist()) == set(faces[f])
        area, mean, covariance = triangle_moments(vertices[own].tolist())
        second = area * (np.array(covariance) + np.outer(mean - center, mean - center))
        assert shape.areas[f] == pytest.approx(area, rel=1e-12)
        assert shape.points[f] == pytest.approx(mean, rel=1e-12)
        assert shape.first_moments[f] == pytest.approx(area * (mean - center), abs=1e-12)
        assert shape.second_moments[f] == pytest.approx(
            [second[i, j] for i, j in INDICES], abs=1e-12
        )


def test_a_trimesh_object_is_a_mesh():
    ball = trimesh.creation.icosphere(subdivisions=1)
    shape = Shape.from_mesh(ball, name="ball")
    assert shape.area == pytest.approx(ball.area)
    assert shape.volume == pytest.approx(ball.volume)
    assert np.allclose(shape.points, ball.triangles_center)
    assert shape.name == "ball"


@pytest.mark.parametrize("given_", ["ball", np.eye(3), None])
def test_vertices_alone_are_not_a_mesh(given_):
    with pytest.raises(ShapeError, match="from_mesh takes vertices and faces"):
        Shape.from_mesh(given_)


@given(st.integers(0, 2**32), st.floats(1e-3, 1e3), st.floats(-50, 50))
@settings(max_examples=25, deadline=None)
def test_unit_coordinates_are_centred_and_have_a_diagonal_of_1(seed, scale, shift):
    mesh = shapes.moved(shapes.bent_capsule(5, 4), shapes.rotation(seed), scale, [shift, 0, -shift])
    shape = Shape.from_mesh(*mesh)
    corners = shape.frame.to_unit(mesh[0])
    assert np.linalg.norm(np.ptp(corners, axis=0)) == pytest.approx(1.0, rel=1e-12)
    assert corners.min(axis=0) + corners.max(axis=0) == pytest.approx([0, 0, 0], abs=1e-9)
    there_and_back = shape.frame.to_model(corners)
    assert there_and_back == pytest.approx(mesh[0], rel=1e-12, abs=1e-12 * scale)
    assert (shape.unit_points == shape.frame.to_unit(shape.points)).all()


def test_vertices_that_no_face_uses_do_not_count():
    vertices, faces = shapes.cube()
    shape = Shape.from_mesh(np.vstack([vertices, [[100.0, 0, 0]]]), faces)
    assert shape.frame.scale == pytest.approx(3**0.5)
    assert shape.box_diagonal == pytest.approx(Shape.from_mesh(vertices, faces).box_diagonal)
    assert shape.notes == ()


def test_the_box_diagonal_does_not_depend_on_the_axes_of_the_file():
    mesh = shapes.box(4, 2, 1)
    expected = 21**0.5
    assert Shape.from_mesh(*mesh).box_diagonal == pytest.approx(expected, rel=1e-12)
    diagonals = set()
    for seed in range(6):
        turned = Shape.from_mesh(*shapes.moved(mesh, shapes.rotation(seed), 2.0, [9, 9, 9]))
        assert turned.box_diagonal == pytest.approx(2 * expected, rel=1e-12)
        diagonals.add(round(turned.frame.scale, 3))
    assert len(diagonals) == 6  # unlike that of the box in the file's axes


def test_what_was_noticed_is_said():
    assert Shape.from_mesh(*shapes.cube()).notes == ()
    two = Shape.from_mesh(*shapes.two_boxes())
    assert two.notes == ("the surface has 2 connected components",)
    assert two.volume == pytest.approx(4.0)

    vertices, faces = shapes.cube_without_lid()
    torn = np.vstack([vertices, vertices[[0, 1]]])
    shape = Shape.from_mesh(torn, [*faces[:-1], faces[-1], (8, 9, 9)])
    assert shape.volume is None
    assert shape.volume_reason == "it is open (4 boundary edges)"
    assert set(shape.notes) == {
        "2 duplicate vertices, joined by position",
        "1 faces have no area; they take part and carry no weight",
        "encloses no volume: it is open (4 boundary edges)",
    }


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (np.zeros((3, 3)), [(0, 1, 2)]),
        ([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [(0, 1, 2)]),
        ([[0, 0, 0], [1, 0, 0], [2, 1e-15, 0]], [(0, 1, 2)]),
        (np.full((4, 3), 5.0), [(0, 1, 2), (1, 2, 3)]),
    ],
    ids=["a point", "a line", "a needle", "coincident"],
)
def test_a_shape_without_area_is_refused(vertices, faces):
    with pytest.raises(ShapeError, match=f"all {len(faces)} faces are degenerate"):
        Shape.from_mesh(vertices, faces)


def test_a_face_without_area_stands_at_the_mean_of_its_corners():
    vertices = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [6, 0, 0]]
    shape = Shape.from_mesh(vertices, [(0, 1, 2), (0, 1, 3), (1, 1, 1, 1)])
    assert shape.areas.tolist() == [4.5, 0.0, 0.0]
    assert shape.points.tolist() == [[1, 1, 0], [3, 0, 0], [3, 0, 0]]
    assert np.isfinite(shape.second_moments).all()


def test_the_fingerprint_is_that_of_the_geometry():
    vertices, faces = shapes.prism(5)
    one = Shape.from_mesh(vertices, faces, name="one")
    assert one.fingerprint == Shape.from_mesh(vertices.copy(), faces, name="two").fingerprint
    others = [
        Shape.from_mesh(*shapes.jitter((vertices, faces), 1, 1e-9)),
        Shape.from_mesh(vertices, faces[::-1]),
        Shape.from_mesh(*shapes.fan((vertices, faces))),
    ]
    assert len({one.fingerprint, *(other.fingerprint for other in others)}) == 4


def test_a_shape_is_made_once_and_for_all():
    shape = Shape.from_mesh(*shapes.cube())
    with pytest.raises(dataclasses.FrozenInstanceError):
        shape.name = "other"
    with pytest.raises(dataclasses.FrozenInstanceError):
        Frame(np.zeros(3), 1.0).scale = 2.0
    mesh = PolygonMesh.from_faces(*shapes.cube())
    assert Shape.from_polygon_mesh(mesh).geometry is mesh


def test_what_a_reader_says_comes_first_and_stays():
    said = ("one line was passed over",)
    mesh = Shape.from_mesh(*shapes.cube(), notes=said)
    assert mesh.notes == said
    assert mesh.with_volume("hull").notes[0] == said[0]
    assert Shape.from_points(np.eye(3), notes=iter(said)).notes[0] == said[0]
    grid = Shape.from_voxels(np.ones((2, 2, 2), bool), notes=said)
    assert grid.notes == grid.with_elements("surface").notes == said


def test_in_other_units_vertices_are_joined_within_the_same_share():
    crack = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1e-9, 0], [0, 1, 0], [1, 1, 0]])
    shape = Shape.from_mesh(crack, [[0, 1, 2], [3, 5, 4]])
    for scale in (1e-9, 1e9):
        mesh = shape.deformed(scale * crack, space="other").geometry
        np.testing.assert_array_equal(mesh.merged, shape.geometry.merged)
        assert mesh.tolerance == pytest.approx(scale * shape.geometry.tolerance)


def test_what_is_noted_of_joined_vertices_is_about_those_of_faces():
    crack = [[0, 0, 0], [300, 0, 0], [0, 400, 0], [300, 3e-6, 0], [0, 400, 0], [300, 400, 0]]
    idle = [[300, 2e-6, 0], [0, 0, 0], [0, 0, 0]]
    shape = Shape.from_mesh([*idle, *crack], [[3, 4, 5], [6, 8, 7]])
    assert shape.notes[:2] == (
        "1 duplicate vertex, joined by position",
        "1 vertex less than 5e-06 from another, joined with it (--weld 0 joins equal ones only)",
    )
