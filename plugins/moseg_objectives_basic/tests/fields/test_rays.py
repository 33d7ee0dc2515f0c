from __future__ import annotations

import numpy as np
import pytest
from moseg_objectives_basic.fields.rays import Frames, Rays, outsides, outward_normals
from scipy.spatial.transform import Rotation

from moseg_core import Shape


def sides_of(shape):
    elements = np.arange(shape.n_elements)
    return outsides(shape, elements, Rays(shape), Frames.of(shape, elements))


def test_rays_in_a_box_are_as_long_as_it(make):
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7])
    shape = Shape.from_mesh(*make.moved(make.box(3, 2, 1), turn=turn, scale=40, shift=[7, 8, 9]))
    frames = Frames.of(shape, np.arange(6))
    lengths = Rays(shape).lengths(frames.origins, -frames.normals) * shape.box_diagonal
    assert lengths == pytest.approx([120, 120, 80, 80, 40, 40], rel=1e-5)
    assert np.isinf(Rays(shape).lengths(frames.origins, frames.normals)).all()
    assert np.isinf(Rays(shape).lengths(frames.origins, 0 * frames.normals)).all()


def test_frames_stand_on_the_largest_triangle(make):
    corners = [[0, 0, 0], [9, 0, 0], [9, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]]  # an L
    shape = Shape.from_mesh(corners, [[0, 1, 2, 3, 4, 5]])
    frames = Frames.of(shape, np.array([0]))
    triangles = shape.frame.to_unit(shape.geometry.vertices)[shape.geometry.triangles]
    areas = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    assert frames.origins[0] == pytest.approx(triangles[areas.argmax()].mean(axis=0))
    assert frames.normals.tolist() == [[0, 0, 1]]
    assert abs(frames.sides[0] @ frames.normals[0]) < 1e-12


@pytest.mark.parametrize("flipped", ["none", "all", "some"])
def test_the_outside_is_found_however_faces_are_oriented(make, flipped):
    vertices, faces = make.ball(2)
    turned = (
        np.random.default_rng(0).random(len(faces)) < {"none": 0, "all": 1, "some": 0.4}[flipped]
    )
    faces = np.where(turned[:, None], faces[:, ::-1], faces)
    sides = sides_of(Shape.from_mesh(vertices, faces))
    assert (sides == np.where(turned, -1, 1)).all()


def test_a_cavity_is_outside(make):
    vertices, faces = make.ball(2)
    joined = np.concatenate([faces, faces[:, ::-1] + len(vertices)])
    hollow = Shape.from_mesh(np.concatenate([vertices, vertices * 0.5]), joined)
    assert (sides_of(hollow) == 1).all()
    # The ball says that faces are turned inside out, and the cavity, which cannot tell, follows.
    inside_out = Shape.from_mesh(np.concatenate([vertices, vertices * 0.5]), joined[:, ::-1])
    assert (sides_of(inside_out) == -1).all()


@pytest.mark.parametrize("inside_out", [False, True])
def test_outward_normals_of_polygons(make, inside_out):
    vertices, faces = make.box(3, 2, 1)
    shape = Shape.from_mesh(vertices, [face[::-1] for face in faces] if inside_out else faces)
    normals = outward_normals(shape)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(6))
    assert ((normals * shape.points).sum(axis=1) > 0).all()


def test_a_sheet_keeps_the_side_of_its_file(make):
    vertices, faces = make.rectangle(2, 1)
    assert outward_normals(Shape.from_mesh(vertices, faces)).tolist() == [[0, 0, 1]]
    assert outward_normals(Shape.from_mesh(vertices, [faces[0][::-1]])).tolist() == [[0, 0, -1]]


def test_rays_meet_triangles_however_small(make):
    """A speck whose triangles have sides of a hundred-thousandth of the diagonal."""
    vertices, faces = make.ball(2)
    speck = vertices * 3e-5 + [1, 0, 0]
    far = np.array([[-1.0, -0.5, 0], [-1, 0.5, 0], [-1, 0, 0.5]])
    shape = Shape.from_mesh(
        np.concatenate([speck, far]),
        [*faces.tolist(), [len(speck), len(speck) + 1, len(speck) + 2]],
    )
    elements = np.arange(len(faces))
    frames = Frames.of(shape, elements)
    found = Rays(shape).lengths(frames.origins, -frames.normals) * shape.box_diagonal
    assert found == pytest.approx(6e-5, rel=0.1)
