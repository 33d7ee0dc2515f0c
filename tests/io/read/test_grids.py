"""Voxel grids from files: binvox against a writer by hand, arrays against numpy."""

from __future__ import annotations

import io
from itertools import groupby

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from moseg_core.io.read.grids import read_array, read_binvox, read_npy

GRIDS = arrays.arrays(bool, st.tuples(*[st.integers(1, 5)] * 3)).filter(np.any)


def npy(array, **options):
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def binvox(occupied, translate=(0, 0, 0), scale=1.0):
    """By hand: y fastest, then z, then x."""
    nx, ny, nz = occupied.shape
    values = [occupied[x, y, z] for x in range(nx) for z in range(nz) for y in range(ny)]
    data = bytearray()
    for value, run in groupby(values):
        left = len(list(run))
        while left:
            data += bytes([int(value), min(left, 255)])
            left -= min(left, 255)
    head = f"#binvox 1\ndim {nx} {ny} {nz}\ntranslate {' '.join(map(str, translate))}\n"
    return f"{head}scale {scale}\ndata\n".encode() + bytes(data)


BLOCK = np.ones((2, 2, 2), bool)
BINVOX = binvox(BLOCK)


@given(occupied=GRIDS)
def test_arrays_of_bool_and_of_numbers(occupied, as_file):
    for array in (occupied, occupied.astype(np.uint8) * 7, np.asfortranarray(occupied)):
        shape = read_npy(as_file("grid.npy", npy(array)))
        np.testing.assert_array_equal(shape.geometry.occupied, occupied)
        assert (shape.name, shape.noun, shape.solid) == ("grid", "cell", True)


@given(occupied=GRIDS)
def test_binvox_has_y_fastest(occupied, as_file):
    shape = read_binvox(as_file("grid.binvox", binvox(occupied, (1, -2, 3), 10.0)))
    np.testing.assert_array_equal(shape.geometry.occupied, occupied)
    pitch = 10.0 / max(occupied.shape)
    first = np.argwhere(occupied)[0]
    np.testing.assert_allclose(shape.points[0], [1, -2, 3] + pitch * (first + 0.5))
    assert shape.volume == pytest.approx(occupied.sum() * pitch**3)


def test_long_runs(as_file):
    occupied = np.zeros((10, 10, 10), bool)
    occupied[2:8] = True
    shape = read_binvox(as_file("long.binvox", binvox(occupied)))
    assert shape.n_elements == 600


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.ones((2, 2)), " holds an array of shape (2, 2); a voxel grid has three axes"),
        (np.ones((2, 2, 2)), " holds float64; save the grid as bool"),
        (-np.ones((2, 2, 2), int), " holds negative numbers"),
        (np.zeros((2, 2, 2), bool), ": none of the 8 cells of the grid is occupied"),
        (np.array(["a"]), " holds an array of shape (1,)"),
    ],
)
def test_arrays_that_are_no_grid(array, message, refusal):
    assert message in refusal(read_npy, "bad.npy", npy(array))


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", " is empty"),
        (b"PK\x03\x04", " is not an .npy file"),
        (npy(np.array([None], object), allow_pickle=True), " holds object, not numbers"),
        (npy(BLOCK)[:-1], " does not hold what an array of shape (2, 2, 2) takes; it is cut off"),
        (npy(BLOCK) + b"x", " does not hold what an array of shape (2, 2, 2) takes"),
    ],
)
def test_files_that_are_no_array(contents, message, refusal):
    assert message in refusal(read_array, "bad.npy", contents)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"OFF\n", " does not begin with '#binvox'"),
        (BINVOX.partition(b"data")[0], " has no line 'data' behind its header"),
        (BINVOX.replace(b"dim 2 2 2", b"dim 2 2"), " has no header line like 'dim 1 1 1'"),
        (BINVOX.replace(b"scale 1.0", b"scale x"), " has no header line like 'scale 1'"),
        (BINVOX.replace(b"scale 1.0", b"scale 0"), " has the scale 0"),
        (BINVOX.replace(b"dim 2", b"dim 0"), " has a grid of 0 x 2 x 2"),
        (BINVOX.replace(b"dim 2", b"dim 3"), " holds 8 cells instead of 12; it is cut off"),
        (BINVOX[:-1], " holds 0 cells instead of 8"),
        (binvox(BLOCK & False), ": none of the 8 cells"),
    ],
)
def test_malformed_binvox_files(contents, message, refusal):
    assert message in refusal(read_binvox, "bad.binvox", contents)


@pytest.mark.parametrize(
    ("reader", "contents"), [(read_npy, npy(BLOCK)), (read_binvox, binvox(BLOCK, (1, 2, 3), 2.0))]
)
def test_damaged_bytes_are_read_or_refused(reader, contents, damages):
    assert damages(reader, "bad", contents) > 20


@pytest.mark.parametrize(("reader", "contents"), [(read_npy, npy(BLOCK)), (read_binvox, BINVOX)])
def test_a_file_that_is_cut_off_is_never_read(reader, contents, accepted_cuts):
    assert accepted_cuts(reader, "cut", contents) == {}


@pytest.mark.parametrize("kind", ["f2", "f4", "f8", ">f8", "i4"])
def test_an_array_of_two_axes_is_a_cloud(kind, as_file):
    table = np.arange(20).reshape(5, 4).astype(kind)
    shape = read_npy(as_file("cloud.npy", npy(table)))
    np.testing.assert_array_equal(shape.points, table[:, :3])
    assert shape.notes[0] == "passed over: column 4"


def test_a_picture_of_points_is_a_cloud_row_by_row(as_file):
    picture = np.random.default_rng(0).random((4, 5, 3))
    picture[2, 3] = np.nan
    shape = read_npy(as_file("cloud.npy", npy(picture)))
    assert (shape.noun, shape.n_elements, np.flatnonzero(shape.areas == 0)) == ("point", 20, [13])
    assert shape.notes[0] == "4 x 5 points, row by row"


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.zeros((600, 2)), "a cloud of points the shape (N, 3), or more columns"),
        (np.zeros((3, 600)), "points are rows: save it transposed"),
        (np.zeros((4, 4), bool), "a voxel grid has three axes"),
        (np.zeros((4, 4, 4)), "save the grid as bool"),
        (np.full((4, 3), np.nan), "no point is finite"),
    ],
)
def test_arrays_that_are_neither(array, message, refusal):
    assert message in refusal(read_npy, "x.npy", npy(array))
