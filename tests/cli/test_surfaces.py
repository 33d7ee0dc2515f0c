"""Point clouds, voxel grids and soups on the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy import ndimage

from moseg_core.io.labels import read_labels

QUICK = ("--optimizer", "pattern_search(max_evaluations=20)", "--seeder", "kmeans")


@pytest.fixture
def cloud(tmp_path):
    """A ball of points, with normals."""
    points = np.random.default_rng(0).normal(size=(400, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    path = tmp_path / "ball.xyz"
    np.savetxt(path, np.hstack([points, points]))
    return path


@pytest.fixture
def grid(tmp_path):
    """A T of cells."""
    occupied = np.zeros((9, 3, 12), bool)
    occupied[:, :, 9:] = occupied[3:6] = True
    path = tmp_path / "tee.npy"
    np.save(path, occupied)
    return path


def test_a_cloud_from_file_to_files(moseg, cloud, tmp_path):
    outputs = [tmp_path / f"x{suffix}" for suffix in (".ply", ".npz", ".json", ".seg", ".png")]
    words = [word for output in outputs for word in ("-o", output)]
    run = moseg(
        "segment", cloud, "--labels", "a,b", "--minimize", "ellipsoidal(a) + convex_parts",
        "--adjacency", "knn", "--volume", "winding", *QUICK, *words,
    )  # fmt: skip
    assert run.code == 0
    assert "the 10 nearest points count as neighbours" in run.err
    assert "the enclosed volume is taken to be 4." in run.err
    assert "points" in run.out.splitlines()[0]
    notes = json.loads(outputs[2].read_text())["shape"]["notes"]
    assert any(note.startswith("the enclosed volume is taken to be 4.") for note in notes)
    labels = [read_labels(output, 400).labels.tolist() for output in outputs[:4]]
    assert labels == [labels[0]] * 4
    run = moseg("evaluate", cloud, outputs[0], outputs[1], "--json")
    mean = json.loads(run.out)["mean"]
    assert mean["rand_index_error"] == 0.0
    assert mean["cut_discrepancy"] is None
    options = ("--volume", "hull", "--labels", "a,b", "--minimize", "convex_parts")
    assert moseg("explain", cloud, "--parts", outputs[1], *options).code == 0


@pytest.mark.parametrize("voxels", ["solid", "surface"])
def test_a_grid_from_file_to_files(moseg, grid, tmp_path, voxels):
    outputs = [tmp_path / f"x{suffix}" for suffix in (".npy", ".npz", ".ply", ".glb", ".json")]
    words = [word for output in outputs for word in ("-o", output)]
    minimize = "narrow(stem) + convex_parts"
    run = moseg(
        "segment", grid, "--labels", "stem,bar", "--minimize", minimize, "--voxels", voxels,
        *QUICK, *words,
    )  # fmt: skip
    assert run.code == 0
    assert run.out.splitlines()[0].split() == [
        "part",
        "cells",
        "volume" if voxels == "solid" else "area",
    ]
    labels = np.load(outputs[0])
    occupied = np.load(grid)
    assert labels.shape == occupied.shape
    assert (labels[~occupied] == -1).all()
    inner = ndimage.binary_erosion(occupied) & (voxels == "surface")
    np.testing.assert_array_equal(labels == -1, ~occupied | inner)
    run = moseg("evaluate", grid, *outputs[:3], "--voxels", voxels, "--json")
    assert json.loads(run.out)["mean"]["rand_index_error"] == 0.0


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("--minimize", "convex_parts"), 3, "'convex_parts' needs an enclosed volume, but 'ball'"
         " encloses none: it is a point cloud; leave out the term or have it estimated (--volume"),
        (("--minimize", "planar_symmetric(a)"), 3, "'planar_symmetric' needs a surface, but 'ball'"
         " is a point cloud; leave out the term"),
        (("--minimize", "convex(a)"), 3, "'convex' needs a surface"),
        (("--minimize", "axial_symmetric(a)"), 3, "'axial_symmetric' needs a surface"),
        (("--minimize", "narrow(a)", "-o", "x.npy"), 2, "'ball' is a point cloud; an .npy file"),
        (("--minimize", "narrow(a)", "--clip"), 3, "boundaries can be clipped on a mesh only"),
        (("--minimize", "narrow(a)", "--embedding", "mds"), 3, "'ball' is a point cloud; only a"
         " polygon mesh can be unfolded"),
        (("--minimize", "narrow(a)", "--constraint", "mirror(b, a)"), 3, "'ball' is a point cloud,"
         " which has no faces"),
        (("--minimize", "narrow(a)", "--volume", "hul"), 2, "a volume is a positive number"),
        (("--minimize", "narrow(a)", "--adjacency", "kn"), 2, "knn"),
        (("--minimize", "narrow(a)", "--voxels", "cells"), 2, "surface"),
    ],
)  # fmt: skip
def test_what_a_cloud_lacks_is_said_before_the_search(
    moseg, cloud, tmp_path, monkeypatch, words, code, message
):
    monkeypatch.chdir(tmp_path)
    run = moseg("segment", cloud, "--labels", "a,b", *words)
    assert run.code == code
    assert message in run.err
    assert not list(tmp_path.glob("x.*"))


def test_symmetry_of_a_solid_is_refused_and_of_its_surface_not(moseg, grid):
    words = ("segment", grid, "--labels", "a,b", "--minimize", "planar_symmetric(a)", *QUICK)
    run = moseg(*words)
    assert run.code == 3
    assert "the cells of 'tee' fill a solid; leave out the term or read the surface" in run.err
    assert moseg(*words, "--voxels", "surface").code == 0
