"""``moseg export``: other files of a saved result, and labels that were corrected by hand."""

from __future__ import annotations

import json

import numpy as np
import pytest

import moseg_core


def test_files_of_a_result_without_a_search(moseg, mallet, segmented, tmp_path):
    hulls, seg = tmp_path / "hulls" / "{part}.stl", tmp_path / "again.seg"
    run = moseg("export", segmented, "--shapes", mallet.parent, "-o", hulls, "--hulls", "-o", seg)
    assert run.code == 0, run.err
    assert sorted(path.name for path in hulls.parent.iterdir()) == ["handle.stl", "head.stl"]
    labels = json.loads(segmented.read_text())["labels"]
    assert np.loadtxt(seg, int).tolist() == labels


def test_corrected_labels_have_their_own_cost(moseg, mallet, segmented, tmp_path):
    kept = json.loads(segmented.read_text())
    labels = np.array(kept["labels"])
    labels[:5] = 1 - labels[:5]
    corrected, out = tmp_path / "corrected.txt", tmp_path / "corrected.json"
    corrected.write_text("".join(f"{label}\n" for label in labels))
    run = moseg("export", segmented, corrected, "--shapes", mallet.parent, "-o", out)
    assert run.code == 0, run.err
    assert "5 of" in run.err
    found = json.loads(out.read_text())
    assert found["labels"] == labels.tolist()
    assert found["warnings"][0] == "labels are those of 'corrected.txt'"
    loaded = moseg_core.load_result(out, moseg_core.load(mallet))
    again = loaded.problem.evaluate(loaded.shape, labels)
    assert found["cost"]["value"] == pytest.approx(again.cost.value, rel=1e-12)
    assert found["cost"]["value"] != kept["cost"]["value"]


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ([], "say what to write"),
        (["-o", "x.stl"], "x-{part}.stl"),
        (["-o", "x.obj", "--hulls"], "'parts/{part}.stl'"),
        (["-o", "x.obj", "--hull-vertices", "20"], "such as '.urdf'"),
    ],
)
def test_what_cannot_be_written_is_refused(moseg, segmented, words, why):
    run = moseg("export", segmented, *words)
    assert run.code == 2
    assert why in run.err


def test_labels_of_other_parts_are_refused(moseg, mallet, segmented, tmp_path):
    labels = tmp_path / "three.txt"
    count = len(json.loads(segmented.read_text())["labels"])
    labels.write_text("2\n" * count)
    run = moseg("export", segmented, labels, "--shapes", mallet.parent, "-o", tmp_path / "x.seg")
    assert (run.code, "the result has 2 parts" in run.err) == (2, True)


def test_what_is_read_is_not_written_over(moseg, mallet, segmented, tmp_path):
    labels = tmp_path / "mine.seg"
    labels.write_text("0\n")
    run = moseg("export", segmented, labels, "-o", labels)
    assert (run.code, "is read here" in run.err) == (2, True)
    assert labels.read_text() == "0\n"
