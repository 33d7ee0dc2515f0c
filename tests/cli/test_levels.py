"""Recipes of several levels on the command line: segment, explain, evaluate, start and plot."""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core import Hierarchy, Problem, load
from moseg_core.io import encode_named_labels

RECIPE = """
labels = ["handle", "head"]
minimize = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"

[parts.head]
labels = ["left", "right"]
minimize = "compact(left, right)"
optimizer = "pattern_search(max_evaluations=30)"
"""
PATHS = ("handle", "head/left", "head/right")


@pytest.fixture
def recipe(tmp_path):
    path = tmp_path / "two.toml"
    path.write_text(RECIPE)
    return path


@pytest.fixture
def truth(mallet, tmp_path):
    """The mallet's true parts, as a .txt file with paths."""
    places = load(mallet).points
    labels = np.where(places[:, 0] < 1.8, 0, np.where(places[:, 2] < 0, 1, 2))
    path = tmp_path / "truth.txt"
    path.write_bytes(encode_named_labels(labels, PATHS))
    return path


def test_segments_writes_and_explains_all_levels(moseg, mallet, recipe, truth, tmp_path):
    outputs = [tmp_path / f"m.{suffix}" for suffix in ("json", "ply", "glb", "seg", "png")]
    words = [word for output in outputs for word in ("-o", output)]
    run = moseg("segment", mallet, "--recipe", recipe, "--restarts", 2, *words)
    assert run.code == 0, run.err
    assert "head/left" in run.out
    assert "head: compact" in run.out
    assert "head: the search ended on its limit (evaluations)" in run.err
    told = json.loads(outputs[0].read_text())
    assert tuple(told["problem"]["labels"]) == PATHS
    assert [level["path"] for level in told["problem"]["levels"]] == ["", "head"]
    assert told["cost"]["value"] == pytest.approx(sum(t["weighted"] for t in told["terms"]))

    explained = moseg("explain", outputs[0])
    assert explained.code == 0
    rows = [line.split() for line in explained.out.splitlines()]
    assert ["head:", "compact", "head/left"] in [row[:3] for row in rows]
    assert float(rows[-1][1]) == pytest.approx(told["cost"]["value"], abs=1e-6)

    agreed = json.loads(moseg("evaluate", mallet, outputs[0], truth, "--json").out)
    assert set(agreed["truths"][0]["confusion"]["given_names"]) == set(PATHS)
    assert moseg("plot", outputs[0], "-o", tmp_path / "m.svg").code == 0

    refused = moseg("segment", mallet, "--recipe", recipe, "--start", outputs[0])
    assert refused.code == 2
    assert "is a result of several levels" in refused.err


def test_explains_a_labelling_by_its_paths(moseg, mallet, recipe, truth):
    run = moseg("explain", mallet, "--recipe", recipe, "--parts", truth, "--json")
    assert run.code == 0
    told = json.loads(run.out)
    shape = load(mallet)
    places = shape.points
    task = Hierarchy(
        Problem(
            ["handle", "head"], "3*narrow(handle) + perpendicular(handle, head) + convex_parts"
        ),
        {"head": Problem(["left", "right"], "compact(left, right)")},
    )
    labels = np.where(places[:, 0] < 1.8, 0, np.where(places[:, 2] < 0, 1, 2))
    found = task.evaluate(shape, labels)
    assert told["cost"]["value"] == pytest.approx(found.cost.value, rel=1e-12)
    assert [term["term"] for term in told["terms"]] == [term.text for term in found.terms]


def test_explains_a_labelling_that_leaves_a_part_whole(moseg, mallet, recipe, tmp_path):
    places = load(mallet).points
    path = tmp_path / "whole.txt"
    path.write_bytes(encode_named_labels((places[:, 0] >= 1.8).astype(int), ("handle", "head")))
    run = moseg("explain", mallet, "--recipe", recipe, "--parts", path, "--json")
    assert run.code == 0
    assert [term["term"] for term in json.loads(run.out)["terms"]][-1] == "convex_parts"
    path.write_bytes(
        encode_named_labels((places[:, 0] >= 1.8).astype(int), ("handle", "head/lift"))
    )
    wrong = moseg("explain", mallet, "--recipe", recipe, "--parts", path)
    assert wrong.code == 2
    assert "unknown label 'head/lift'; did you mean 'head/left'?" in wrong.err


def test_mistakes_are_told_before_the_shape_is_read(moseg, tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text(RECIPE.replace("parts.head", "parts.haed"))
    run = moseg("segment", tmp_path / "missing.off", "--recipe", path)
    assert run.code == 2
    assert "unknown label 'haed'; did you mean 'head'?" in run.err
    path.write_text(RECIPE.replace("compact(", "compct("))
    run = moseg("segment", tmp_path / "missing.off", "--recipe", path)
    assert run.code == 2
    assert "did you mean 'compact'" in run.err
    path.write_text(RECIPE.replace("pattern_search(max", "pattern_search(mix"))
    run = moseg("segment", tmp_path / "missing.off", "--recipe", path)
    assert run.code == 2
    assert "max_evaluations" in run.err


def test_levels_are_not_clipped(moseg, mallet, recipe):
    run = moseg("segment", mallet, "--recipe", recipe, "--clip")
    assert run.code == 2
    assert "results of one level only" in run.err


def test_other_labels_do_not_fit_the_parts(moseg, mallet, recipe):
    run = moseg("segment", mallet, "--recipe", recipe, "--labels", "handle,top")
    assert run.code == 2
    run = moseg("segment", mallet, "--recipe", recipe, "--labels", "a,b", "--minimize", "narrow(a)")
    assert run.code == 2
    assert "parts: unknown label 'head'" in run.err
