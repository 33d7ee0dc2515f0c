"""The rows of a PLY file, in text and binary."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.read.ply import read_ply
from tests.io.read.ply_files import (
    ASCII,
    BINARY,
    FACES,
    ORDERS,
    VERTICES,
    mesh_file,
)


def test_binary_data_may_begin_like_the_end_of_a_line(as_file):
    # The first byte of the data is 10, a line feed, behind a header whose lines end in LF or CR.
    vertices = np.frombuffer(np.array([10, 0, 0, 64] * 3, np.uint8).tobytes(), "<f4")
    contents = mesh_file("binary_little_endian", [vertices, *VERTICES], [[1, 2, 3], [0, 1, 2]])
    assert contents.partition(b"end_header\n")[2][0] == 10
    for header_end in (b"\n", b"\r", b"\r\n"):
        head, mark, body = contents.partition(b"end_header\n")
        changed = (head + mark).replace(b"\n", header_end) + body
        shape = read_ply(as_file("feed.ply", changed))
        assert shape.n_elements == 2


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (ASCII.replace("face 4", "face 5"), " ends after 4 of 5 rows of the element 'face'; it is"),
        (ASCII.replace("face 4", "face 3"), ", line 17: there is more than the header announces ("),
        (ASCII.replace("1.5", "1.5x"), ", line 13: '1.5x' is not a number"),
        (ASCII.replace(" 1.5", ""), ", line 13: the row of 'vertex' holds 2 numbers, which is not"),
        (ASCII.replace("1.5", "1.5 9"), ", line 13: the row of 'vertex' holds 4 numbers"),
        (ASCII.replace("3 1 2 3", "3 1 2 x"), ", line 16: 'x' is not an integer"),
        (ASCII.replace("3 1 2 3", "4 1 2 3"), ", line 16: the row of 'face' holds 4 numbers"),
        (ASCII.replace("3 1 2 3", "-3 1 2 3"), ", line 16: the row of 'face' holds 4 numbers"),
        (BINARY[:-1], " ends after 3 of 4 rows of the element 'face'; it is cut off"),
        (BINARY + b"1", " holds more than its header announces (bytes over: 1); it is damaged"),
        (
            BINARY.replace(b"element face 4", b"element face 999999999999999"),
            " of 999999999999999 rows of the element 'face'; it is cut off",
        ),
        (
            BINARY.replace(b"list uchar", b"list char").replace(b"\x03\1\0\0\0", b"\xff\1\0\0\0"),
            " has a list of -1 items in row 2 of 'face'; it is damaged",
        ),
    ],
)  # fmt: skip
def test_rows_that_are_wrong_are_refused_with_the_reason(contents, message, refusal):
    assert message in refusal(read_ply, "bad.ply", contents)


@pytest.mark.parametrize("form", list(ORDERS))
@pytest.mark.parametrize("faces", [FACES, [*FACES[:3], [2, 0, 1, 3]]])
def test_a_binary_file_that_is_cut_off_is_never_read(form, faces, accepted_cuts):
    contents = mesh_file(form, faces=faces, labels=[0, 1, 2, 3])
    assert accepted_cuts(read_ply, "cut.ply", contents) == {}


def test_a_text_file_that_is_cut_off_is_never_read_in_part(accepted_cuts, polygons_of):
    read = accepted_cuts(read_ply, "cut.ply", ASCII.encode())
    # Only the end of the last line may go; it takes nothing with it.
    assert set(read) == {len(ASCII) - 1}
    assert polygons_of(read[len(ASCII) - 1]) == FACES
