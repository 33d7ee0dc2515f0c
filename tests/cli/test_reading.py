"""From a file and the options on how to read it to a shape."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.cli.flags import ShapeFlags
from moseg_core.cli.reading import read_shape
from moseg_core.errors import ShapeError, UsageError


@pytest.fixture
def grid(tmp_path):
    path = tmp_path / "cube.npy"
    np.save(path, np.ones((3, 3, 3), bool))
    return path


@pytest.fixture
def cloud(tmp_path):
    """Corners and middles of a cube's edges and faces."""
    path = tmp_path / "cube.xyz"
    places = np.stack(np.meshgrid(*[np.arange(3.0)] * 3), axis=-1).reshape(-1, 3)
    np.savetxt(path, places[~(places == 1.0).all(axis=1)])
    return path


def test_without_options_a_shape_is_what_its_file_says(grid, cloud, open_box):
    assert read_shape(grid, ShapeFlags()).n_elements == 27
    assert read_shape(cloud, ShapeFlags()).adjacency is None
    assert read_shape(open_box, ShapeFlags()).volume is None


def test_cells_of_the_surface_alone(grid, cloud):
    shape = read_shape(grid, ShapeFlags(voxels="surface"))
    assert (shape.n_elements, shape.solid) == (26, False)
    assert read_shape(cloud, ShapeFlags(voxels="surface")).n_elements == 26  # nothing to clouds


def test_cells_have_the_sides_that_are_said(grid, cloud):
    assert read_shape(grid, ShapeFlags(pitch=".5,.5,3")).volume == pytest.approx(27 * 0.75)
    surface = read_shape(grid, ShapeFlags(pitch="2", voxels="surface"))
    assert (surface.n_elements, surface.volume, surface.area) == (26, 216.0, 216.0)
    assert surface.file == str(grid)
    with pytest.raises(ShapeError, match="only of a voxel grid can cells have a pitch"):
        read_shape(cloud, ShapeFlags(pitch="2"))


@pytest.mark.parametrize("words", ["", "1,2", "1,2,0", "-1", "wide", "1,2,nan", "inf"])
def test_a_pitch_that_is_none(grid, words):
    with pytest.raises(UsageError, match=r"--pitch is one positive number or three"):
        read_shape(grid, ShapeFlags(pitch=words))


def test_neighbours_and_a_volume_are_there_if_asked_for(cloud, open_box):
    assert read_shape(cloud, ShapeFlags(adjacency="knn")).adjacency is not None
    assert read_shape(open_box, ShapeFlags(adjacency="none")).adjacency is None
    assert read_shape(cloud, ShapeFlags(volume="hull")).volume == pytest.approx(8.0)
    assert read_shape(open_box, ShapeFlags(volume="2.5")).volume == 2.5


def test_which_way_is_up_is_what_the_user_says(moseg, cloud, open_box):
    assert read_shape(open_box, ShapeFlags()).up is None
    assert read_shape(cloud, ShapeFlags(up="-z", adjacency="knn")).up == "-z"
    for words in (["--up", "-z"], ["--up=-z"]):  # a value, not an option
        assert moseg("field", cloud, "no_such_field", *words).err.startswith("moseg: unknown field")
    assert '"-z"' in moseg("field", cloud, "thickness", "--up", "up").err


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(ShapeError, match="does not exist"):
        read_shape(tmp_path / "none.off", ShapeFlags())


def test_how_near_vertices_are_joined(tmp_path, cloud):
    path = tmp_path / "crack.off"
    corners = "0 0 0\n1 0 0\n0 1 0\n1 1e-6 0\n0 1 0\n1 1 0\n"
    path.write_text(f"OFF\n6 2 0\n{corners}3 0 1 2\n3 3 5 4\n")
    assert read_shape(path, ShapeFlags()).adjacency.components()[0] == 2
    assert read_shape(path, ShapeFlags(weld=1e-5)).adjacency.components()[0] == 1
    assert read_shape(cloud, ShapeFlags(weld=1e-5)).n_elements == 26  # nothing to clouds
