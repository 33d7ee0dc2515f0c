"""Text files of points taken apart: comments, headers, counts, separators."""

from __future__ import annotations

from pathlib import Path

import pytest

from moseg_core.errors import ShapeError
from moseg_core.io.read.point_rows import read_rows

ROWS = [[b"1", b"2", b"3"], [b"4", b"5", b"6"]]
NAMED = ("x", "y", "z")


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("1 2 3\n4 5 6", ()),
        ("1\t2\t3\n4\t5\t6\n", ()),
        ("1 2\t3\n4 5\t6\n", ()),
        ("1,2,3\r4,5,6\r", ()),
        ("1, 2, 3\r\n4, 5, 6\r\n", ()),
        ("1;2;3\n\n4;5;6\n", ()),
        ("1,2,3,\n4,5,6,\n", ()),
        ("2\n1 2 3\n4 5 6\n", ()),
        ("1\n1 2 3\n1\n4 5 6\n", ()),
        ("// made by a scanner\n2\n1 2 3\n4 5 6\n", ()),
        ("# x y z\n1 2 3\n4 5 6\n", NAMED),
        ("# x,y,z\n1 2 3\n4 5 6\n", NAMED),
        ("#x;y;z\n# units: m\n1 2 3\n4 5 6\n", NAMED),
        ("//X Y Z\n1 2 3\n4 5 6\n", NAMED),
        ("//X,Y,Z\n2\n1,2,3\n4,5,6\n", NAMED),
        ("X Y Z\n1 2 3\n4 5 6\n", NAMED),
        ('"X [m]";"Y [m]";"Z (m)"\n1;2;3\n4;5;6\n', NAMED),
        ("x,y,z\n1,2,3\n4,5,6 # the last\n", NAMED),
        ('x,y,z\n"1","2","3"\n"4","5","6"\n', NAMED),
        ("\ufeffx\ty\tz\n1\t2\t3\n4\t5\t6\n", NAMED),
        ("sep=;\nx;y;z\n1;2;3\n4;5;6\n", NAMED),
        ("% x y z r g b\n1 2 3\n4 5 6\n", ()),  # names of columns that are not there
    ],
)
def test_dialects_are_taken_apart_alike(text, names):
    found = read_rows(Path("a.txt"), text.encode())
    assert found.rows == ROWS
    assert found.names == names
    assert found.notes == ()
    if "\r" not in text:
        lines = text.splitlines()
        assert all(
            row[0] in lines[n - 1].encode() for row, n in zip(found.rows, found.lines, strict=True)
        )


def test_text_of_two_bytes_a_letter():
    assert read_rows(Path("a.txt"), "1 2 3\n4 5 6\n".encode("utf-16")).rows == ROWS


@pytest.mark.parametrize(
    ("text", "notes"),
    [
        ("0,1,2\n1.5,2.0,3.25\n", 1),
        (",0,1,2\n0,1.5,2.0,3.25\n", 2),
        ("0\t1\t2\n1.5\t2.0\t3.25\n", 1),
    ],
)
def test_columns_that_are_numbered_have_no_names(text, notes):
    found = read_rows(Path("a.csv"), text.encode())
    assert (found.rows, found.names) == ([[b"1.5", b"2.0", b"3.25"]], ())
    assert len(found.notes) == notes


def test_a_row_that_counts_among_whole_numbers_is_a_point():
    assert len(read_rows(Path("a.csv"), b"0,1,2\n3,4,5\n").rows) == 2


@pytest.mark.parametrize("text", ["1,5;2,0;3,25\n", "1,5 2,0 3,25\n", "x;y;z\n1,5;2,0;3,25\n"])
def test_decimal_commas_are_said(text):
    found = read_rows(Path("a.csv"), text.encode())
    assert found.rows == [[b"1.5", b"2.0", b"3.25"]]
    assert found.notes == ("commas are taken for decimal points",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("# nothing\n", "a.pts holds nothing but comments"),
        ("x y z\n", "a.pts has no rows below its header"),
        ("3\n1 2 3\n4 5 6\n", "a.pts, line 1: '3' points are announced, 2 follow; the file is cut"),
        (
            "9" * 5000 + "\n1 2 3\n4 5 6\n",
            f"a.pts, line 1: '{'9' * 37}...' points are anno",
        ),
        ("1\n1 2 3\n4 5 6\n", "a.pts, line 3: there are more points than announced"),
        ("0\n1 2 3\n", "a.pts, line 2: there are more points than announced"),
        ("1 2 3\n4 5\n", "a.pts, line 2: the row has 2 cells, the first 3"),
        ("x,y,z\n1,2\n", "a.pts, line 2: the row has 2 cells, the header 3"),
    ],
)
def test_rows_and_counts_that_do_not_fit(text, message):
    with pytest.raises(ShapeError) as caught:
        read_rows(Path("a.pts"), text.encode())
    assert str(caught.value).startswith(message)
