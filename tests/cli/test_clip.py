"""``moseg segment --clip``: the formats that show the surface, and those that do not."""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core import load
from moseg_core.io.labels import read_labels
from tests.clipping.checks import is_closed, polygon_areas

QUICK = ("--seeder", "kmeans", "--optimizer", "pattern_search(max_evaluations=30)")


def test_surfaces_are_clipped_and_labels_are_not(moseg, mallet, tmp_path):
    plain, smooth = (
        [tmp_path / f"{name}.{s}" for s in ("json", "seg", "ply", "glb", "png")]
        for name in ("plain", "smooth")
    )
    for outputs, more in ((plain, ()), (smooth, ("--clip",))):
        words = [word for output in outputs for word in ("-o", output)]
        run = moseg("segment", mallet, "--recipe", "paper_hammer", *QUICK, *words, *more)
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
    assert (rows["label"] == read_labels(smooth[2], ply).labels).all()
    per_face = np.bincount(rows["source"], polygon_areas(ply.geometry), shape.n_elements)
    np.testing.assert_allclose(per_face, shape.areas, rtol=1e-9)
    labels = np.array(json.loads(smooth[0].read_text())["labels"])
    pieces = np.bincount(rows["source"], minlength=shape.n_elements)
    assert (rows["label"] == labels[rows["source"]])[pieces[rows["source"]] == 1].mean() > 0.99


def test_refined_boundaries_are_refused_before_the_search(moseg, mallet):
    run = moseg("segment", mallet, "--recipe", "paper_hammer", "--clip", "--refiner", "graph_cut")
    assert run.code == 2
    assert "boundaries that the refiner 'core:graph_cut' of moseg-core" in run.err
    assert "(--refiner none)" in run.err
