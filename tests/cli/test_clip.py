"""``moseg segment --clip``: the formats that show the surface, and those that do not."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from moseg_core import Problem, Shape, clip, load, sample_path, save, segment
from moseg_core.errors import ShapeError
from moseg_core.io.read.ply import read_ply, read_ply_labels
from tests.clipping.checks import assert_valid, is_closed, polygon_areas

QUICK = ("--seeder", "kmeans", "--optimizer", "pattern_search(max_evaluations=30)")


@pytest.fixture(scope="module")
def found():
    """A sample hammer cut in two, quickly."""
    problem = Problem(["handle", "head"], "3*narrow(handle) + perpendicular(handle, head)")
    return segment(
        load(sample_path("hammer")), problem, optimizer="pattern_search(max_evaluations=40)"
    )


def test_surfaces_are_clipped_and_labels_are_not(moseg, mallet, tmp_path):
    plain, smooth = (
        [tmp_path / f"{name}.{s}" for s in ("json", "seg", "ply", "glb", "png")]
        for name in ("plain", "smooth")
    )
    for outputs, more in ((plain, ()), (smooth, ("--clip",))):
        words = [word for output in outputs for word in ("-o", output)]
        run = moseg("segment", mallet, "--recipe", "hammer", *QUICK, *words, *more)
        assert run.code == 0
        assert ("faces into" in run.err) == bool(more)
    for before, after in zip(plain, smooth, strict=True):
        same = before.read_bytes() == after.read_bytes()
        assert same == (before.suffix in (".json", ".seg"))

    shape, ply = load(mallet), load(smooth[2])
    assert is_closed(ply.geometry)
    assert ply.n_elements > shape.n_elements
    assert ply.volume == pytest.approx(shape.volume, rel=1e-9)
    data = smooth[2].read_bytes()
    assert b"property int label\nproperty int source\n" in data
    assert b"source" not in plain[2].read_bytes()
    # Every triangle row: a count, three corners, a colour, label and source.
    kind = np.dtype(
        [("n", "u1"), ("corners", "<i4", 3), ("rgb", "u1", 3), ("label", "<i4"), ("source", "<i4")]
    )
    rows = np.frombuffer(data[-ply.n_elements * kind.itemsize :], kind)
    assert (rows["label"] == read_ply_labels(smooth[2])).all()
    per_face = np.bincount(rows["source"], polygon_areas(ply.geometry), shape.n_elements)
    np.testing.assert_allclose(per_face, shape.areas, rtol=1e-9)
    labels = np.array(json.loads(smooth[0].read_text())["labels"])
    pieces = np.bincount(rows["source"], minlength=shape.n_elements)
    assert (rows["label"] == labels[rows["source"]])[pieces[rows["source"]] == 1].mean() > 0.99


def test_a_clipped_result_is_the_same_result(found, tmp_path):
    smooth = clip(found)
    assert found.clipped is None
    assert found.surface == (found.shape.geometry, found.labels)
    assert smooth.labels is found.labels
    assert smooth.cost == found.cost
    mesh, labels = smooth.surface
    assert mesh is smooth.clipped.mesh
    assert labels is smooth.clipped.labels
    assert_valid(found.shape.geometry, found.labels, smooth.clipped)
    save(smooth, tmp_path / "smooth.ply")
    geometry = read_ply(tmp_path / "smooth.ply").geometry
    assert (geometry.vertices == mesh.vertices).all()
    assert (geometry.corners == mesh.corners).all()


def test_in_another_space_that_space_is_asked(found, monkeypatch):
    twice = found.shape.deformed(2 * found.shape.geometry.vertices, space="twice")
    centers = replace(found.centers, positions=2 * found.centers.positions)
    there = clip(replace(found, centers=centers), space=twice)
    here = clip(found)
    monkeypatch.setattr(type(found), "partitioned", property(lambda result: twice))
    embedded = clip(replace(found, centers=centers))
    assert len(here.clipped.labels) > found.shape.n_elements
    for other in (there, embedded):
        assert (other.clipped.labels == here.clipped.labels).all()
        np.testing.assert_allclose(
            other.clipped.mesh.vertices, here.clipped.mesh.vertices, atol=1e-9
        )


def test_a_space_of_other_faces_is_refused(found):
    square = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    with pytest.raises(ShapeError, match="for each of 8410 polygons"):
        clip(found, space=square)
