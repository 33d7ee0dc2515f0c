"""Labels as arrays, of points and cells; and as points in a PLY file."""

from __future__ import annotations

import io
import zipfile

import numpy as np
import pytest

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.labels import read_labels
from moseg_core.io.read.ply import read_ply
from moseg_core.io.write.arrays import encode_npy, encode_npz
from moseg_core.io.write.ply import encode_points_ply
from moseg_core.shape.shape import Shape

NAMES = ("head", "left arm")
COLORS = [[1, 2, 3], [4, 5, 6]]
POINTS = np.array([[0.1, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
LABELS = [1, 0, 1, 1]


@pytest.fixture
def grid():
    occupied = np.zeros((2, 3, 2), bool)
    occupied[0, 0, 1] = occupied[0, 2, 0] = occupied[1, 1, 1] = occupied[1, 2, 0] = True
    return Shape.from_voxels(occupied, pitch=2.0)


@pytest.mark.parametrize("kind", ["points", "cells"])
def test_npz_can_be_used_without_the_shape(kind, grid, as_file):
    shape = grid if kind == "cells" else Shape.from_points(POINTS)
    data = encode_npz(shape, LABELS, NAMES)
    found = np.load(io.BytesIO(data))
    assert found["labels"].tolist() == LABELS
    assert found["names"].tolist() == list(NAMES)
    np.testing.assert_array_equal(found["points"], shape.points)
    np.testing.assert_array_equal(found["areas"], shape.areas)
    read = read_labels(as_file("x.npz", data), 4)
    assert (read.labels.tolist(), read.names) == (LABELS, NAMES)
    dates = {entry.date_time for entry in zipfile.ZipFile(io.BytesIO(data)).infolist()}
    assert dates == {(1980, 1, 1, 0, 0, 0)}  # nothing depends on when it was written


def test_npy_is_the_grid(grid, as_file):
    data = encode_npy(grid, LABELS, NAMES)
    found = np.load(io.BytesIO(data))
    assert found.shape == (2, 3, 2)
    assert found[0, 0, 1] == found[1, 1, 1] == found[1, 2, 0] == 1
    assert found[0, 2, 0] == 0
    assert (found == -1).sum() == 8
    read = read_labels(as_file("x.npy", data), 4)
    assert (read.labels.tolist(), read.names) == (LABELS, None)


def test_npy_is_for_grids_alone():
    with pytest.raises(UsageError, match=r"is a point cloud; an \.npy file holds.*\.npz does"):
        encode_npy(Shape.from_points(POINTS), LABELS, NAMES)


@pytest.mark.parametrize("normals", [None, np.arange(12.0).reshape(4, 3)])
def test_a_cloud_goes_through_ply(normals, as_file):
    shape = Shape.from_points(POINTS, normals=normals)
    path = as_file("x.ply", encode_points_ply(shape, LABELS, NAMES, COLORS))
    again = read_ply(path)
    np.testing.assert_array_equal(again.points, POINTS)
    if normals is None:
        assert again.geometry.normals is None
    else:
        np.testing.assert_array_equal(again.geometry.normals, normals)
    read = read_labels(path, 4)
    assert (read.labels.tolist(), read.names) == (LABELS, NAMES)


def test_cells_are_points_in_ply(grid, as_file):
    path = as_file("x.ply", encode_points_ply(grid, LABELS, NAMES, COLORS))
    np.testing.assert_array_equal(read_ply(path).points, grid.points)
    assert read_labels(path, 4).labels.tolist() == LABELS


@pytest.mark.parametrize("encode", [encode_npz, encode_npy])
def test_labels_that_do_not_fit(encode, grid):
    with pytest.raises(ShapeError, match="each of the 4 cells"):
        encode(grid, [0, 1], NAMES)
    with pytest.raises(ShapeError, match="cell 3 has the label 2"):
        encode(grid, [0, 1, 0, 2], NAMES)


@pytest.mark.parametrize(
    ("name", "contents", "message"),
    [
        ("x.npz", b"PK\x03\x04", " is no whole .npz file ("),
        ("x.npz", b"text", " is no whole .npz file ("),
        ("x.npz", {"parts": [1]}, " has 1 labels but the shape has 4 elements"),
        ("x.npz", {"p": [1] * 4, "q": [1] * 4}, " has no array 'labels' but p, q; say which holds"),
        ("x.npz", {"labels": [0.5] * 4}, " gives element 0 the label 0.5; labels are whole"),
        ("x.npz", {"labels": [0] * 4, "names": [[1]]}, " has an array 'names' that is not"),
        ("x.npz", {"labels": [0] * 3}, " has 3 labels but the shape has 4 elements"),
        ("x.npy", np.zeros((2, 2), int), " holds int64 of shape (2, 2) instead of a row"),
        ("x.npy", np.zeros((2, 2, 2), int), " has 8 labels but the shape has 4 elements"),
    ],
)
def test_files_without_labels(name, contents, message, refusal):
    if not isinstance(contents, bytes):
        stream = io.BytesIO()
        if isinstance(contents, dict):
            np.savez(stream, **{key: np.array(value) for key, value in contents.items()})
        else:
            np.save(stream, contents)
        contents = stream.getvalue()
    assert message in refusal(lambda path: read_labels(path, 4), name, contents)
