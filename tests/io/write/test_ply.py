"""PLY files byte by byte, through trimesh, and back through moseg's own reader."""

from __future__ import annotations

import io
import struct

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.labels import read_labels
from moseg_core.io.read.ply import read_ply
from moseg_core.io.write.ply import encode_ply
from moseg_core.shape.mesh import PolygonMesh

CORNERS = np.random.default_rng(0).uniform(-1, 1, (12, 3))
COLORS = [[255, 0, 1], [0, 128, 2], [7, 8, 250]]


def literal_rows(data):
    """Read a file with struct, value by value, as its header says it must be read."""
    head, body = data.split(b"end_header\n", 1)
    lines = head.decode().splitlines()
    counts = {line.split()[1]: int(line.split()[2]) for line in lines if line[:7] == "element"}
    length = {"uchar": "<B", "int": "<i"}[
        next(line.split()[2] for line in lines if line.startswith("property list"))
    ]
    at = 0

    def take(code):
        nonlocal at
        values = struct.unpack_from(code, body, at)
        at += struct.calcsize(code)
        return values

    vertices = [(take("<3d"), take("<3B"), take("<i")[0]) for _ in range(counts["vertex"])]
    faces = []
    for _ in range(counts["face"]):
        (size,) = take(length)
        faces.append((list(take(f"<{size}i")), list(take("<3B")), take("<i")[0]))
    assert at == len(body)
    return lines, vertices, faces


@given(
    faces=st.lists(st.lists(st.integers(0, 11), min_size=3, max_size=9), min_size=1, max_size=12),
    seed=st.integers(0, 99),
)
@settings(max_examples=60, deadline=None)
def test_vertices_and_polygons_stay_as_they_are(faces, seed):
    labels = np.random.default_rng(seed).integers(0, 3, len(faces))
    mesh = PolygonMesh.from_faces(CORNERS, faces)
    lines, vertices, rows = literal_rows(encode_ply(mesh, labels, ["a", "b", "c"], COLORS))
    assert [place for place, _, _ in vertices] == [tuple(point) for point in CORNERS.tolist()]
    for number, (_, color, label) in enumerate(vertices):
        votes = [labels[f] for f, face in enumerate(faces) for c in face if c == number]
        best = max(map(votes.count, votes), default=0)
        assert label in ([k for k in votes if votes.count(k) == best] or [-1])
        assert color == (tuple(COLORS[label]) if votes else (128, 128, 128))
    expected = zip(faces, labels.tolist(), strict=True)
    assert rows == [(face, COLORS[label], label) for face, label in expected]
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    assert lines[2:5] == [f"comment moseg label {k} {name}" for k, name in enumerate("abc")]


def test_header_in_full():
    mesh = PolygonMesh.from_faces(CORNERS[:3], [[0, 1, 2]])
    head = encode_ply(mesh, [0], ["head"], [[1, 2, 3]]).split(b"end_header\n")[0]
    assert head.decode().splitlines() == [
        "ply",
        "format binary_little_endian 1.0",
        "comment moseg label 0 head",
        "element vertex 3",
        "property double x",
        "property double y",
        "property double z",
        "property uchar red",
        "property uchar green",
        "property uchar blue",
        "property int label",
        "element face 1",
        "property list uchar int vertex_indices",
        "property uchar red",
        "property uchar green",
        "property uchar blue",
        "property int label",
    ]


@pytest.mark.parametrize("size", [255, 256, 300])
def test_polygons_of_many_corners(size):
    angle = np.linspace(0, 2 * np.pi, size, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    mesh = PolygonMesh.from_faces(ring, [list(range(size)), [0, 1, 2]])
    _, _, rows = literal_rows(encode_ply(mesh, [0, 1], ["a", "b"], COLORS[:2]))
    assert [len(row[0]) for row in rows] == [size, 3]
    assert [row[2] for row in rows] == [0, 1]


def test_trimesh_shows_the_colors():
    ball = trimesh.creation.icosphere(subdivisions=1)
    labels = np.arange(len(ball.faces)) % 3
    mesh = PolygonMesh.from_faces(np.array(ball.vertices), np.array(ball.faces))
    data = encode_ply(mesh, labels, ["a", "b", "c"], COLORS)
    loaded = trimesh.load(io.BytesIO(data), file_type="ply", process=False)
    np.testing.assert_array_equal(loaded.vertices, ball.vertices)
    np.testing.assert_array_equal(loaded.faces, ball.faces)
    raw = loaded.metadata["_ply_raw"]
    face, vertex = raw["face"]["data"], raw["vertex"]["data"]
    np.testing.assert_array_equal(face["label"], labels)
    rgb = np.column_stack([face[channel] for channel in ("red", "green", "blue")])
    np.testing.assert_array_equal(rgb, np.array(COLORS)[labels])
    # Of two colours trimesh shows those of vertices.
    assert loaded.visual.kind == "vertex"
    shown = np.array(COLORS)[vertex["label"].reshape(-1)]
    np.testing.assert_array_equal(loaded.visual.vertex_colors[:, :3], shown)


def test_moseg_reads_back_what_it_wrote(tmp_path):
    faces = [[0, 1, 2], [2, 1, 3, 4], [4, 5, 6, 7, 8]]
    mesh = PolygonMesh.from_faces(CORNERS, faces)
    path = tmp_path / "part.ply"
    path.write_bytes(encode_ply(mesh, [2, 0, 2], ["head", "unused", "left arm ü"], COLORS))
    geometry = read_ply(path).geometry
    np.testing.assert_array_equal(geometry.vertices, mesh.vertices)
    np.testing.assert_array_equal(geometry.corners, mesh.corners)
    np.testing.assert_array_equal(geometry.offsets, mesh.offsets)
    found = read_labels(path, 3)
    assert found.labels.tolist() == [2, 0, 2]
    assert found.names == ("head", "unused", "left arm ü")


def test_names_cannot_break_the_header():
    mesh = PolygonMesh.from_faces(CORNERS[:3], [[0, 1, 2]])
    names = ["two\nend_header\nlines", " \t", "\r\x85\u2028"]
    lines, _, rows = literal_rows(encode_ply(mesh, [0], names, COLORS))
    comments = [line for line in lines if line.startswith("comment")]
    assert comments == ["comment moseg label 0 two end_header lines"]
    assert rows == [([0, 1, 2], COLORS[0], 0)]


def test_labels_and_colors_that_do_not_fit():
    mesh = PolygonMesh.from_faces(CORNERS[:3], [[0, 1, 2]])
    with pytest.raises(ShapeError, match="face 0 has the label 1; allowed are 0 to 0"):
        encode_ply(mesh, [1], ["a"], COLORS[:1])
    with pytest.raises(ShapeError, match="each of the 1 faces"):
        encode_ply(mesh, [0, 0], ["a"], COLORS[:1])
    with pytest.raises(UsageError, match="1 parts need as many colours"):
        encode_ply(mesh, [0], ["a"], COLORS)
