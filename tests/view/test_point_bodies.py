"""What is drawn of points, cells and faces, in pictures and scenes."""

from __future__ import annotations

import io

import numpy as np
import pytest
import trimesh
from PIL import Image

from moseg_core.io.write.glb import encode_glb
from moseg_core.shape.shape import Shape
from moseg_core.view.palette import part_colors
from moseg_core.view.picture import render_picture
from moseg_core.view.point_bodies import drawable
from tests import shapes


@pytest.fixture
def cloud():
    points = np.random.default_rng(1).normal(size=(2000, 3)) * [3, 1, 1]
    return Shape.from_points(points)


def test_meshes_and_grids_are_drawn_as_they_are(box):
    grid = Shape.from_voxels(np.ones((2, 2, 2), bool))
    for shape in (box, grid):
        assert drawable(shape.geometry) is shape.geometry


def test_octahedra_are_around_their_points_and_face_outward(cloud):
    drawn = drawable(cloud.geometry)
    corners = drawn.vertices[drawn.triangles]
    middle = cloud.points[drawn.triangle_polygon]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ti,ti->t", normals, corners.mean(axis=1) - middle) > 0).all()
    tips = drawn.vertices[drawn.corners].reshape(-1, 6, 3)
    np.testing.assert_allclose(tips.mean(axis=1), cloud.points, atol=1e-12)
    assert np.bincount(drawn.triangle_polygon).tolist() == [8] * 2000


def test_a_lonely_point_does_not_hide_the_others():
    points = np.concatenate([shapes.rectangle(nx=20, ny=7)[0], [[100.0, 0, 0]]])
    drawn = drawable(Shape.from_points(points).geometry)
    assert np.ptp(drawn.vertices[-6:], axis=0).max() < 2.0


@pytest.mark.parametrize("kind", ["cloud", "solid", "surface"])
def test_pictures_and_scenes_show_every_part(kind, cloud):
    shape = cloud
    if kind != "cloud":
        shape = Shape.from_voxels(np.ones((8, 3, 3), bool), elements=kind)
    labels = (shape.points[:, 0] > shape.points[:, 0].mean()).astype(int)
    names = ["near", "far"]
    drawn = drawable(shape.geometry)
    png = render_picture(drawn, labels, names, size=(400, 240), areas=shape.areas)
    hues = np.array(Image.open(io.BytesIO(png)).convert("HSV"))[:, :, 0]
    for color in part_colors(2):
        hue = np.array(Image.new("RGB", (1, 1), tuple(color.tolist())).convert("HSV"))[0, 0, 0]
        assert (np.abs(hues.astype(int) - hue) < 6).sum() > 500
    scene = trimesh.load(io.BytesIO(encode_glb(drawn, labels, names, part_colors(2))), "glb")
    shown = [len(scene.geometry[name].faces) for name in names]
    assert shown == np.bincount(labels[drawn.triangle_polygon]).tolist()
