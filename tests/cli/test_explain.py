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


def test_what_disagrees_most_is_named_of_a_result_and_of_a_labelling(moseg, mallet, tmp_path):
    recipe, out = tmp_path / "mine.toml", tmp_path / "mine.json"
    recipe.write_text(
        'labels = ["handle", "head"]\n'
        'minimize = "is(handle, given=handle) + is(head, area=0.01+-0.001) + narrow(handle)"\n'
        "[given.handle]\n"
        'area = "0.99+-0.001"\n'
        'offcenter = "0.25+-5"\n'
    )
    made = moseg("segment", mallet, "--recipe", recipe, "--restarts", 1, "-o", out)
    assert made.code == 0, made.err
    told = moseg("explain", out)
    again = moseg("explain", mallet, "--recipe", recipe, "--parts", out)
    lines = told.out[told.out.index("what disagrees most in each part:") :].splitlines()
    assert lines == again.out[again.out.index("what disagrees") :].splitlines()
    assert "\n".join(lines) in made.out
    assert [line.split(" %, ")[1] for line in lines[1:]] == [
        "typical 99.0 ± 0.1",
        "typical 1.0 ± 0.1",
    ]
    assert [line.rpartition(" %, ")[0].split()[:2] for line in lines[1:]] == [
        ["handle:", "area"],
        ["head:", "area"],
    ]
    calls = json.loads(moseg("explain", out, "--json").out)["terms"][0]["calls"]
    assert [detail["name"] for detail in calls[0]["details"]] == ["area", "offcenter"]
    assert [detail["expected"] for detail in calls[0]["details"]] == ["0.99+-0.001", "0.25+-5"]


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


def test_faces_without_a_label_count_as_the_nearest(moseg, mallet, segmented, tmp_path):
    labels = json.loads(segmented.read_text())["labels"]
    partly = tmp_path / "partly.seg"
    partly.write_text(
        "".join(f"{-1 if k % 40 == 5 else label}\n" for k, label in enumerate(labels))
    )
    asked = ("explain", mallet, "--recipe", "paper_hammer", "--json", "--parts")
    whole, run = moseg(*asked, segmented), moseg(*asked, partly)
    missing = len(range(5, len(labels), 40))
    assert run.code == 0
    said = f"{missing} of {len(labels)} faces are unlabelled and counted as the nearest labelled"
    assert run.err == f"moseg: partly.seg: {said}\n"
    cost, partial = (json.loads(each.out)["cost"]["value"] for each in (whole, run))
    assert partial == pytest.approx(cost, rel=0.05)
