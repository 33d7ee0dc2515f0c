from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.off import read_off

TETRAHEDRON = """OFF
4 4 6
0 0 0
1 0 0
0 1 0
0 0 1.5
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
"""
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]


def encode(vertices: np.ndarray, faces: list[list[int]]) -> str:
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(map(repr, row)) for row in vertices.tolist()]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    return "\n".join(lines) + "\n"


def test_a_plain_file(as_file, polygons_of):
    shape = read_off(as_file("tetra.off", TETRAHEDRON))
    assert shape.name == "tetra"
    assert polygons_of(shape) == FACES
    assert shape.geometry.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.5]]
    assert shape.volume == pytest.approx(0.25)


@given(data=st.data())
def test_round_trip(data, as_file, polygon_meshes, polygons_of):
    vertices, faces = data.draw(polygon_meshes)
    shape = read_off(as_file("random.off", encode(vertices, faces)))
    np.testing.assert_array_equal(shape.geometry.vertices, vertices)
    assert polygons_of(shape) == faces


@pytest.mark.parametrize(
    "text",
    [
        TETRAHEDRON.replace("OFF\n", "OFF "),
        TETRAHEDRON.replace("OFF\n", "OFF"),
        TETRAHEDRON.replace("OFF\n", ""),
        TETRAHEDRON.replace("4 4 6", "4 4"),
        TETRAHEDRON.replace("\n", "\r\n"),
        TETRAHEDRON.replace("\n", "\r"),
        TETRAHEDRON.replace("\n", "\n\n  \n"),
        TETRAHEDRON.rstrip("\n"),
        "\ufeff" + TETRAHEDRON,
        "# made by hand\n" + TETRAHEDRON.replace("1 0 0", "\t1  0 0 # a corner\n# 9 9 9"),
        TETRAHEDRON.replace("3 0 2 1", "3 0 2 1 255 0 0").replace("3 2 0 3", "3 2 0 3 0.5"),
        TETRAHEDRON.replace("OFF", "COFF").replace("0 0 1.5", "0 0 1.5 255 0 0 255"),
        TETRAHEDRON.replace("OFF", "NOFF").replace("0 0 1.5", "0 0 1.5 0 0 1"),
        TETRAHEDRON.replace("OFF", "STCNOFF").replace("0 0 1.5", "0 0 1.5 0 0 1 9 9 9 .5 .5"),
    ],
)
def test_variants_of_the_format_read_alike(text, as_file, polygons_of):
    shape = read_off(as_file("variant.off", text))
    assert polygons_of(shape) == FACES
    assert shape.geometry.vertices[3].tolist() == [0, 0, 1.5]


def test_mixed_polygons_keep_their_order_and_stay_whole(as_file, polygons_of):
    vertices = np.array([(x, y, 0) for y in range(3) for x in range(3)], float)
    faces = [[0, 1, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 5, 8, 7, 6]]
    shape = read_off(as_file("mixed.off", encode(vertices, faces)))
    assert polygons_of(shape) == faces
    assert shape.areas.tolist() == pytest.approx([1.0, 0.5, 0.5, 2.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", " is empty; export it again"),
        (" \n\n", " is empty; export it again"),
        ("# only\n", " holds nothing but comments"),
        ("OFF\n", " ends before the numbers of vertices, faces and edges"),
        ("solid x\n", ", line 1: begins with 'solid' instead of OFF"),
        ("\n4OFF\n1 1 1\n", ", line 2: '4OFF' is not in three dimensions"),
        ("nOFF\n3\n1 1 1\n", ", line 1: 'nOFF' is not in three dimensions"),
        ("OFF BINARY\n\0\0", ", line 1: binary OFF is not supported; export it as ASCII"),
        ("OFF\n4\n", ", line 2: expected the numbers of vertices, faces and edges, found 1 words"),
        ("OFF\n4 x 6\n", ", line 2: 'x' is not an integer"),
        ("OFF\n4 -4 6\n", ", line 2: the numbers of vertices, faces and edges must not be neg"),
        (TETRAHEDRON.replace("4 4 6", "9 4 6"), " announces 9 vertices and 4 faces, but ends"),
        (TETRAHEDRON.replace("4 4 6", "4 5 6"), "5 faces, but ends after 4 faces; it is cut off"),
        (
            TETRAHEDRON.replace("4 4 6", "4 3 6"),
            ", line 10: announces 4 vertices and 3 faces, but goes on behind them",
        ),
        (TETRAHEDRON.replace("4 4 6", "4 0 6").split("3 0")[0], " has no faces; export the shape"),
        (TETRAHEDRON.replace("1.5", "1.5e"), ", line 6: '1.5e' is not a number"),
        (TETRAHEDRON.replace("1.5", "1_5"), ", line 6: '1_5' is not a number"),
        (TETRAHEDRON.replace("0 0 1.5", "0 0"), ", line 6: a vertex needs 3 coordinates, this"),
        (TETRAHEDRON.replace("0 0 1.5", "0 0 nan"), ": vertex 3 is not finite"),
        (TETRAHEDRON.replace("0 0 1.5", "0 0 -inf"), ": vertex 3 is not finite"),
        (TETRAHEDRON.replace("0 0 1.5", "0 0 1e200"), " has vertex 3 at [0.0, 0.0, 1e+200], be"),
        (TETRAHEDRON.replace("3 1 2 3", "3 1 2 4"), ": face 2 names vertex 4, but there are 4"),
        (TETRAHEDRON.replace("3 1 2 3", "3 1 2 -1"), ": face 2 names vertex -1"),
        (TETRAHEDRON.replace("3 1 2 3", "3 1 2 3.0"), ", line 9: '3.0' is not an integer"),
        (TETRAHEDRON.replace("3 1 2 3", "3 1 2 " + "9" * 30), ", line 9: '999999999999999999999"),
        (TETRAHEDRON.replace("3 1 2 3", "x 1 2 3"), ", line 9: 'x' is not an integer"),
        (TETRAHEDRON.replace("3 1 2 3", "0"), ", line 9: a face needs at least 3 corners"),
        (TETRAHEDRON.replace("3 1 2 3", "4 1 2 3"), ", line 9: the face announces 4 corners and"),
        (TETRAHEDRON.replace("3 1 2 3", "3 1 2 3 red"), ", line 9: 'red' is not a number"),
        (TETRAHEDRON.replace("0 0 1.5", "0 0 0").replace("0 1 0", "2 0 0"), ": all 4 faces are"),
    ],
)
def test_malformed_files_are_refused_with_the_reason(text, message, refusal):
    assert message in refusal(read_off, "bad.off", text)


def test_faces_of_two_corners_are_passed_over(as_file, polygons_of):
    shape = read_off(as_file("x.off", TETRAHEDRON.replace("3 1 2 3", "2 1 2")))
    assert polygons_of(shape) == [FACES[0], FACES[1], FACES[3]]
    assert shape.notes[0] == (
        "faces of fewer than three corners: 1, the first in line 9; they are passed over"
    )


@pytest.mark.parametrize("number", ["1e0", "1.0", "+1", "0.1e1", "10E-1"])
def test_plain_files_and_others_are_read_alike(number, as_file):
    text = TETRAHEDRON.replace("1 0 0", f"{number} 0 0", 1)
    plain, slow = (read_off(as_file("x.off", t)) for t in (text, text + "# slowly\n"))
    np.testing.assert_array_equal(plain.geometry.vertices, slow.geometry.vertices)
    np.testing.assert_array_equal(plain.geometry.corners, slow.geometry.corners)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ValueError, match=r"^gone\.off cannot be read \(No such file"):
        read_off(tmp_path / "gone.off")


def test_a_file_that_is_cut_off_is_never_read_in_part(accepted_cuts, polygons_of):
    contents = TETRAHEDRON.encode()
    read = accepted_cuts(read_off, "cut.off", contents)
    # Only the end of the last line may go; it takes nothing with it.
    assert set(read) == {len(contents) - 1}
    assert polygons_of(read[len(contents) - 1]) == FACES


def test_damaged_bytes_are_read_or_refused(damages):
    assert damages(read_off, "damaged.off", TETRAHEDRON.encode()) > 100


@pytest.mark.skipif("MOSEG_PSB" not in os.environ, reason="MOSEG_PSB names no benchmark folder")
def test_benchmark_meshes_are_closed():
    for path in sorted(Path(os.environ["MOSEG_PSB"], "off").glob("*.off"))[::40]:
        shape = read_off(path)
        assert shape.volume is not None
        assert shape.geometry.is_triangular
