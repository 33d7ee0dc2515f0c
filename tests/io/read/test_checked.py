from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, read_file, shape_from_polygons


@given(data=st.data())
def test_polygons_arrive_as_they_are(data, tmp_path_factory, polygon_meshes, polygons_of):
    vertices, faces = data.draw(polygon_meshes)
    corners = np.concatenate([np.array(face) for face in faces])
    offsets = np.concatenate([[0], np.cumsum([len(face) for face in faces])])
    shape = shape_from_polygons(
        tmp_path_factory.getbasetemp() / "x.y.obj", vertices, corners, offsets
    )
    assert shape.name == "x.y"
    assert polygons_of(shape) == faces


@pytest.mark.parametrize(
    ("far", "message"),
    [
        (
            [0, 0, -1e51],
            r"^a\.obj has vertex 1 at \[0\.0, 0\.0, -1e\+51\], beyond what can be meas",
        ),
        ([np.nan, 0, 1e51], r"^a\.obj has vertex 1 at \[nan, 0\.0, 1e\+51\], beyond"),
        ([np.inf, 0, np.nan], r"^a\.obj: vertex 1 is not finite"),
    ],
)
def test_coordinates_that_no_square_can_hold(far, message, tmp_path):
    vertices = np.array([[0, 0, 0], far, [0, 1, 0]], float)
    with pytest.raises(ShapeError, match=message):
        shape_from_polygons(tmp_path / "a.obj", vertices, np.arange(3), np.array([0, 3]))


def test_coordinates_of_single_precision_can_be_measured(tmp_path):
    largest = float(np.finfo(np.float32).max)
    vertices = np.array([[0, 0, 0], [largest, 0, 0], [0, -largest, 0]])
    shape = shape_from_polygons(tmp_path / "a.stl", vertices, np.arange(3), np.array([0, 3]))
    assert np.isfinite(shape.second_moments).all()


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(ShapeError, match=r"^gone cannot be read \(No such file or directory\)"):
        read_file(tmp_path / "gone")
    with pytest.raises(ShapeError, match=r" cannot be read \(it is a folder, not a file\)"):
        read_file(tmp_path)
    (tmp_path / "blank").write_bytes(b"\n \r\n")
    with pytest.raises(ShapeError, match=r"^blank is empty; export it again$"):
        read_file(tmp_path / "blank")


def test_errors_name_the_file_and_the_line(tmp_path):
    assert str(file_error(tmp_path / "a.off", "is odd")) == "a.off is odd"
    assert (
        str(file_error(tmp_path / "a.off", "this is odd", line=3)) == "a.off, line 3: this is odd"
    )
