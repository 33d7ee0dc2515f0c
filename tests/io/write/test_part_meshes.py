"""One part in a file: what trimesh reads of it, and moseg itself."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
import trimesh

from moseg_core.io.files import load
from moseg_core.io.write.part_meshes import OF_POINTS, PART_SUFFIXES, PartMesh, encode_part
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.mesh import PolygonMesh
from tests import shapes

BLUE = np.array([65, 112, 216], np.uint8)


def box():
    return PartMesh(label="../a <box>\n", geometry=PolygonMesh.from_faces(*shapes.box(3, 2, 1)))


@pytest.mark.parametrize("suffix", PART_SUFFIXES)
def test_every_format_holds_the_surface(suffix, as_file):
    data = encode_part(box(), suffix, BLUE)
    assert data == encode_part(box(), suffix, BLUE)
    if suffix != ".ply":  # trimesh does not take its quads with colours
        found = trimesh.load(io.BytesIO(data), file_type=suffix[1:], force="mesh")
        assert found.area == pytest.approx(22.0)
        assert found.bounds.tolist() == [[0, 0, 0], [3, 2, 1]]
    shape = load(as_file(f"box{suffix}", data))
    assert shape.area == pytest.approx(22.0)
    assert shape.volume == pytest.approx(6.0)
    # 22 quads where the format holds them.
    assert shape.n_elements == (22 if suffix in (".obj", ".ply") else 44)


def test_a_name_breaks_no_file():
    lines = encode_part(box(), ".obj", BLUE).decode().splitlines()
    assert lines[0] == "o a_-box"
    assert {line.split()[0] for line in lines[1:]} == {"v", "f"}
    header = encode_part(box(), ".ply", BLUE).split(b"end_header")[0].decode().splitlines()
    assert header[2] == "comment moseg label 0 ../a <box>"


@pytest.mark.parametrize("suffix", OF_POINTS)
def test_points_of_a_cloud(suffix, as_file):
    points = shapes.sphere(1)[0]
    part = PartMesh(label="dots", geometry=PointCloud.from_points(points, normals=points))
    data = encode_part(part, suffix, BLUE)
    found = load(as_file(f"dots{suffix}", data))
    assert found.n_elements == len(points) * (8 if suffix == ".glb" else 1)


def test_what_points_up_points_up_in_a_part_too(as_file):
    standing = encode_part(replace(box(), up="z"), ".glb", BLUE)
    found = trimesh.load(io.BytesIO(standing), file_type="glb", force="mesh")
    assert found.extents == pytest.approx([3, 1, 2])  # of 3, 2 and 1 the last was up
    assert standing != encode_part(box(), ".glb", BLUE)
