"""``moseg explain``: a result, and a labelling made by hand."""

from __future__ import annotations

import json

import pytest


def test_explain_a_result_equals_what_the_run_said(moseg, segmented):
    run = moseg("explain", segmented, "--json")
    told = json.loads(run.out)
    kept = json.loads(segmented.read_text())
    assert run.code == 0
    assert told["terms"] == kept["terms"]
    assert told["cost"] == kept["cost"]
    table = moseg("explain", segmented)
    for word in ("narrow", "perpendicular", "convex_parts", "handle, head", "total"):
        assert word in table.out


def test_explain_a_labelling_made_by_hand(moseg, mallet, segmented, tmp_path):
    kept = json.loads(segmented.read_text())
    seg = tmp_path / "mine.seg"
    seg.write_text("".join(f"{label}\n" for label in kept["labels"]))
    run = moseg("explain", mallet, "--recipe", "paper_hammer", "--parts", seg, "--json")
    assert json.loads(run.out)["cost"]["value"] == kept["cost"]["value"]
    # A result's labels are matched by name, whatever their order in the problem asked about.
    run = moseg(
        "explain",
        mallet,
        "--labels",
        "head,handle",
        "--minimize",
        kept["problem"]["minimize"],
        "--parts",
        segmented,
        "--json",
    )
    assert json.loads(run.out)["cost"]["value"] == pytest.approx(kept["cost"]["value"], rel=1e-12)


def test_explain_says_what_is_missing(moseg, mallet, segmented, tmp_path):
    assert moseg("explain", mallet).code == 2
    assert "--parts" in moseg("explain", mallet).err
    assert moseg("explain", segmented, "--recipe", "paper_hammer").code == 2
    other = tmp_path / "other.json"
    other.write_text("{}")
    run = moseg("explain", other)
    assert run.code == 2
    assert "not a moseg result" in run.err
    run = moseg(
        "explain", mallet, "--labels", "a,b", "--minimize", "narrow(a)", "--parts", segmented
    )
    assert run.code == 2
    assert "unknown label 'handle'" in run.err


def test_explain_of_a_labelling_with_an_empty_part(moseg, mallet, segmented, tmp_path):
    seg = tmp_path / "one.seg"
    seg.write_text("0\n" * len(json.loads(segmented.read_text())["labels"]))
    run = moseg("explain", mallet, "--recipe", "paper_hammer", "--parts", seg)
    assert run.code == 0
    assert "part 'head' is empty" in run.err
    assert "left out" in run.out
