"""``moseg evaluate``: measures against one truth and several, names and their translation."""

from __future__ import annotations

import json

import numpy as np
import pytest

import moseg_core
from moseg_core.agreement import Agreement, named_right, rand_index_error
from moseg_core.cli.evaluate import read_rename
from moseg_core.errors import UsageError
from moseg_core.io import encode_named_labels, encode_seg

NUMBERS = [name for name in Agreement.__dataclass_fields__ if name != "named_right"]


@pytest.fixture
def shape(mallet):
    return moseg_core.load(mallet)


@pytest.fixture
def write(tmp_path):
    """Write labels to a file: with names to .txt, without to .seg."""

    def write(stem, labels, names=None):
        path = tmp_path / (f"{stem}.txt" if names else f"{stem}.seg")
        path.write_bytes(encode_named_labels(labels, names) if names else encode_seg(labels))
        return path

    return write


@pytest.fixture
def cases(shape, write):
    """A found labelling with names; true ones: itself, another with other names, one without."""
    x = shape.points[:, 0]
    found = np.digitize(x, [0.0, 1.8])
    true = np.digitize(x, [1.7])
    return {
        "found": write("found", found, ["grip1", "grip2", "head"]),
        "other": write("other", true, ["handle", "head"]),
        "plain": write("plain", np.digitize(x, [1.0])),
        "whole": write("whole", np.zeros(len(x), int)),
        "labels": (found, true),
    }


def test_a_labelling_agrees_with_itself(moseg, mallet, cases):
    run = moseg("evaluate", mallet, cases["found"], cases["found"], "--json")
    (told,) = json.loads(run.out)["truths"]
    assert run.code == 0
    assert {name: told[name] for name in NUMBERS} == dict.fromkeys(NUMBERS, 0.0)
    assert told["named_right"] == 1.0


def test_json_tells_everything_and_the_mean_over_what_is_defined(moseg, mallet, shape, cases):
    truths = [cases[name] for name in ("other", "plain", "whole")]
    told = json.loads(moseg("evaluate", mallet, cases["found"], *truths, "--json").out)
    found, true = cases["labels"]
    first = told["truths"][0]
    assert [row["truth"] for row in told["truths"]] == [str(path) for path in truths]
    assert set(first) == {"truth", "confusion", *Agreement.__dataclass_fields__}
    assert first["rand_index_error"] == rand_index_error(found, true)
    assert first["rand_index_error_by_area"] == rand_index_error(found, true, shape.areas)
    right = named_right(found, ["grip", "grip", "head"], true, ["handle", "head"], shape.areas)
    assert 0 < first["named_right"] == right < 1
    confusion = first["confusion"]
    assert confusion["true_names"] == ["handle", "head"]
    assert confusion["given_names"] == ["grip", "head"]
    assert np.sum(confusion["areas"]) == pytest.approx(shape.area)
    assert confusion["areas"][1][1] / shape.area == pytest.approx(right)
    assert told["truths"][1]["named_right"] is None
    assert told["truths"][1]["confusion"] is None
    assert told["truths"][2]["cut_discrepancy"] is None  # one part has no cuts
    for name in NUMBERS:
        values = [row[name] for row in told["truths"] if row[name] is not None]
        assert len(values) == (2 if name == "cut_discrepancy" else 3)
        assert told["mean"][name] == pytest.approx(np.mean(values))
    assert told["mean"]["named_right"] == first["named_right"]
    assert told["mean"]["confusion"] == confusion
    assert told["rename"] == {}


def test_the_table_has_a_row_for_each_truth_and_their_mean_in_100_columns(
    moseg, mallet, cases, shape, write
):
    long = write("381_labels", cases["labels"][1], ["handle", "head"])
    run = moseg("evaluate", mallet, cases["found"], cases["other"], cases["whole"], long)
    lines = run.out.splitlines()
    assert max(map(len, lines)) <= 100
    rows = {line.split()[0]: line.split()[1:] for line in lines[2:6]}
    assert list(rows) == ["other.txt", "whole.seg", "381_labels.txt", "mean"]
    assert [len(row) for row in rows.values()] == [12, 11, 12, 12]  # the percent sign is a word
    assert rows["whole.seg"][2] == rows["whole.seg"][-1] == "-"
    assert rows["other.txt"] == rows["381_labels.txt"]
    # The confusion table behind it, in % of the area, rounded to a tenth.
    assert lines[7].startswith("share of the area in %")
    assert lines[8].split() == ["grip", "head"]
    assert [line.split()[0] for line in lines[9:]] == ["handle", "head"]
    shares = [float(word) for line in lines[9:] for word in line.split()[1:]]
    assert sum(shares) == pytest.approx(100.0, abs=0.2)


def test_one_truth_has_no_mean(moseg, mallet, cases):
    run = moseg("evaluate", mallet, cases["found"], cases["plain"])
    assert "plain.seg" in run.out
    assert "mean" not in run.out
    assert "share of the area" not in run.out  # no names


def test_truths_of_one_name_show_their_folders(moseg, mallet, cases, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    again = tmp_path / "f" / "plain.seg"
    again.parent.mkdir()
    again.write_bytes(cases["plain"].read_bytes())
    run = moseg("evaluate", mallet, cases["found"], "plain.seg", "f/plain.seg")
    assert [line.split()[0] for line in run.out.splitlines()[2:]] == [
        "plain.seg",
        "f/plain.seg",
        "mean",
    ]


@pytest.mark.parametrize("text", ["grip=handle", "grip->handle", " grip -> handle ,head=head"])
def test_renamed_labels_are_compared_under_the_names_of_the_truth(
    moseg, mallet, shape, cases, text
):
    run = moseg("evaluate", mallet, cases["found"], cases["other"], "--json", "--rename", text)
    told = json.loads(run.out)
    found, true = cases["labels"]
    right = shape.areas[(found == 2) == (true == 1)].sum() / shape.area
    assert told["rename"]["grip"] == "handle"
    assert told["truths"][0]["named_right"] == pytest.approx(right)
    assert told["truths"][0]["confusion"]["given_names"] == ["handle", "head"]
    assert run.err == ""


def test_one_instance_may_be_renamed_by_itself(moseg, mallet, cases):
    run = moseg(
        "evaluate", mallet, cases["found"], cases["other"], "--json", "--rename", "grip2=head"
    )
    table = json.loads(run.out)["truths"][0]["confusion"]
    assert table["given_names"] == ["grip", "head"]
    assert table["areas"][0][1] > 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("gripp=handle", "unknown label to rename 'gripp'; did you mean 'grip'?"),
        ("zzz=handle", "unknown label to rename 'zzz'; known: grip, grip1, grip2, head"),
        ("grip", "'grip' in --rename is not understood; write --rename given=true"),
        ("grip=", "'grip=' in --rename is not understood"),
        ("", "'' in --rename is not understood"),
        ("grip=head,grip=handle", "--rename turns 'grip' into 'head' and 'handle'"),
    ],
)
def test_renames_that_cannot_be_meant_are_errors(moseg, mallet, cases, text, said):
    run = moseg("evaluate", mallet, cases["found"], cases["other"], "--rename", text)
    assert run.code == 2
    assert said in run.err
    assert run.out == ""


def test_a_result_without_names_cannot_be_renamed(moseg, mallet, cases):
    run = moseg("evaluate", mallet, cases["plain"], cases["other"], "--rename", "a=b")
    assert run.code == 2
    assert "plain.seg has no names of labels" in run.err


def test_names_that_no_truth_has_are_told(moseg, mallet, cases):
    run = moseg("evaluate", mallet, cases["found"], cases["other"], "--rename", "grip=handel")
    assert run.code == 0
    assert "'handel', which is a name in no truth; did you mean 'handle'?" in run.err
    run = moseg("evaluate", mallet, cases["found"], cases["other"], "--rename", "head=top")
    assert "'top', which is a name in no truth\n" in run.err
    assert "found.txt and other.txt have no names in common" in run.err


def test_a_wide_confusion_table_is_cut_into_blocks(moseg, mallet, shape, write):
    kinds = [f"part_with_a_long_name_{letter}" for letter in "abcdefghij"]
    labels = np.arange(shape.n_elements) % len(kinds)
    path = write("many", labels, kinds)
    run = moseg("evaluate", mallet, path, path)
    lines = run.out.splitlines()
    assert max(map(len, lines)) <= 120
    heads = [line.split() for line in lines[4:] if line.startswith(" ")]
    assert len(heads) > 1
    assert [name for head in heads for name in head] == kinds
    assert run.out.count("…") == 0


@pytest.mark.parametrize(
    ("text", "pairs"),
    [
        (None, {}),
        ("a=b", {"a": "b"}),
        ("a->b", {"a": "b"}),
        ("a=b, c -> d", {"a": "b", "c": "d"}),
        ("a=b,a=b", {"a": "b"}),
        ("x=1->y", {"x=1": "y"}),
    ],
)
def test_pairs_are_read(text, pairs):
    assert read_rename(text) == pairs


@pytest.mark.parametrize("text", ["a", "=b", "a->", "a=b,", ",", "->"])
def test_other_text_is_no_pair(text):
    with pytest.raises(UsageError, match="is not understood"):
        read_rename(text)


def test_a_result_against_numbers_and_against_itself(moseg, mallet, segmented, tmp_path):
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


def test_refuses_labels_of_another_shape(moseg, mallet, segmented, tmp_path):
    seg = tmp_path / "short.seg"
    seg.write_text("0\n1\n")
    run = moseg("evaluate", mallet, segmented, seg)
    assert run.code == 3
    assert "2 labels" in run.err


def test_faces_without_a_label_on_either_side_are_left_out_and_said_once(
    moseg, mallet, shape, cases, tmp_path
):
    found, true = cases["labels"]
    rng = np.random.default_rng(0)
    some, others = (rng.random(len(found)) < 0.2 for _ in range(2))
    for name, labels in (("f", np.where(some, -1, found)), ("t", np.where(others, -1, true))):
        (tmp_path / f"{name}.seg").write_bytes(encode_seg(labels))
    paths = tmp_path / "f.seg", tmp_path / "t.seg"
    run = moseg("evaluate", mallet, *paths, tmp_path / "t.seg", "--json")
    row = json.loads(run.out)["truths"][0]
    known = ~some & ~others
    assert row["rand_index_error"] == rand_index_error(found[known], true[known])
    areas = shape.areas[known]
    assert row["rand_index_error_by_area"] == rand_index_error(found[known], true[known], areas)
    assert run.err.splitlines() == [
        f"moseg: f.seg: {some.sum()} of {len(found)} faces are unlabelled and left out",
        f"moseg: t.seg: {others.sum()} of {len(found)} faces are unlabelled and left out",
    ]


def test_labellings_that_no_face_has_in_common_are_refused(moseg, mallet, shape, tmp_path):
    half = np.arange(shape.n_elements) % 2
    for name, labels in (("a", np.where(half, 3, -1)), ("b", np.where(half, -1, 3))):
        (tmp_path / f"{name}.seg").write_bytes(encode_seg(labels))
    run = moseg("evaluate", mallet, tmp_path / "a.seg", tmp_path / "b.seg")
    assert run.code == 2
    assert "no face has a label both in a.seg and in b.seg; there is nothing to comp" in run.err


def test_the_property_that_holds_the_labels_may_be_named(moseg, mallet, cases, tmp_path):
    labels = cases["labels"][0]
    table = tmp_path / "two.csv"
    rows = "".join(f"{label},{label % 2}\n" for label in labels)
    table.write_text(f"label,parity\n{rows}")
    told = {
        asked: json.loads(moseg("evaluate", mallet, table, cases["found"], "--json", *asked).out)[
            "truths"
        ][0]["rand_index_error"]
        for asked in ((), ("--label-property", "parity"), ("--label-property", "q,label"))
    }
    assert told[()] == told["--label-property", "q,label"] == 0.0
    assert told["--label-property", "parity"] == rand_index_error(labels % 2, labels) > 0
    run = moseg("evaluate", mallet, table, cases["found"], "--label-property", "q")
    assert run.code == 3
    assert "two.csv has no column 'q'; it has label, parity" in run.err
