from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.io.read.stl import read_stl

TRIANGLES = np.array(
    [
        [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
        [[0, 0, 0], [1, 0, 0], [0, 0, 1.5]],
        [[1, 0, 0], [0, 1, 0], [0, 0, 1.5]],
        [[0, 1, 0], [0, 0, 0], [0, 0, 1.5]],
    ]
)


def encode_binary(triangles: np.ndarray, header: bytes = b"made by hand") -> bytes:
    records = [
        struct.pack("<12fH", 0, 0, 1, *map(float, triangle.reshape(-1)), 7)
        for triangle in triangles
    ]
    return header.ljust(80, b" ") + struct.pack("<I", len(records)) + b"".join(records)


def encode_text(triangles: np.ndarray, name: str = "tetra") -> str:
    lines = [f"solid {name}"]
    for triangle in triangles.tolist():
        lines += ["  facet normal 0 0 1", "    outer loop"]
        lines += ["      vertex " + " ".join(map(repr, corner)) for corner in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, f"endsolid {name}"]) + "\n"


TEXT = encode_text(TRIANGLES)
BINARY = encode_binary(TRIANGLES)


def corners_of(shape) -> np.ndarray:
    return shape.geometry.vertices[shape.geometry.corners].reshape(-1, 3, 3)


@pytest.mark.parametrize(
    "contents",
    [
        BINARY,
        encode_binary(TRIANGLES, b"solid although binary\nfacet"),
        encode_binary(TRIANGLES, b"\0" * 80),
        TEXT,
        TEXT.upper(),
        TEXT.replace("\n", "\r\n"),
        TEXT.replace("\n", "\n\n\t"),
        TEXT.replace("tetra", "a facet of\tendsolid vertex 1 2 3"),
        TEXT.replace(" tetra", ""),
        TEXT.replace("tetra", "the_tetra"),
        TEXT.replace("normal 0 0 1", "normal -nan -nan -nan"),
        "\n  " + TEXT,
        encode_text(TRIANGLES[:1], "first") + encode_text(TRIANGLES[1:], "second"),
    ],
)
def test_variants_of_the_format_read_alike(contents, as_file):
    shape = read_stl(as_file("tetra.stl", contents))
    assert shape.name == "tetra"
    np.testing.assert_array_equal(corners_of(shape), TRIANGLES)
    assert shape.volume == pytest.approx(0.25)
    assert all(len(shape.adjacency.neighbors(f)) == 3 for f in range(4))


@given(data=st.data(), binary=st.booleans())
def test_round_trip(data, binary, as_file, polygon_meshes):
    vertices, faces = data.draw(polygon_meshes)
    triangles = vertices[[face[:3] for face in faces]]
    # Cutting a polygon down may leave no face with an area.
    triangles = np.concatenate([triangles, TRIANGLES])
    contents = encode_binary(triangles) if binary else encode_text(triangles)
    shape = read_stl(as_file("random.stl", contents))
    np.testing.assert_array_equal(corners_of(shape), triangles)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", " is empty; export it again"),
        (b"not an STL file", " is no STL file: 15 bytes, and no 'solid' in front"),
        (b"x" * 200, " is cut off or damaged: "),
        (BINARY[:-1], " is cut off or damaged: 4 triangles take 284 bytes, and there are 283"),
        (BINARY + b"x" * 50, " does not match its header: 4 triangles take 284 bytes, and there"),
        (BINARY[:80] + bytes(4) + BINARY[84:], " does not match its header: 0 triangles take 84"),
        (encode_binary(TRIANGLES, b"solid")[:-9], " is cut off or damaged: 4 triangles take 284"),
        (encode_binary(TRIANGLES[:0]), " has no faces; export the shape with its faces"),
        ("solid nothing\nendsolid nothing\n", " has no faces; export the shape"),
        (encode_binary(TRIANGLES * np.nan), ": vertex 0 is not finite"),
        (encode_binary(TRIANGLES * 0), ": all 4 faces are degenerate"),
        (TEXT.replace("endsolid tetra\n", ""), " ends without 'endsolid'; it is cut off"),
        (TEXT.replace("1.5", "1.5x", 1), ", line 13: '1.5x' is not a number"),
        (TEXT.replace("1.5", "1_5", 1), ", line 13: '1_5' is not a number"),
        (TEXT.replace(" 1.5", "", 1), ", line 13: expected the 'vertex' line of a triangle, found"),
        (TEXT.replace("    endloop\n", "", 1), ", line 7: expected the 'endloop' line of a triang"),
        (TEXT.replace("solid tetra", "solid\nhere", 1), ", line 2: expected the 'facet' line"),
        (TEXT + TEXT[12:], ", line 31: 'facet' is out of place; the file is damaged"),
        (TEXT + "endsolid\n", ", line 31: 'endsolid' is out of place"),
        (TEXT.replace("endsolid", "solid"), ", line 30: 'solid' is out of place"),
        (
            TEXT.replace("  facet", "endsolid\nsolid\nfacet", 2).replace(
                "outer", "endsolid\nouter", 1
            ),
            ", line 5: the solid ends within a facet",
        ),
        (TEXT[: TEXT.index("endfacet")] + "endsolid", " ends within a triangle; it is cut off"),
    ],
)
def test_malformed_files_are_refused_with_the_reason(contents, message, refusal):
    assert message in refusal(read_stl, "bad.stl", contents)


def test_a_binary_file_that_is_cut_off_is_never_read(accepted_cuts):
    for header in (b"made by hand", b"solid although binary"):
        assert accepted_cuts(read_stl, "cut.stl", encode_binary(TRIANGLES, header)) == {}


def test_a_text_file_that_is_cut_off_is_never_read_in_part(accepted_cuts):
    read = accepted_cuts(read_stl, "cut.stl", TEXT.encode())
    # Only the name behind the last word may go.
    assert min(read) == TEXT.index("endsolid") + len("endsolid")
    for shape in read.values():
        np.testing.assert_array_equal(corners_of(shape), TRIANGLES)


def test_damaged_bytes_are_read_or_refused(damages):
    assert damages(read_stl, "damaged.stl", TEXT.encode()) > 100
    assert damages(read_stl, "damaged.stl", BINARY) > 1


@pytest.mark.parametrize("over", [b"\0", b"\r\n", bytes(228), b"x" * 49, b"made by hand" * 9])
def test_bytes_behind_the_triangles_are_passed_over(over, as_file):
    shape = read_stl(as_file("over.stl", BINARY + over))
    np.testing.assert_array_equal(corners_of(shape), TRIANGLES)
    assert shape.notes[0] == f"bytes behind the last triangle: {len(over)}; passed over"


def test_more_behind_the_triangles_than_these_take_is_no_padding(as_file):
    # As a text in UTF-32, of which four letters stand where a binary file has its count.
    with pytest.raises(ShapeError, match="does not match its header"):
        read_stl(as_file("over.stl", BINARY + b"x" * 499))


def test_bytes_behind_a_text_are_passed_over(as_file):
    shape = read_stl(as_file("over.stl", TEXT.encode() + bytes(7)))
    np.testing.assert_array_equal(corners_of(shape), TRIANGLES)
    assert shape.notes[0] == "bytes behind the text: 7; passed over"
