"""The formats of results: which surface each shows, and that its labels come back."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.clipping.clip import Clipped
from moseg_core.errors import UsageError
from moseg_core.io.labels import read_labels
from moseg_core.io.read.ply import read_ply
from moseg_core.io.write.formats import (
    check_writable,
    write_glb,
    write_npy,
    write_npz,
    write_ply,
    write_seg,
)
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from tests.results import result_on


@pytest.fixture
def cloud():
    return Shape.from_points(np.random.default_rng(0).random((20, 3)), name="cloud")


@pytest.fixture
def grid():
    return Shape.from_voxels(np.ones((2, 3, 2), bool), name="grid")


@pytest.mark.parametrize("kind", ["box", "cloud", "grid"])
def test_labels_come_back_from_every_format_that_holds_them(kind, as_file, request):
    result = result_on(request.getfixturevalue(kind))
    for suffix, write in ((".seg", write_seg), (".ply", write_ply), (".npz", write_npz)):
        path = as_file(f"x{suffix}", write(result))
        assert read_labels(path, len(result.labels)).labels.tolist() == result.labels.tolist()


def test_a_mesh_stays_a_mesh_and_other_shapes_are_points_in_ply(box, cloud, as_file):
    assert read_ply(as_file("box.ply", write_ply(result_on(box)))).geometry.kind == "polygon mesh"
    path = as_file("cloud.ply", write_ply(result_on(cloud)))
    assert read_ply(path).geometry.kind == "point cloud"
    assert read_labels(path, cloud).names == ("first", "second")


def test_a_clipped_result_shows_its_pieces(box, as_file):
    pieces = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    clipped = Clipped(mesh=pieces, labels=np.array([1]), source=np.array([5]))
    result = result_on(box, clipped=clipped)
    found = read_ply(as_file("x.ply", write_ply(result))).geometry
    np.testing.assert_array_equal(found.vertices, pieces.vertices)
    # Labels are those of the input's faces, clipped or not.
    assert write_seg(result) == write_seg(result_on(box))
    assert write_glb(result) != write_glb(result_on(box))


def test_a_grid_is_asked_for_before_the_search_and_after_it(box, grid):
    check_writable(".npy", grid)
    check_writable(".ply", box)
    for suffix in (".npy", ".NPY"):
        with pytest.raises(UsageError, match=r"an \.npy file"):
            check_writable(suffix, box)
    with pytest.raises(UsageError, match=r"an \.npy file"):
        write_npy(result_on(box))
    assert write_npy(result_on(grid)).startswith(b"\x93NUMPY")
