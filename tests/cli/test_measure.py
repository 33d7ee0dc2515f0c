"""``moseg measure``: results, labelled shapes and shapes to be segmented, in one table."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

import moseg_core
from moseg_core.cli.measure import encoded
from moseg_core.search.part_table import PartTable


def rows_of(path):
    return list(csv.DictReader(io.StringIO(path.read_bytes().decode(), newline="")))


def test_a_result_is_measured_as_its_table_says(moseg, segmented, tmp_path):
    out = tmp_path / "parts.csv"
    run = moseg("measure", segmented, "-o", out)
    assert run.code == 0, run.err
    assert "wrote" in run.err
    assert run.out == ""
    table = moseg_core.load_result(segmented).table()
    rows = rows_of(out)
    assert [row["part"] for row in rows] == ["handle", "head"]
    for row, expected in zip(rows, table, strict=True):
        assert row.pop("file") == str(segmented)
        assert row.keys() == expected.keys()
        for name, cell in expected.items():
            assert row[name] == ("" if cell is None else str(cell)), name
    # In the units of the file: a handle 4 long, without what is within the head.
    assert float(rows[0]["length"]) == pytest.approx(3.8, abs=0.4)
    assert float(rows[0]["closed_volume"]) < float(rows[1]["closed_volume"])


def test_without_a_file_there_is_a_table_to_read_or_json(moseg, segmented):
    run = moseg("measure", segmented)
    assert (run.code, run.err) == (0, "")
    assert run.out.split()[:2] == ["part", "elements"]
    assert [line.split()[0] for line in run.out.splitlines()[1:]] == ["handle", "head"]
    rows = json.loads(moseg("measure", segmented, "--json").out)
    assert [row["part"] for row in rows] == ["handle", "head"]


def test_labelled_shapes_in_all_forms_that_learn_takes(moseg, open_box, tmp_path):
    shape = moseg_core.load(open_box)
    handle = shape.points[:, 0] < 0.1
    labels = tmp_path / "labels.txt"
    labels.write_text("\n".join(np.where(handle, "han[dle", "=head").tolist()) + "\n")
    numbers = tmp_path / "labels.seg"
    numbers.write_text("\n".join("-1" if h else "1" for h in handle.tolist()) + "\n")
    out = tmp_path / "x.tsv"
    run = moseg("measure", f"{open_box}={labels}", f"{open_box}={numbers}", "-o", out)
    assert run.code == 0, run.err
    assert "unlabelled and left out" in run.err
    rows = list(csv.DictReader(io.StringIO(out.read_text()), delimiter="\t"))
    assert [(row["part"], row["elements"]) for row in rows] == [
        ("han[dle", str(handle.sum())),
        ("'=head", str((~handle).sum())),
        ("1", str((~handle).sum())),
    ]
    assert "shape_cost" not in rows[0]
    assert "han[dle" in moseg("measure", f"{open_box}={labels}").out


def test_own_files_bear_their_labels(moseg, mallet, segmented, tmp_path):
    result = moseg_core.load_result(segmented)
    for name in ("m.ply", "m.glb"):
        moseg_core.save(result, tmp_path / name)
        run = moseg("measure", tmp_path / name, "--json")
        assert run.code == 0, run.err
        rows = json.loads(run.out)
        assert {row["part"] for row in rows} == {"handle", "head"}
        areas = {row["part"]: row["area"] for row in rows}
        for part, measured in result.parts.items():
            assert areas[part] == pytest.approx(measured.area, rel=1e-5)


def test_shapes_without_labels_are_segmented_by_the_recipe(moseg, mallet, segmented, tmp_path):
    keep, out = tmp_path / "kept", tmp_path / "all.json"
    words = ["--recipe", "paper_hammer", "--keep", keep, "-o", out, "-o", tmp_path / "all.csv"]
    run = moseg("measure", mallet, segmented, *words)
    assert run.code == 0, run.err
    assert "[1/2]" in run.err
    first, second = np.split(np.array(json.loads(out.read_text())), 2)
    for found, known in zip(first, second, strict=True):
        assert {**found, "file": ""} == {**known, "file": ""}
    assert (keep / "mallet.json").read_bytes() == segmented.read_bytes()
    assert len(rows_of(tmp_path / "all.csv")) == 4


def test_what_fails_is_named_and_the_rest_measured(moseg, segmented, tmp_path):
    broken, out = tmp_path / "broken.json", tmp_path / "x.csv"
    broken.write_text("{}")
    run = moseg("measure", broken, tmp_path / "none.off=a.txt", segmented, "-o", out)
    assert run.code == 1
    assert f"[1/3] {broken}: " in run.err
    assert "a.txt' does not exist" in run.err
    assert f"2 of 3 could not be measured: {broken}, " in run.err
    assert len(rows_of(out)) == 2
    assert moseg("measure", broken).code == 2
    assert moseg("measure", broken, broken, "-o", tmp_path / "none.csv").code == 1
    assert not (tmp_path / "none.csv").exists()


def test_shapes_of_results_are_looked_for_in_a_folder(moseg, mallet, segmented, tmp_path):
    scans = tmp_path / "scans"
    scans.mkdir()
    mallet.rename(scans / mallet.name)
    run = moseg("measure", segmented)
    assert run.code == 3
    assert "--shapes FOLDER" in run.err
    assert moseg("measure", segmented, "--shapes", scans).code == 0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "nothing to measure"),
        (["{mallet}"], "mallet.off' has no labels; give .*=LABELS, or say what to look for"),
        (["{mallet}", "-o", "{folder}/x.xlsx"], "a table is written as .csv, .tsv, .json"),
        (["{mallet}", "-o", "{folder}/no/x.csv"], "there is no folder"),
        (["{mallet}=a.txt", "--keep", "{folder}/k"], "--keep keeps what is found"),
        (
            [
                "{mallet}",
                "{folder}/../{name}/mallet.off",
                "--recipe",
                "hammer",
                "--keep",
                "{folder}/k",
            ],
            "several shapes are called 'mallet'",
        ),
        (["{mallet}", "--recipe", "hamer"], "did you mean 'hammer'"),
        (["{mallet}", "--recipe", "hammer", "--keep", "{mallet}"], "is a file; give a folder"),
        (["=x"], "write SHAPE=LABELS"),
    ],
)
def test_requests_that_make_no_sense(moseg, mallet, tmp_path, words, message):
    import re

    given = [w.format(mallet=mallet, folder=tmp_path, name=tmp_path.name) for w in words]
    run = moseg("measure", *given)
    assert run.code == 2
    assert re.search(message, run.err), run.err


def test_the_suffix_says_how_a_table_is_encoded():
    table = PartTable(columns=("a", "b"), cells=((1, "x"),))
    assert encoded(table, ".CSV") == b"a,b\r\n1,x\r\n"
    assert encoded(table, ".tsv") == b"a\tb\r\n1\tx\r\n"
    assert json.loads(encoded(table, ".json")) == [{"a": 1, "b": "x"}]


def test_what_cannot_be_written_takes_nothing_else_along(moseg, mallet, segmented, tmp_path):
    (tmp_path / "full.csv").symlink_to("/dev/full")
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "mallet.json").symlink_to("/dev/full")
    out = tmp_path / "all.csv"
    run = moseg(
        "measure", mallet, segmented, "--recipe", "paper_hammer", "--keep", tmp_path / "kept",
        "-o", tmp_path / "full.csv", "-o", out,
    )  # fmt: skip
    assert run.code == 1
    assert "full.csv', a link to '/dev/full': No space left on device" in run.err
    assert f"the results of 1 could not be kept: {mallet}" in run.err
    assert f"wrote {out}: 4 parts of 2 shapes" in run.err
    assert len(rows_of(out)) == 4
    run = moseg("measure", segmented, "-o", out, "-o", out)
    assert (run.code, "is given twice" in run.err) == (2, True)
