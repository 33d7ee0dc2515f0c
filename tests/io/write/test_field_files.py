"""A field in files: each format read back gives the values, by the order of the elements."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
import trimesh

from moseg_core.io import load
from moseg_core.io.write.field_files import encode_field
from moseg_core.shape.shape import Shape
from moseg_core.view.ramp import ramp
from tests import shapes


def some_shapes():
    mesh = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(6, 5), 3))
    cloud = Shape.from_points(mesh.points)
    return [mesh, cloud, Shape.from_voxels(np.ones((2, 2, 2), bool))]


@pytest.mark.parametrize("shape", some_shapes(), ids=lambda shape: shape.noun)
def test_values_come_back(shape, tmp_path):
    values = np.random.default_rng(1).normal(size=shape.n_elements)
    assert np.load(io.BytesIO(encode_field(shape, values, "npy"))).tolist() == values.tolist()
    rows = list(csv.DictReader(io.StringIO(encode_field(shape, values, "csv").decode())))
    assert [float(row["value"]) for row in rows] == values.tolist()
    assert [float(row["area"]) for row in rows] == shape.areas.tolist()
    assert [[float(row[axis]) for axis in "xyz"] for row in rows] == shape.points.tolist()
    data = encode_field(shape, values, "ply")
    assert data == encode_field(shape, values, "ply")
    assert b"property double value\n" in data
    path = tmp_path / "field.ply"
    path.write_bytes(data)
    assert load(path).n_elements == shape.n_elements


def test_viewers_see_the_colours_of_the_ramp():
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(6, 5), 3))
    triangles = Shape.from_mesh(shape.geometry.vertices, shape.geometry.triangles)
    values = triangles.points[:, 2]
    data = encode_field(triangles, values, "ply")
    seen = trimesh.load(io.BytesIO(data), file_type="ply", process=False)
    assert seen.faces.tolist() == triangles.geometry.triangles.tolist()
    assert seen.metadata["_ply_raw"]["face"]["data"]["value"].tolist() == values.tolist()
    colors = seen.visual.face_colors[:, :3]
    assert colors[values.argmin()].tolist() == ramp()[0].tolist()
    assert colors[values.argmax()].tolist() == ramp()[-1].tolist()
