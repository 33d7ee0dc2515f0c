"""How shapes lie before a viewer, and cameras at which they fit the picture."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.view.camera import Camera, best_columns, choose_cameras, standing_axes
from moseg_core.view.views import USUAL, rotations_of


def boxes(*pieces):
    """A mesh of boxes, each an extent and a center."""
    meshes = []
    for extent, center in pieces:
        box = trimesh.creation.box(extent).subdivide().subdivide()
        meshes.append(box.apply_translation(center))
    joined = trimesh.util.concatenate(meshes)
    return np.array(joined.vertices), np.array(joined.faces)


# Length along x, height along z; the head is in front, at positive x.
ANIMAL = boxes(
    ([4, 1, 1], [0, 0, 0]),
    *(([0.3, 0.3, 2], [x, y, -1.5]) for x in (-1.8, 1.8) for y in (-0.35, 0.35)),
    ([0.5, 0.4, 0.8], [2, 0, 0.9]),
    ([1.2, 0.5, 0.5], [2.5, 0, 1.4]),
)


def turns():
    return st.integers(0, 10**6).map(lambda seed: Rotation.random(random_state=seed).as_matrix())


def mesh_of(vertices, faces):
    return PolygonMesh.from_faces(vertices, np.asarray(faces))


def views(vertices, faces, *, width=300, height=200, up=None, margin=0.05):
    mesh = mesh_of(vertices, faces)
    rotations = rotations_of(mesh, USUAL, up)
    return choose_cameras(mesh, rotations, width=width, height=height, margin=margin)


@settings(max_examples=60, deadline=None)
@given(
    vertices=hnp.arrays(np.float64, (9, 3), elements=st.floats(-1e6, 1e6, width=32)),
    width=st.integers(20, 900),
    height=st.integers(20, 900),
)
def test_any_shape_fits_both_pictures(vertices, width, height):
    faces = [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    for camera in views(vertices, faces, width=width, height=height):
        np.testing.assert_allclose(camera.rotation @ camera.rotation.T, np.eye(3), atol=1e-9)
        assert np.linalg.det(camera.rotation) > 0
        seen = camera.project(vertices)
        assert (seen[:, :2] >= -1e-6).all()
        assert (seen[:, :2] <= np.array([width, height]) + 1e-6).all()


def test_the_shape_fills_the_picture_up_to_the_margin():
    vertices, faces = ANIMAL
    for camera in views(*ANIMAL, width=400, height=900, margin=0.1):
        seen = camera.project(vertices[np.unique(faces)])
        assert seen[:, 0].min() == pytest.approx(40)
        assert seen[:, 0].max() == pytest.approx(360)
        assert seen[:, 1].min() + seen[:, 1].max() == pytest.approx(900)


def test_the_second_view_is_the_opposite_one():
    main, opposite = views(*ANIMAL)
    np.testing.assert_allclose(opposite.rotation[2], -main.rotation[2])
    np.testing.assert_allclose(opposite.rotation[1], main.rotation[1])
    assert opposite.scale == main.scale


def test_each_face_of_a_convex_shape_is_seen_in_one_view():
    sphere = trimesh.creation.icosphere(subdivisions=2)
    sphere.vertices *= [3.0, 2.0, 1.0]
    facing = [
        sphere.face_normals @ camera.rotation[2]
        for camera in views(np.array(sphere.vertices), sphere.faces)
    ]
    assert (np.maximum(*facing) > 0).all()


def test_three_faces_of_a_box_are_seen():
    main, _ = views(*boxes(([3, 2, 1], [0, 0, 0])))
    assert (np.abs(main.rotation[2]) > 0.25).all()


def test_the_longest_axis_lies_across():
    main, opposite = views(*boxes(([1, 5, 2], [0, 0, 0])))
    for camera in (main, opposite):
        across, up, _ = np.abs(camera.rotation @ [0, 1, 0])
        assert across > 0.8
        assert up < 0.3


@settings(max_examples=25, deadline=None)
@given(turn=turns())
def test_turning_the_input_changes_nothing(turn):
    vertices, faces = ANIMAL
    shift, factor = np.array([40.0, -7.0, 3.0]), 1.7
    for before, after in zip(
        views(vertices, faces), views(vertices @ turn.T * factor + shift, faces), strict=True
    ):
        expected = before.project(vertices)
        seen = after.project(vertices @ turn.T * factor + shift)
        np.testing.assert_allclose(seen, expected, atol=1e-3)


@settings(max_examples=25, deadline=None)
@given(turn=turns())
def test_an_animal_stands_on_its_feet(turn):
    vertices, faces = ANIMAL
    axes = standing_axes((vertices @ turn.T)[faces])
    upright = axes @ turn @ [0, 0, 1]
    # The feet are level to a degree, though the head makes the principal axes lean.
    assert upright[1] > np.cos(np.radians(1))


@settings(max_examples=25, deadline=None)
@given(turn=turns(), up=st.sampled_from([[0, 0, 1], [0, 1, 0], [0, -1, 0], [1, 0, 0]]))
def test_a_shape_stands_the_way_that_it_is_told_to(turn, up):
    vertices, faces = ANIMAL
    axes = standing_axes((vertices @ turn.T)[faces], turn @ up)
    np.testing.assert_allclose(axes @ turn @ up, [0, 1, 0], atol=1e-9)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) > 0
    # Of what is level the longest lies across.
    level = np.abs(axes @ turn @ [1, 0, 0])
    assert up[0] or level[0] > 0.9


def test_what_is_round_keeps_an_axis_of_the_file():
    sphere = trimesh.creation.icosphere(subdivisions=2)
    axes = standing_axes(np.array(sphere.vertices)[sphere.faces], np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(np.sort(np.abs(axes).ravel()), [0] * 6 + [1] * 3, atol=1e-9)


def test_views_are_in_as_many_columns_as_make_them_large():
    long, faces = boxes(([10, 1, 1], [0, 0, 0]))
    rotations = [np.eye(3)] * 4
    counts = [
        best_columns(mesh_of(long, faces), rotations, width=width, height=300)
        for width in (100, 1200, 4000, 12000)
    ]
    assert counts == [1, 2, 2, 4]


def test_a_mirror_image_is_not_shown_in_a_mirror():
    vertices, faces = ANIMAL
    flipped = vertices * [1, -1, 1]
    for points in (vertices, flipped):
        for camera in views(points, faces):
            assert np.linalg.det(camera.rotation) == pytest.approx(1)


def test_what_sticks_out_is_turned_towards_the_viewer():
    # A plate with a rod on one side: no hull side carries it along the second axis.
    vertices, faces = boxes(([6, 5, 0.5], [0, 0, 0]), ([0.4, 0.4, 2], [0, 0, -1]))
    axes = standing_axes(vertices[faces])
    assert axes[2] @ [0, 0, -1] > 0.9


@pytest.mark.parametrize(
    "vertices",
    [
        pytest.param([[0, 0, 0], [1, 0, 0], [0, 2, 0]], id="one triangle"),
        pytest.param([[0, 0, 0], [1, 1, 1], [2, 2, 2]], id="a line"),
        pytest.param([[5, 5, 5], [5, 5, 5], [5, 5, 5]], id="a point"),
        pytest.param([[1e200, 0, 0], [0, 1e200, 0], [0, 0, 3e200]], id="huge"),
        pytest.param([[1e-200, 0, 0], [0, 1e-200, 0], [0, 0, 3e-200]], id="tiny"),
        pytest.param([[1e9, 1e9, 1e9], [1e9 + 1, 1e9, 1e9], [1e9, 1e9 + 2, 1e9]], id="far away"),
    ],
)
def test_degenerate_shapes_are_seen_in_the_middle(vertices):
    for camera in views(np.array(vertices, np.float64), [[0, 1, 2]]):
        assert np.isfinite(camera.rotation).all()
        seen = camera.project(np.array(vertices, np.float64))
        middle = (seen.min(axis=0) + seen.max(axis=0))[:2] / 2
        np.testing.assert_allclose(middle, [150, 100], atol=1e-3)


def test_projection_by_hand():
    camera = Camera(
        rotation=np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]]),
        center=np.array([1.0, 2, 3]),
        scale=2.0,
        width=10,
        height=8,
    )
    # One to the right along y, two up along z, three towards the viewer along x.
    assert camera.project(np.array([[4.0, 3, 5]])).tolist() == [[7.0, 0.0, 6.0]]
