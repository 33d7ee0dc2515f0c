"""The header of a PLY file: what it announces, and how it may be wrong."""

from __future__ import annotations

import pytest

from moseg_core.io.read.ply import read_ply
from tests.io.read.ply_files import (
    ASCII,
)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        ("OFF\n", " begins with 'OFF\\n' instead of 'ply'; it is not a PLY file"),
        ("plywood\n", " begins with 'plywood\\n' instead of 'ply'"),
        ("ply\nformat ascii 1.0\n", " has no 'end_header'; it is cut off"),
        (ASCII.replace("format ascii 1.0\n", ""), " names no format in its header"),
        (ASCII.replace("ascii", "utf8"), ", line 2: 'format utf8 1.0' is not understood in a PLY"),
        (ASCII.replace("element vertex 4", "element vertex -4"), ", line 3: 'element vertex -4'"),
        (ASCII.replace("float y", "float x"), ", line 5: property 'x' is repeated"),
        (ASCII.replace("float y", "real y"), ", line 5: 'real y' is not a property moseg can read"),
        (ASCII.replace("list uchar", "list float"), ", line 8: 'list float int vertex_indices' is"),
        (ASCII.replace("element face 4\n", "element vertex 4\n"), " announces an element twice in"),
    ],
)  # fmt: skip
def test_headers_that_are_wrong_are_refused_with_the_reason(contents, message, refusal):
    assert message in refusal(read_ply, "bad.ply", contents)
