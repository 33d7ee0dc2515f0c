"""VTU files as XML, array by array, and through meshio."""

from __future__ import annotations

import base64
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.write.vtu import encode_vtu
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.voxels import VoxelGrid

POINTS = np.random.default_rng(0).uniform(-1, 1, (8, 3))
TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "<u1"}


def mixed():
    return PolygonMesh.from_faces(POINTS, [[0, 1, 2], [2, 1, 3, 4], [4, 5, 6, 7, 2], [0, 2, 4]])


def arrays_of(data):
    """Every array of a file by the place where it stands and its name."""
    found = {}
    for place in ("FieldData", "Points", "Cells", "CellData"):
        for array in ElementTree.fromstring(data).find(f".//{place}"):
            raw = base64.b64decode(array.text)
            assert int.from_bytes(raw[:8], "little") == len(raw) - 8
            values = np.frombuffer(raw[8:], TYPES[array.get("type")])
            found[place, array.get("Name")] = values
    return found


def test_cells_are_the_polygons_in_order():
    mesh = mixed()
    areas = np.array([1.0, 2.0, 3.0, 4.0])
    found = arrays_of(encode_vtu(mesh, [1, 0, 1, 1], ["head", "body"], {"area": areas}))
    np.testing.assert_array_equal(found["Points", "Points"].reshape(-1, 3), mesh.vertices)
    np.testing.assert_array_equal(found["Cells", "connectivity"], mesh.corners)
    np.testing.assert_array_equal(found["Cells", "offsets"], mesh.offsets[1:])
    assert found["Cells", "types"].tolist() == [5, 9, 7, 5]
    assert found["CellData", "label"].tolist() == [1, 0, 1, 1]
    assert found["CellData", "area"].tolist() == areas.tolist()
    assert found["FieldData", "head"].tolist() == [0, 2]
    assert found["FieldData", "body"].tolist() == [1, 2]


def test_meshio_finds_labels_names_and_areas(tmp_path):
    mesh = PolygonMesh.from_faces(POINTS, [[0, 1, 2], [2, 1, 3, 4], [0, 2, 4], [4, 5, 6, 7]])
    labels, areas = np.array([1, 0, 1, 0]), np.array([0.5, 2.0, 3.0, 4.0])
    path = tmp_path / "x.vtu"
    path.write_bytes(encode_vtu(mesh, labels, ["left arm", "body"], {"area": areas}))
    found = meshio.read(path)
    np.testing.assert_array_equal(found.points, mesh.vertices)
    # meshio makes a block of each run of cells of one type.
    assert [block.type for block in found.cells] == ["triangle", "quad", "triangle", "quad"]
    assert [row.tolist() for block in found.cells for row in block.data] == [
        mesh.corners[a:b].tolist() for a, b in zip(mesh.offsets, mesh.offsets[1:], strict=False)
    ]
    assert np.concatenate(found.cell_data["label"]).tolist() == labels.tolist()
    assert np.concatenate(found.cell_data["area"]).tolist() == areas.tolist()
    assert {name: tuple(row) for name, row in found.field_data.items()} == {
        "left arm": (0, 2),
        "body": (1, 2),
    }


def test_voxels_are_hexahedra_and_points_vertices(tmp_path):
    grid = VoxelGrid.from_occupied(np.ones((2, 1, 1), bool), pitch=2.0)
    path = tmp_path / "x.vtu"
    path.write_bytes(encode_vtu(grid, [0, 1], ["a", "b"], {}))
    found = meshio.read(path)
    (block,) = found.cells
    assert block.type == "hexahedron"
    for cell in block.data:
        p = found.points[cell]
        # Bottom and top run the same way round, one above the other, and outward is outward.
        np.testing.assert_array_equal(p[4:] - p[:4], [[0, 0, 2.0]] * 4)
        sides = np.stack([p[1] - p[0], p[3] - p[0], p[4] - p[0]])
        assert np.linalg.det(sides) == pytest.approx(8.0)
        np.testing.assert_array_equal(p[2], p[1] + p[3] - p[0])
    cloud = PointCloud.from_points(POINTS)
    path.write_bytes(encode_vtu(cloud, np.arange(8) % 2, ["a", "b"], {}))
    found = meshio.read(path)
    assert [block.type for block in found.cells] == ["vertex"]
    assert np.concatenate(found.cell_data["label"]).tolist() == [0, 1] * 4
    assert found.field_data["b"].tolist() == [1, 0]


@pytest.mark.parametrize("name", ["../../x", "<script>&\"'", "a\nb", "", "\ud800", "x" * 10_000])
def test_any_name_leaves_the_file_whole(name):
    found = arrays_of(encode_vtu(mixed(), [0, 0, 1, 1], [name, "b"], {}))
    fields = [key for place, key in found if place == "FieldData"]
    assert fields[1] == "b"
    assert len(fields) == 2
    if name.isprintable() and name:
        assert fields[0] == name


def test_a_label_without_a_name_is_refused():
    with pytest.raises(ShapeError, match="face 0 has the label 1"):
        encode_vtu(mixed(), [1, 0, 0, 0], ["a"], {})
