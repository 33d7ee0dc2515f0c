"""``moseg explain``, ``evaluate``, ``sample`` and ``plugin list``."""

from __future__ import annotations

import json

import pytest

from moseg_core.components.discovery.registry import registry


@pytest.fixture
def segmented(moseg, mallet, tmp_path):
    result = tmp_path / "m.json"
    assert moseg("segment", mallet, "--recipe", "hammer", "-o", result).code == 0
    return result


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
    run = moseg("explain", mallet, "--recipe", "hammer", "--parts", seg, "--json")
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
    assert moseg("explain", segmented, "--recipe", "hammer").code == 2
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
    run = moseg("explain", mallet, "--recipe", "hammer", "--parts", seg)
    assert run.code == 0
    assert "part 'head' is empty" in run.err
    assert "left out" in run.out


def test_evaluate(moseg, mallet, segmented, tmp_path):
    labels = json.loads(segmented.read_text())["labels"]
    seg = tmp_path / "same.seg"
    seg.write_text("".join(f"{7 - label}\n" for label in labels))
    run = moseg("evaluate", mallet, segmented, seg, segmented, "--json")
    told = json.loads(run.out)
    assert run.code == 0
    assert told["truths"][0]["rand_index_error"] == 0
    assert told["truths"][0]["named_right"] is None
    assert told["truths"][1]["named_right"] == 1
    assert "1-RI" in moseg("evaluate", mallet, segmented, seg).out
    assert moseg("evaluate", mallet, segmented).code == 2


def test_evaluate_refuses_labels_of_another_shape(moseg, mallet, segmented, tmp_path):
    seg = tmp_path / "short.seg"
    seg.write_text("0\n1\n")
    run = moseg("evaluate", mallet, segmented, seg)
    assert run.code == 3
    assert "2 labels" in run.err


def test_sample(moseg, tmp_path):
    mesh, truth = tmp_path / "h.ply", tmp_path / "t.seg"
    assert moseg("sample", "hammer", "-o", mesh, "--labels", truth).code == 0
    faces = len(truth.read_text().split())
    assert 5000 <= faces <= 15000
    assert moseg("sample", "hammer", "-o", tmp_path / "h.stl").code == 2
    wrong = moseg("sample", "hamer", "-o", mesh)
    assert wrong.code == 2
    assert "hammer" in wrong.err


def test_plugin_list(moseg):
    run = moseg("plugin", "list")
    assert run.code == 0
    for word in ("basic:narrow", "core:voronoi", "moseg-objectives-basic"):
        assert word in run.out
    listed = json.loads(moseg("plugin", "list", "--json").out)
    assert [bundle["name"] for bundle in listed] == [b.name for b in registry().bundles]
    assert all(
        bundle["problem"] is None for bundle in listed if bundle["name"] in ("core", "basic")
    )


def test_version_and_help(moseg):
    assert moseg("--version").out.startswith("moseg 0.")
    assert "segment" in moseg("--help").out
    assert "--minimize" in moseg("segment", "--help").out


def test_unknown_command_suggests(moseg):
    run = moseg("segmen", "x.off")
    assert run.code == 2
    assert "did you mean 'segment'" in run.err
