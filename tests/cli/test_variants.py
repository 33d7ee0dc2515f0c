"""Recipes whose labels have counts, on the command line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core import load, save_labels
from moseg_core.cli.recipes import how_many
from moseg_core.problem.recipe import parse_recipe

QUICK = ("--seeder", "kmeans", "--optimizer", "pattern_search(max_evaluations=20)")
FEW = (*QUICK, "--restarts", "1", "--workers", "1")


@pytest.fixture
def recipe(tmp_path):
    path = tmp_path / "mallet.toml"
    path.write_text(
        'labels = ["handle", "head", "strap{0..2}"]\n'
        'minimize = "narrow(handle) + is(head, area=0.4+-0.1) + is(strap*, area=0.1+-0.01)'
        ' + similar(strap*)"\n'
    )
    return path


def test_all_label_sets_are_tried_and_what_they_came_to_is_told(moseg, mallet, recipe, tmp_path):
    out = tmp_path / "m.json"
    run = moseg("segment", mallet, "--recipe", recipe, *FEW, "-o", out)
    assert run.code == 0, run.err
    kept = json.loads(out.read_text())
    names = kept["problem"]["labels"]
    straps = len(names) - 2
    chosen = ", ".join(["handle", "head", *([f"strap{{{straps}}}"] if straps else [])])
    assert f"chosen among 3 label sets: {chosen}" in run.err
    for text in ("handle, head", "handle, head, strap{1}", "handle, head, strap{2}"):
        assert f"labels {text}" in kept["history"]
        assert f"\n{text} " in run.out
    assert "variants" not in kept["problem"]
    told = json.loads(moseg("segment", mallet, "--recipe", recipe, *FEW, "--json").out)
    sets = told["label_sets"]
    assert min(sets, key=lambda text: (sets[text]["empty"], sets[text]["typical cost"])) == chosen
    # It is a result like any other.
    assert moseg("explain", out).code == 0
    assert moseg("segment", mallet, "--start", out, *QUICK).code == 0
    assert moseg("plot", out, "-o", tmp_path / "m.svg").code == 0


@pytest.mark.parametrize(
    ("labels", "names", "minimize"),
    [
        ("handle,head,strap{1}", ["handle", "head", "strap1"], "is(strap*, area=0.1+-0.01)"),
        ("head,strap{1}", ["head", "strap1"], "is(head, area=0.4+-0.1) + is(strap*"),
    ],
)
def test_labels_name_one_label_set(moseg, mallet, recipe, tmp_path, labels, names, minimize):
    out = tmp_path / "m.json"
    run = moseg("segment", mallet, "--recipe", recipe, "--labels", labels, *FEW, "-o", out)
    assert run.code == 0, run.err
    assert "chosen among" not in run.err
    problem = json.loads(out.read_text())["problem"]
    assert problem["labels"] == names
    assert minimize in problem["minimize"]
    assert "similar" not in problem["minimize"]
    assert (
        "label_sets"
        not in moseg(
            *("segment", mallet, "--recipe", recipe, "--labels", labels, *FEW, "--json")
        ).out
    )


def test_labels_with_counts_narrow_what_is_tried(moseg, mallet, recipe):
    run = moseg(
        *("segment", mallet, "--recipe", recipe, "--labels", "handle,head,strap{1..2}", *FEW)
    )
    assert "chosen among 2 label sets" in run.err


def test_labels_that_are_not_declared_replace_the_recipe_s(moseg, mallet, recipe):
    run = moseg("segment", mallet, "--recipe", recipe, "--labels", "handle,head,claw", *FEW)
    assert run.code == 2
    assert "'strap*' matches none of the labels handle, head, claw" in run.err


def test_counts_without_a_recipe(moseg, mallet):
    run = moseg("segment", mallet, "--labels", "a,b{1..2}", "--minimize", "compact(*)", *FEW)
    assert run.code == 0, run.err
    assert "chosen among 2 label sets" in run.err
    run = moseg("segment", mallet, "--labels", "a,b{1..2}", "--minimize", "convex_parts", *FEW)
    assert run.code == 2
    assert "says nothing of single parts" in run.err


def test_what_is_known_of_the_shape_leaves_out_label_sets(moseg, mallet, recipe, tmp_path):
    given = ("segment", mallet, "--recipe", recipe, *QUICK[2:], "--workers", "1")
    assert "chosen among 2 label sets" in moseg(*given, "--pin", "strap1=0").err
    run = moseg(*given, "--pin", "strip1=0")
    assert run.code == 2
    assert "--pin and --freeze: unknown label 'strip1'; did you mean 'strap1'?" in run.err
    first = tmp_path / "first.json"
    run = moseg(*given, "--centers", "handle=0,0,-3,head=0,0,3", "-o", first)
    assert run.code == 0, run.err
    assert json.loads(first.read_text())["problem"]["labels"] == ["handle", "head"]
    run = moseg(*given, "--start", first)
    assert run.code == 0, run.err
    assert "chosen among" not in run.err


def test_parts_says_what_counts_say(moseg, mallet, recipe):
    run = moseg("segment", mallet, "--recipe", recipe, "--parts", "3", *FEW)
    assert run.code == 2
    assert "say which numbers of parts are tried; do not say how many" in run.err


def test_explain_takes_the_label_set_of_the_labelling(moseg, mallet, recipe, tmp_path):
    shape = load(mallet)
    order = np.argsort(shape.points[:, 2]).argsort()
    labels = (order * 3 // shape.n_elements).astype(np.int64)
    named, bare = tmp_path / "named.txt", tmp_path / "bare.seg"
    save_labels(labels, named, names=["handle", "head", "strap1"])
    save_labels(labels, bare)
    for parts in (named, bare):
        run = moseg("explain", mallet, "--recipe", recipe, "--parts", parts, "--json")
        assert run.code == 0, run.err
        assert "label set: handle, head, strap{1}" in run.err
        terms = [term["term"] for term in json.loads(run.out)["terms"]]
        assert terms == [
            *("narrow(handle)", "is(head, area=0.4+-0.1)", "is(strap*, area=0.1+-0.01)")
        ]
    save_labels(labels, named, names=["handle", "head", "strip"])
    run = moseg("explain", mallet, "--recipe", recipe, "--parts", named)
    assert run.code == 2
    assert "unknown label 'strip'" in run.err
    save_labels(np.minimum(labels, 0), bare)
    run = moseg("explain", mallet, "--recipe", recipe, "--parts", bare)
    assert "the labelling has 1 labels without names, and no label sets have as many" in run.err


def test_how_many_parts_a_recipe_has():
    for labels, text in (('["a", "b{2..4}"]', "3 to 5"), ('["a", "b{3}"]', "4"), ('["a*"]', "any")):
        recipe = parse_recipe(f'labels = {labels}\nminimize = "narrow(*)"', "mine")
        assert how_many(recipe) == text
