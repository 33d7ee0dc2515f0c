from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.obj import read_obj

# Three quads in a row, the middle one bent up; the seam between the first two repeats both the
# positions and the texture coordinates, as exporters write it.
STRIP = """mtllib strip.mtl
o strip
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 1 0 0
v 2 0 1
v 2 1 1
v 1 1 0
v 3 0 0
v 3 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/3/1 4/4/1
usemtl blue
g middle
s off
f 5/1/1 6/2/1 7/3/1 8/4/1
usemtl red
f 6/1/1 9/2/1 10/3/1
f 6/1/1 10/3/1 7/4/1
"""
POLYGONS = [[0, 1, 2, 3], [4, 5, 6, 7], [5, 8, 9], [5, 9, 6]]


def encode(vertices: np.ndarray, faces: list[list[int]], corner: str = "{}") -> str:
    lines = ["v " + " ".join(map(repr, row)) for row in vertices.tolist()]
    lines += ["vt 0.5 0.5", "vn 0 0 1"]
    lines += ["f " + " ".join(corner.format(c + 1) for c in face) for face in faces]
    return "\n".join(lines) + "\n"


def test_materials_quads_and_seams_keep_one_element_per_face_line(as_file, polygons_of):
    shape = read_obj(as_file("strip.obj", STRIP))
    assert shape.name == "strip"
    assert polygons_of(shape) == POLYGONS
    assert shape.n_elements == 4
    neighbors = [shape.adjacency.neighbors(f).tolist() for f in range(4)]
    assert neighbors == [[1], [0, 3], [3], [1, 2]]
    assert shape.points[:, 0].tolist() == pytest.approx([0.5, 1.5, 8 / 3, 7 / 3])


@given(data=st.data(), corner=st.sampled_from(["{}", "{}/1", "{}//1", "{}/1/1", "{}/", "{}//"]))
def test_round_trip(data, corner, as_file, polygon_meshes, polygons_of):
    vertices, faces = data.draw(polygon_meshes)
    shape = read_obj(as_file("random.obj", encode(vertices, faces, corner)))
    np.testing.assert_array_equal(shape.geometry.vertices, vertices)
    assert polygons_of(shape) == faces


@given(data=st.data())
def test_numbers_that_count_back(data, as_file, polygon_meshes, polygons_of):
    vertices, faces = data.draw(polygon_meshes)
    # Each face stands as early as its vertices allow, and counts back from there.
    faces = sorted(faces, key=max)
    lines = []
    for count, row in enumerate(vertices.tolist(), 1):
        lines.append("v " + " ".join(map(repr, row)))
        lines += [
            "f " + " ".join(f"{c - count}/1/1" for c in face)
            for face in faces
            if max(face) + 1 == count
        ]
    shape = read_obj(as_file("back.obj", "\n".join(lines)))
    assert polygons_of(shape) == faces


@pytest.mark.parametrize(
    "text",
    [
        STRIP.replace("f 5/1/1 6/2/1 7", "f 5/1/1 \\\n6/2/1 \\\n7"),
        STRIP.replace("f 5/1/1 6/2/1 7", "f 5/1/1 6/2/1\\\r\n 7"),
        STRIP.replace("\n", "\r\n"),
        STRIP.replace("\n", "\n\n"),
        STRIP.replace("v 2 0 1", "  v\t2.0 0 1e0 # the ridge"),
        STRIP.replace("v 2 0 1", "v 2 0 1 0.3 0.2 0.1"),
        STRIP.replace("v 2 0 1", "v 2 0 1 1.0"),
        STRIP.replace("usemtl blue", "l 1 2 3\np 1\nusemtl blue"),
        STRIP.replace("f 1/1/1", "fo 1/1/1"),
        STRIP.rstrip("\n") + " \\",
        "\ufeff# exported C:\\models\\\n" + STRIP,
    ],
)
def test_variants_of_the_format_read_alike(text, as_file, polygons_of):
    shape = read_obj(as_file("variant.obj", text))
    assert polygons_of(shape) == POLYGONS
    assert shape.geometry.vertices[5].tolist() == [2, 0, 1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", " is empty; export it again"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", " has no faces; export the shape with its faces"),
        ("<html>\n", ", line 1: '<html>' is not a statement of an OBJ file"),
        (STRIP.replace("f 6/1/1 9", "f6/1/1 9"), ", line 25: 'f6/1/1' is not a statement"),
        (
            STRIP.replace("s off", "surf 0 1 0 1 1 2 3"),
            ", line 22: 'surf' is not supported; export",
        ),
        (STRIP.replace("v 2 0 1", "v 2 0"), ", line 8: a vertex needs 3 coordinates, this one"),
        (STRIP.replace("v 2 0 1", "v 2 0 one"), ", line 8: 'one' is not a number"),
        (STRIP.replace("v 2 0 1", "v 2 0 nan"), ": vertex 5 is not finite"),
        (STRIP.replace("6/1/1 9/2/1", "6/1/1 x/2/1"), ", line 25: 'x' is not an integer"),
        (STRIP.replace("6/1/1 9/2/1", "6/1/1 /2/1"), ", line 25: '' is not an integer"),
        (STRIP.replace("6/1/1 9/2/1", "6/1/1 9.0/2/1"), ", line 25: '9.0' is not an integer"),
        (STRIP.replace("s off", "f"), ", line 22: a face needs at least 3 corners, this one has 0"),
        (STRIP.replace("s off", "v0 1 2"), ", line 22: 'v0' is not a statement of an OBJ file"),
        (STRIP.replace("s off", "7 1 2"), ", line 22: '7' is not a statement of an OBJ file"),
        (STRIP + "f 1 2", ": the last face is cut off; export it again"),
        ("v 0 0 0\nxyz 1\ne 2\n", ", line 2: 'xyz' is not a statement of an OBJ file"),
        (STRIP.replace("9/2/1", "0/2/1"), ", line 25: the face names vertex 0, but there are 10"),
        (STRIP.replace("9/2/1", "11/2/1"), ", line 25: the face names vertex 11, but there are"),
        (STRIP.replace("9/2/1", "-11/2/1"), ", line 25: the face names vertex -11, but there"),
        (STRIP.replace("f 5/1/1 6", "f 5/1/1 \\\nx"), ", line 23: 'x' is not an integer"),
    ],
)
def test_malformed_files_are_refused_with_the_reason(text, message, refusal):
    assert message in refusal(read_obj, "bad.obj", text)


def test_what_is_unknown_or_no_face_is_passed_over_and_said(as_file, polygons_of):
    more = "e 1 2\ne 2 3\nx_own 3\nf 1 2\nf 3\n"
    shape = read_obj(as_file("more.obj", STRIP + more))
    assert polygons_of(shape) == POLYGONS
    last = len(STRIP.splitlines())
    assert shape.notes[:3] == (
        f"faces of fewer than three corners: 2, the first in line {last + 4}; they are passed over",
        f"statement 'e' is unknown and passed over (2 times, first in line {last + 1})",
        f"statement 'x_own' is unknown and passed over (once, first in line {last + 3})",
    )


def test_many_unknown_statements_hide_no_other_note(as_file):
    more = "".join(f"x_{k} 1\n" for k in range(15))
    notes = read_obj(as_file("more.obj", f"{STRIP}{more}f 1 2\n")).notes
    assert notes[0].startswith("faces of fewer than three corners: 1, ")
    assert notes[10].startswith("statement 'x_9' is unknown")
    assert notes[11] == "5 more statements are unknown and passed over"


def test_lines_behind_a_continued_one_keep_their_numbers(refusal):
    text = STRIP.replace("f 5/1/1 6", "f 5/1/1 \\\n6").replace("10/3/1 7/4/1", "10/3/1 q")
    assert ", line 27: 'q' is not an integer" in refusal(read_obj, "bad.obj", text)


def test_a_file_that_is_cut_off_keeps_only_whole_faces(accepted_cuts, polygons_of):
    # The format has no counts: a file that ends between two lines is a file.
    for shape in accepted_cuts(read_obj, "cut.obj", STRIP.encode()).values():
        faces = polygons_of(shape)
        assert faces[:-1] == POLYGONS[: len(faces) - 1]
        assert faces[-1] in (
            POLYGONS[len(faces) - 1],
            POLYGONS[len(faces) - 1][:3],
            [5, 8, 0],  # "10" cut down to "1", which nothing in the file tells
        )


def test_damaged_bytes_are_read_or_refused(damages):
    assert damages(read_obj, "damaged.obj", STRIP.encode()) > 50
