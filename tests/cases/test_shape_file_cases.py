"""Files as other programs write them, on which moseg once failed: what each must come to.

All were made for this purpose. The good original is ``hammer.obj`` with ``hammer.seg``: area 86,
volume 29.5.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from moseg_core import Shape, load, read_labels
from moseg_core.cli import main
from moseg_core.io.read.glb_scene import read_glb
from moseg_core.io.write.glb import encode_glb

DATA = Path(__file__).parent / "data"
HAMMER = load(DATA / "hammer.obj")
CLOUD = load(DATA / "03e_numpy_header.csv")
COLORS = [[65, 112, 216], [216, 112, 65]]
#: What is said of every cloud.
CLOUDY = "encloses no volume: it is a point cloud"
INVALID = "points that are not finite: 15; they keep their rows and carry no weight"


def hammer_again(name: str) -> Shape:
    """A file of the hammer that differs from the original in its dialect only."""
    shape = load(DATA / name)
    np.testing.assert_allclose(shape.points, HAMMER.points, atol=1e-5)
    np.testing.assert_array_equal(shape.adjacency.indices, HAMMER.adjacency.indices)
    assert shape.area == pytest.approx(86.0)
    assert shape.volume == pytest.approx(29.5)
    return shape


def test_01_coordinates_that_are_zero_in_one_triangle_and_almost_in_the_next():
    shape = hammer_again("01_cad_zeros.stl")
    assert shape.adjacency.components()[0] == 1
    duplicates, near = shape.notes
    assert duplicates == "625 duplicate vertices, joined by position"
    assert near.startswith("3 vertices less than 1.3e-07 from another, joined with it (--weld 0")
    torn = shape.with_weld(0.0)
    assert torn.volume is None
    assert torn.geometry.merged.max() == shape.geometry.merged.max() + 3


def test_02_coordinates_of_a_map_lose_nothing_in_a_glb_file(tmp_path):
    shape = load(DATA / "02_utm.ply")
    labels = np.loadtxt(DATA / "hammer.seg", dtype=np.int64)
    path = tmp_path / "a.glb"
    path.write_bytes(encode_glb(shape.geometry, labels, ["handle", "head"], COLORS))
    again = read_glb(path)
    far, _ = cKDTree(shape.geometry.vertices).query(again.geometry.vertices)
    assert far.max() < 1e-7 * shape.frame.scale
    assert again.volume == pytest.approx(29.5, rel=1e-5)
    assert not any("no area" in note for note in again.notes)
    found = read_labels(path, shape)
    assert found.names == ("handle", "head")
    assert found.labels.tolist() == labels.tolist()


@pytest.mark.parametrize(
    ("name", "normals", "notes"),
    [
        ("03_part_annotation.xyz", True, ["passed over: column 7"]),
        ("03b_colour_and_scalar.xyz", False, ["passed over: columns 4, 5, 6, 7"]),
        ("03c_slash_header.csv", False, ["passed over: columns 'r', 'g', 'b'"]),
        ("03d_points.npy", False, []),
        ("03e_numpy_header.csv", False, []),
    ],
)
def test_03_columns_of_every_programs_own(name, normals, notes):
    shape = load(DATA / name)
    np.testing.assert_allclose(shape.points, CLOUD.points, atol=1e-5)
    assert shape.n_elements == 600
    assert (shape.geometry.normals is not None) == normals
    assert shape.notes == (*notes, CLOUDY)


@pytest.mark.parametrize("name", ["04_invalid_returns.ply", "04c_invalid_returns.xyz"])
def test_04_points_without_a_place_keep_their_rows(name):
    shape = load(DATA / name)
    invalid = shape.areas == 0.0
    assert (shape.n_elements, invalid.sum()) == (600, 15)
    assert shape.notes == (INVALID, CLOUDY)
    np.testing.assert_allclose(shape.points[~invalid], CLOUD.points[~invalid], atol=1e-5)


def test_04b_a_vertex_that_no_face_uses_may_be_anything():
    shape = hammer_again("04b_unused_nan_vertex.obj")
    assert shape.notes == ("vertices without a place, used by no face: 1; they are not looked at",)


def test_06_a_byte_behind_the_triangles():
    notes = hammer_again("06_one_byte_over.stl").notes
    assert notes[0] == "bytes behind the last triangle: 1; passed over"


def test_07_statements_of_other_programs():
    assert hammer_again("07_edge_lines.obj").notes == (
        "statement 'e' is unknown and passed over (378 times, first in line 381)",
    )


def test_14_a_skinned_mesh_stands_where_its_joints_are():
    shape = load(DATA / "14_skinned.glb")
    assert shape.area == pytest.approx(90.0)
    corners = shape.geometry.vertices
    np.testing.assert_allclose(corners.min(axis=0), [-11, -2.5, -1], atol=1e-6)
    np.testing.assert_allclose(corners.max(axis=0), [1, 2.5, 1], atol=1e-6)
    assert shape.notes[0].startswith("meshes with a skin: 2; read in the pose in which")


def test_what_was_passed_over_is_said_once_on_stderr_and_kept_in_the_result(tmp_path, capsys):
    kept = tmp_path / "a.json"
    words = ["segment", DATA / "04c_invalid_returns.xyz", "--labels", "handle,head"]
    words += ["--minimize", "narrow(handle)", "--seeder", "kmeans", "--restarts", "1"]
    words += ["--optimizer", "pattern_search(max_evaluations=20)", "--workers", "1", "-o", kept]
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    assert ended.value.code == 0
    assert capsys.readouterr().err.count(INVALID) == 1
    result = json.loads(kept.read_text())
    assert INVALID in result["shape"]["notes"]
    assert len(result["labels"]) == 600
