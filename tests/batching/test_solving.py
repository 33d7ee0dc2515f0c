"""A job done in this process: what it writes, and what each kind of failure is called."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from moseg_core.batching.instructions import EarlierResult, Instructions
from moseg_core.batching.solving import do_job, prepared
from moseg_core.cli import main
from moseg_core.errors import UsageError
from moseg_core.io.result_json import read_result
from moseg_core.problem.recipe import load_recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from tests.batching import planted
from tests.batching.planted import INSTRUCTIONS, write_shape

FEW = SearchOptions(optimizer="pattern_search(max_evaluations=9)", restarts=1)
PLAIN = Instructions(statement=Statement(labels=("a", "b"), minimize="narrow(a)"), options=FEW)


def done(path, outputs, instructions=PLAIN):
    return do_job(str(path), [str(output) for output in outputs], instructions.text())


def test_all_outputs_are_written_and_the_result_is_the_first(tmp_path):
    path = write_shape(tmp_path, "a")
    outputs = [tmp_path / "a.json", tmp_path / "a.glb", tmp_path / "a" / "{part}.ply"]
    answer = done(path, outputs)
    assert answer["kind"] == "ok"
    assert answer["parts"] == ["a", "b"]
    assert answer["cost"] == read_result(tmp_path / "a.json").evaluation.cost.value
    written = [Path(file).relative_to(tmp_path).as_posix() for file in answer["files"]]
    assert written[0] == "a.json"
    assert sorted(written[1:]) == ["a.glb", "a/a.ply", "a/b.ply"]
    assert all(Path(file).exists() for file in answer["files"])


def test_counts_and_numbers_of_parts_work_as_alone(tmp_path):
    path = write_shape(tmp_path, "a")
    counted = Statement(labels=("body", "leg{1..2}"), minimize="narrow(body) + narrow(leg*)")
    answer = done(path, [tmp_path / "a.json"], replace(PLAIN, statement=counted))
    assert answer["parts"] in (["body", "leg1"], ["body", "leg1", "leg2"])
    any_shape = replace(PLAIN, statement=load_recipe("any_shape").statement, n_parts=3)
    answer = done(path, [tmp_path / "a.json"], any_shape)
    assert answer["parts"] == ["part1", "part2", "part3"]


def test_names_are_looked_up_once():
    assert prepared(PLAIN.text()) is prepared(PLAIN.text())


@pytest.mark.parametrize("name", ["huge", "liar", "raise", "leave", "broken", "sound"])
def test_failures_are_of_their_kinds(planted_bundle, tmp_path, name):
    prepared.cache_clear()
    path = write_shape(tmp_path, name)
    answer = done(path, [tmp_path / "x.json"], INSTRUCTIONS)
    assert answer["kind"] == planted.expected(name)
    assert (tmp_path / "x.json").exists() == (name == "sound")
    if answer["kind"] == "plugin error":
        assert "objective 'planted:planted' of planted 1.0" in answer["message"]


def test_a_file_that_is_not_there_is_a_bad_shape(tmp_path):
    answer = done(tmp_path / "none.off", [tmp_path / "x.json"])
    assert answer["kind"] == "bad shape"
    assert "does not exist" in answer["message"]


def test_what_makes_no_sense_for_this_shape_is_told(tmp_path):
    path = write_shape(tmp_path, "a")
    few = replace(PLAIN, options=replace(FEW, resolution=1))
    answer = done(path, [tmp_path / "x.json"], few)
    assert answer["kind"] == "usage"


def test_a_folder_that_is_gone_is_a_failure(tmp_path):
    path = write_shape(tmp_path, "a")
    (tmp_path / "out").write_text("a file")
    answer = done(path, [tmp_path / "out" / "x.json"])
    assert answer["kind"] in ("failed", "usage")


def test_a_shape_is_not_written_over(tmp_path):
    path = write_shape(tmp_path, "a")
    link = tmp_path / "x.json"
    link.symlink_to(path)
    before = path.read_bytes()
    answer = done(path, [link])
    assert "is the shape itself" in answer["message"]
    assert path.read_bytes() == before


def test_searches_start_from_an_earlier_result_with_the_bytes_of_a_run_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first = write_shape(tmp_path, "a")
    assert done(first, ["first.json"])["kind"] == "ok"
    write_shape(tmp_path, "bb")
    given = replace(PLAIN, start_from=EarlierResult.at(Path("first.json")))
    given.check()
    assert done("bb.off", ["bb.json"], given)["kind"] == "ok"
    words = ["--labels", "a,b", "--minimize", "narrow(a)", "--optimizer", str(FEW.optimizer)]
    words += ["--restarts", "1", "--start-from", "first.json", "-o", "alone.json", "--quiet"]
    with pytest.raises(SystemExit) as ended:
        main(["segment", "bb.off", *words])
    assert ended.value.code == 0
    assert Path("bb.json").read_bytes() == Path("alone.json").read_bytes()
    other = replace(given, statement=replace(PLAIN.statement, labels=("a", "c")))
    with pytest.raises(UsageError, match="label 'b'"):
        other.check()


def test_a_call_that_takes_too_long_is_the_component_s_failure(planted_bundle, tmp_path):
    prepared.cache_clear()
    path = write_shape(tmp_path, "spin")
    answer = done(path, [tmp_path / "x.json"], replace(INSTRUCTIONS, term_timeout=0.5))
    assert answer["kind"] == "plugin error"
    assert "planted:planted" in answer["message"]
