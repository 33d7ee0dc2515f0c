from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.ply import read_ply
from tests.io.read.ply_files import (
    ASCII,
    BINARY,
    FACES,
    FORMATS,
    VERTICES,
    encode,
    mesh_file,
)


@given(data=st.data(), form=st.sampled_from(FORMATS))
def test_round_trip(data, form, as_file, polygon_meshes, polygons_of):
    vertices, faces = data.draw(polygon_meshes)
    path = as_file("random.ply", mesh_file(form, vertices, faces))
    shape = read_ply(path)
    assert shape.name == "random"
    np.testing.assert_array_equal(shape.geometry.vertices, vertices)
    assert polygons_of(shape) == faces


@given(data=st.data(), form=st.sampled_from(FORMATS))
def test_other_elements_and_properties_are_passed_over(
    data, form, as_file, polygon_meshes, polygons_of
):
    vertices, faces = data.draw(polygon_meshes)
    number = st.integers(0, 100)
    numbers = st.lists(number, max_size=3)
    labels = [data.draw(number) for _ in faces]
    elements = [
        ("camera", ["double angle", "list char ushort ids"], [[0.5, data.draw(numbers)]]),
        (
            "vertex",
            ["uchar red", "double z", "list uint32 float weights", "float y", "float x"],
            [[7, z, data.draw(numbers), y, x] for x, y, z in vertices.tolist()],
        ),
        ("nothing", [], []),
        (
            "face",
            ["int16 flags", "list ushort float texcoord", "list int uint32 vertex_index",
             "uchar label", "list uchar char more"],
            [
                [-1, data.draw(numbers), face, label, data.draw(numbers)]
                for face, label in zip(faces, labels, strict=True)
            ],
        ),
        ("edge", ["int vertex1", "int vertex2"], [[0, 1], [1, 2]]),
    ]  # fmt: skip
    path = as_file("rich.ply", encode(form, elements))
    shape = read_ply(path)
    np.testing.assert_array_equal(shape.geometry.vertices, vertices)
    assert polygons_of(shape) == faces


@pytest.mark.parametrize(
    "contents",
    [
        ASCII.replace("\n", "\r\n"),
        ASCII.replace("\n", "\r"),
        ASCII.replace("\n0.0 1.0", "\n\n0.0 1.0"),
        ASCII.replace("element face", "comment of no use\nobj_info none\n\nelement face"),
        ASCII.replace("uchar int", "uint8 int32").replace("float x", "float32 x"),
        ASCII + "\n \n",
        BINARY.replace(b"\n", b"\r\n", 8).replace(b"end_header\n", b"end_header\r\n"),
        BINARY.replace(b"\n", b"\r", 9),
        BINARY + b"\n",
    ],
)
def test_variants_of_the_format_read_alike(contents, as_file, polygons_of):
    shape = read_ply(as_file("variant.ply", contents))
    assert polygons_of(shape) == FACES
    np.testing.assert_array_equal(shape.geometry.vertices, VERTICES)


@pytest.mark.parametrize("form", FORMATS)
def test_vertices_without_faces_are_a_point_cloud(form, as_file):
    cloud = encode(form, [("vertex", ["float x", "float y", "float z"], VERTICES.tolist())])
    for contents in (cloud, mesh_file(form, faces=[])):
        shape = read_ply(as_file("cloud.ply", contents))
        assert (shape.name, shape.noun, shape.geometry.normals) == ("cloud", "point", None)
        np.testing.assert_array_equal(shape.points, VERTICES)


@pytest.mark.parametrize("form", FORMATS)
def test_normals_of_points(form, as_file):
    rows = [[3, *row, 0.0, 0.5, 1.0] for row in VERTICES.tolist()]
    names = ["label", "x", "y", "z", "nx", "ny", "nz"]
    properties = [f"{'int' if name == 'label' else 'float'} {name}" for name in names]
    path = as_file("cloud.ply", encode(form, [("vertex", properties, rows)]))
    np.testing.assert_array_equal(read_ply(path).geometry.normals, [[0.0, 0.5, 1.0]] * 4)


def test_a_file_without_vertices_is_refused(refusal):
    empty = encode("ascii", [("vertex", ["float x", "float y", "float z"], [])])
    assert refusal(read_ply, "cloud.ply", empty).startswith(" has neither faces nor vertices")


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ("", " is empty; export it again"),
        (ASCII.replace("float z", "float w"), " has no coordinate 'z' for its vertices"),
        (ASCII.replace("vertex_indices", "corners"), " has faces with corners, but without the"),
        (ASCII.replace("uchar int", "uchar float"), " has vertex indices that are not lists of in"),
        (ASCII.replace("element face", "element tristrips"), " holds triangle strips, not faces"),
        (ASCII.replace("1.5", "nan"), ": vertex 3 is not finite"),
        (ASCII.replace("3 1 2 3", "3 1 2 4"), ": face 2 names vertex 4, but there are 4 vertices"),
        (mesh_file("binary_big_endian", VERTICES * np.nan), ": vertex 0 is not finite"),
        (mesh_file("binary_big_endian", faces=[[0, 1, 4]]), ": face 0 names vertex 4"),
        (mesh_file("binary_big_endian", faces=[[0, 1]]), " has no faces; export the shape with"),
    ],
)  # fmt: skip
def test_malformed_files_are_refused_with_the_reason(contents, message, refusal):
    assert message in refusal(read_ply, "bad.ply", contents)


@pytest.mark.parametrize("form", FORMATS)
def test_damaged_bytes_are_read_or_refused(form, damages):
    contents = mesh_file(form, faces=[*FACES, [0, 1, 2, 3]], labels=range(5))
    assert damages(read_ply, "damaged.ply", contents) > 50


@pytest.mark.parametrize("form", FORMATS)
def test_faces_of_two_corners_are_no_elements(form, as_file, polygons_of):
    faces = [FACES[0], [0, 1], *FACES[1:]]
    path = as_file("x.ply", mesh_file(form, faces=faces, labels=range(5)))
    shape = read_ply(path)
    assert polygons_of(shape) == FACES
    assert shape.notes[0] == (
        "faces of fewer than three corners: 1, the first in row 1 of the faces; they are"
        " passed over"
    )


@pytest.mark.parametrize("form", FORMATS)
def test_a_face_of_no_corners_means_wrong_counts(form, refusal):
    # So reads a binary file that announces a vertex too many: from a wrong place.
    contents = mesh_file(form, faces=[*FACES, []])
    assert "has a face of no corners, row 4" in refusal(read_ply, "x.ply", contents)
