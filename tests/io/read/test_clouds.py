"""Point clouds from text files: what is read, and what is refused with the line it stands on."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.io.read.clouds import read_points, shape_from_table

NUMBER = st.floats(-1e6, 1e6, allow_nan=False)
POINTS = st.lists(st.tuples(NUMBER, NUMBER, NUMBER), min_size=2, max_size=9, unique=True)
XYZ = "0 0 0\n1 0 0\n0 1 0\n"
CSV = "x,y,z\n0,0,0\n1,0,0\n0,1,0\n"


def spread_out(points):
    return np.ptp(np.array(points), axis=0).max() > 1e-3


@given(points=POINTS.filter(spread_out))
def test_round_trip(points, as_file):
    text = "".join(f"{x!r} {y!r}\t{z!r}\n" for x, y, z in points)
    shape = read_points(as_file("dots.xyz", text.encode()))
    np.testing.assert_array_equal(shape.points, points)
    assert (shape.name, shape.noun, shape.geometry.normals) == ("dots", "point", None)
    table = "x,y,z\n" + "".join(f"{x!r},{y!r}, {z!r}\n" for x, y, z in points)
    np.testing.assert_array_equal(read_points(as_file("dots.csv", table.encode())).points, points)


@pytest.mark.parametrize(
    "text", [XYZ, "# dots\n" + XYZ, XYZ.replace("\n", "\r\n"), "\n" + XYZ + " \n", XYZ[:-1]]
)
def test_variants_read_alike(text, as_file):
    np.testing.assert_array_equal(
        read_points(as_file("x.xyz", text.encode())).points, [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    )


@pytest.mark.parametrize(
    ("columns", "normals"),
    [("0 0 1", True), ("0 0.6 0.79", True), ("255 0 17", False), ("0 0 0", False)],
)
def test_three_more_numbers_are_normals_if_they_look_like_it(columns, normals, as_file):
    text = XYZ.replace("\n", f" {columns}\n").encode()
    for shape in (
        read_points(as_file("x.xyz", text)),
        read_points(as_file("x.csv", text.replace(b" ", b","))),
    ):
        found = shape.geometry.normals
        assert (found is not None) == normals
        if normals:
            np.testing.assert_array_equal(found, [[float(n) for n in columns.split()]] * 3)


def test_named_columns_in_any_order_and_among_others(as_file):
    text = '"Area";id;z;y;x;nx;ny;nz\n2;a;0;0;0;9;0;0\n4;b;0;0;1;9;0;0\n6;c;0;1;0;9;0;0\n'
    shape = read_points(as_file("x.csv", text.encode()))
    assert shape.areas.tolist() == [2.0, 4.0, 6.0]
    np.testing.assert_array_equal(shape.points, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    np.testing.assert_array_equal(shape.geometry.normals, [[9, 0, 0]] * 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", " is empty"),
        ("# nothing\n", " holds nothing but comments"),
        ("3\nname\n" + XYZ, ", line 3: the row has 3 cells, the first 1; it is cut off"),
        ("0 1\n", ", line 1: expected x y z in the first columns, found 2 words that"),
        (XYZ + "1 2\n", ", line 4: the row has 2 cells, the first 3"),
        (XYZ + "1 2 x\n", ", line 4: 'x' is not a number"),
        (XYZ + "1 2 3 4\n", ", line 4: the row has 4 cells, the first 3"),
        ("nan nan nan\n0 1 nan\n", ": no point is finite"),
        (XYZ + "1 2 1e60\n", " has point 3 at [1.0, 2.0, 1e+60], beyond what can be"),
        ("1 2 3\n1 2 3\n", ": all points are in one place"),
        ("x,y\n1,2\n", " has no column 'z' among 'x', 'y'; name its columns x, y, z"),
        ("x,y,z\n", " has no rows below its header"),
        (CSV + "1,2\n", ", line 5: the row has 2 cells, the header 3"),
        (CSV + "1,2,", ", line 5: the last row is cut off"),
        ("x,y,z,area\n0,0,0,1\n1,0,0,-1\n", ": areas of points must not be negative"),
        ("a,b,c\n0,0,0\n", " has no column 'x' among 'a', 'b', 'c'"),
    ],
)
def test_malformed_files_are_refused(text, message, refusal):
    assert message in refusal(read_points, "bad.csv", text)


@pytest.mark.parametrize("text", [XYZ * 3, CSV])
def test_damaged_bytes_are_read_or_refused(text, damages):
    assert damages(read_points, "bad.xyz", text.encode()) > 20


def test_a_missing_value_makes_a_point_without_weight(as_file):
    for missing in ("", "NaN", "NULL", "-nan(ind)", "1.#QNAN"):
        shape = read_points(as_file("x.csv", CSV + f"1,{missing},1\n"))
        assert shape.areas[3] == 0.0 < shape.areas[:3].min()
        assert shape.notes[0].startswith("points that are not finite: 1;")


def test_a_table_of_numbers_is_a_file_without_names(tmp_path):
    table = np.arange(20.0).reshape(4, 5)
    shape = shape_from_table(tmp_path / "x.npy", table, notes=["a note"])
    np.testing.assert_array_equal(shape.points, table[:, :3])
    assert shape.notes[:2] == ("a note", "passed over: columns 4, 5")
