"""The whole benchmark on a small collection, from the command line and in Python."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from itertools import combinations
from statistics import fmean

import numpy as np
import pytest
from moseg_benchmark.cases import run_case
from moseg_benchmark.learned_cases import run_learned_case
from moseg_benchmark.psb import find_models

from moseg_core import Problem, load, load_recipe, read_labels
from moseg_core.agreement import rand_index_error
from moseg_core.cli import main


def call(capsys, *words):
    with pytest.raises(SystemExit) as end:
        main(["benchmark", "psb", *map(str, words)])
    return end.value.code, *capsys.readouterr()


def words_for(psb, out, *more):
    recipe = psb / "capsule.toml"
    return (
        *("--data", psb, "--recipe-for", f"Cup={recipe}", "--recipe-for", f"fourleg={recipe}"),
        *("--settings", "default,paper", "--seeds", "0-1", "-o", out, *more),
    )


@pytest.fixture(scope="module")
def report(psb, tmp_path_factory):
    out = tmp_path_factory.mktemp("report") / "new"
    with pytest.raises(SystemExit) as end:
        main(["benchmark", "psb", *map(str, words_for(psb, out, "--workers", "2", "--quiet"))])
    assert end.value.code == 0
    return out


@pytest.fixture(scope="module")
def rows(report):
    return json.loads((report / "report.json").read_text())["rows"]


def test_there_is_a_row_for_every_case(rows):
    found = [(row["model"], row["method"], row["seed"]) for row in rows]
    searches = [("default", 0), ("default", 1), ("paper", 0), ("paper", 1)]
    every = [("people", 0), ("k-means", 0), *searches, ("costs", 0)]
    assert found == [(model, *case) for model in (21, 25, 381) for case in every]


def test_people_are_compared_in_pairs(rows, psb):
    for model in find_models(psb)[:2]:
        people = [read_labels(path, load(model.mesh).n_elements).labels for path in model.people]
        expected = fmean(rand_index_error(a, b) for a, b in combinations(people, 2))
        (row,) = (r for r in rows if (r["model"], r["method"]) == (model.number, "people"))
        assert row["rand_index_error"] == pytest.approx(expected, abs=1e-15)


def test_searches_are_compared_with_people_and_names(rows, report, psb):
    model = find_models(psb)[0]
    shape = load(model.mesh)
    labels = read_labels(report / "cases" / "21-capsule-default-1.seg", shape.n_elements).labels
    row = next(r for r in rows if (r["model"], r["method"], r["seed"]) == (21, "default", 1))
    people = [read_labels(path, shape.n_elements).labels for path in model.people]
    expected = fmean(rand_index_error(labels, person) for person in people)
    assert row["rand_index_error"] == pytest.approx(expected, abs=1e-15)
    true = read_labels(model.names, shape.n_elements)
    given = np.array(["one", "two", "two"])[labels]
    right = shape.areas[given == np.array(true.names)[true.labels]].sum() / shape.area
    assert row["named_right"] == pytest.approx(right)
    assert row["seconds"] > 0
    assert row["cost"] > 0


def test_a_case_that_fails_is_a_row_with_its_reason(rows):
    failed = [row for row in rows if row["failure"]]
    assert {row["model"] for row in failed} == {381}
    assert {row["failure"] for row in failed} == {"there are no segmentations by people"}


def test_the_named_parts_cost_what_they_cost(rows, psb, recipe):
    model = find_models(psb)[1]
    shape = load(model.mesh)
    problem = Problem(recipe.labels, recipe.minimize)
    truth = read_labels(model.people[0], shape.n_elements).labels  # thirds
    row = next(r for r in rows if (r["model"], r["method"]) == (25, "costs"))
    expected = problem.evaluate(shape, np.array([1, 0, 2])[truth]).cost.value
    assert row["cost"] == pytest.approx(expected, rel=1e-9)
    # The other person put both ends together, so that a label is left without a part.
    assert row["people"] == [pytest.approx(expected, rel=1e-9)]
    assert row["incomplete"] == 1


def test_the_page_shows_the_worst_first(report, rows):
    page = (report / "index.html").read_text()
    shown = [r for r in rows if r["method"] in ("default", "paper") and not r["failure"]]
    shown = [row for row in shown if row["seed"] == 0]
    shown.sort(key=lambda row: -row["rand_index_error"])
    words = [f"{row['category']} {row['model']}, capsule, {row['method']}" for row in shown]
    places = [page.index(f"<figcaption>{text}") for text in words]
    assert len(places) == 4
    assert places == sorted(places)
    assert "there are no segmentations by people" in page
    for name in ("21-capsule-default-0.png", "21-person-1.png", "25-person-2.png"):
        assert (report / "pictures" / name).read_bytes()[1:4] == b"PNG"
        assert f'src="pictures/{name}"' in page


def test_resuming_takes_over_what_was_asked_in_the_same_way(report, rows, psb, capsys, monkeypatch):
    measured = []

    def count(case, *, report):
        measured.append(case.key)
        return run_case(case, report=report)

    monkeypatch.setattr("moseg_benchmark.run.run_case", count)
    (report / "cases" / "25-capsule-paper-0.seg").unlink()
    code, out, _ = call(capsys, *words_for(psb, report, "--workers", "1", "--resume"))
    assert code == 0
    assert [key for key in measured if not key.startswith("381")] == ["25-capsule-paper-0"]
    assert "Cup" in out
    assert "recipe" in out or "search" in out
    fresh = json.loads((report / "report.json").read_text())["rows"]

    def timeless(all_rows):
        return [{**row, "seconds": None} for row in all_rows]

    assert timeless(fresh) == timeless(rows)


@pytest.mark.slow
def test_damaged_and_outdated_cases_are_measured_again(psb, tmp_path):
    data, out = tmp_path / "data", tmp_path / "out"
    shutil.copytree(psb, data)
    words = ("--data", data, "--category", "Cup", "--recipe-for", f"Cup={psb / 'capsule.toml'}")
    words = ("benchmark", "psb", *words, "--quiet", "--resume", "--workers", "1", "-o", out)

    def rows():
        with pytest.raises(SystemExit) as end:
            main([str(word) for word in words])
        assert end.value.code == 0
        found = json.loads((out / "report.json").read_text())["rows"]
        return [{**row, "seconds": None} for row in found]

    first = rows()
    case = out / "cases" / "21-people-0.json"
    case.write_text(case.read_text()[:40])
    assert rows() == first
    (out / "cases" / "21-capsule-default-0.seg").write_text("")
    assert rows() == first
    person = data / "seg" / "21" / "21_0.seg"
    person.write_text(person.read_text().replace("0", "1"))
    picture = out / "pictures" / "21-person-1.png"
    before = picture.read_bytes()
    changed = rows()
    assert changed[0]["rand_index_error"] != first[0]["rand_index_error"]
    assert picture.read_bytes() != before


CUPS = ("psb", "--category", "Cup", "--recipe-for", "none", "--workers", "2")
SHOWN = re.compile(r"^moseg: \[\d/4\] Cup (\d+) ([\w-]+)", re.MULTILINE)


def test_a_process_lost_twice_ends_the_run_and_what_was_done_is_kept(
    psb, tmp_path, capsys, monkeypatch
):
    def lost(case, *, report):
        if case.key == "25-k-means-0":
            os._exit(7)
        return run_case(case, report=report)

    monkeypatch.setattr("moseg_benchmark.run.run_case", lost)
    words = (*CUPS[1:], "--data", psb, "--resume", "-o", tmp_path / "r")
    with pytest.warns(RuntimeWarning, match="ended early"):
        code, _, err = call(capsys, *words)
    assert code == 1
    assert "a worker process ended early (exit code 7), and so did another" in err
    done = set(SHOWN.findall(err))
    assert len(done) >= 2  # of four, two are under way at most
    monkeypatch.undo()
    code, _, err = call(capsys, *words)
    assert code == 0
    measured = set(SHOWN.findall(err))
    assert ("25", "k-means") in measured
    assert not done & measured
    rows = json.loads((tmp_path / "r" / "report.json").read_text())["rows"]
    assert [bool(row["failure"]) for row in rows] == [False] * 4


STUCK = """
import signal, sys, time
# A job in the background of a shell starts with the signal ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
from moseg_benchmark import run
from moseg_core.cli import main

measure = run.run_case

def stuck(case, *, report):
    if case.method == "k-means":
        time.sleep(600)
    return measure(case, report=report)

run.run_case = stuck
main(["benchmark", *sys.argv[1:]])
"""


def test_an_interrupted_run_ends_at_once_and_what_was_done_is_kept(psb, tmp_path):
    words = (*CUPS, "--data", psb, "-o", tmp_path / "r")
    command = [sys.executable, "-c", STUCK, *map(str, words)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as run:
        line = run.stderr.readline()
        run.send_signal(signal.SIGINT)
        _, rest = run.communicate(timeout=60)
    assert run.returncode == 130
    assert "people seed 0" in line
    assert rest.endswith("moseg: interrupted\n")
    assert (tmp_path / "r" / "cases" / "21-people-0.json").is_file()


@pytest.mark.slow
def test_recipes_are_learned_from_the_others(members, learner, tmp_path, capsys, monkeypatch):
    data, out = tmp_path / "data", tmp_path / "r"
    shutil.copytree(members, data)
    (data / "off" / "25.off").unlink()
    (data / "off" / "26.off").unlink()
    words = ("--data", data, "--learn", "--learner", learner, "--examples", "1,all")
    words = (*words, "--seeds", "0-1", "--workers", "1", "--resume", "-o", out)
    code, printed, _ = call(capsys, *words)
    assert code == 0
    assert "learned 1" in printed
    assert "Label sets chosen, in searches" in printed
    document = json.loads((out / "report.json").read_text())
    assert document["learned"] == {"learner": "counted", "examples": [1, None]}
    rows = document["rows"]
    searches = [("learned 1", 0), ("learned 1", 1), ("learned", 0), ("learned", 1)]
    every = [("people", 0), ("k-means", 0), *searches]
    found = [(row["model"], row["method"], row["seed"]) for row in rows]
    assert found == [(model, *case) for model in range(21, 25) for case in every]
    assert [row["failure"] for row in rows if row["failure"]] == []
    assert load_recipe(str(out / "cases" / "21-learned-1.toml")).learned_from == ("22",)
    page = (out / "index.html").read_text()
    assert page.count("<figure>") == 4
    for name in ("21-learned-0.png", "24-person-1.png"):
        assert f'src="pictures/{name}"' in page
        assert (out / "pictures" / name).read_bytes()[1:4] == b"PNG"

    measured = []

    def count(case, **words):
        measured.append(case.key)
        return run_learned_case(case, **words)

    monkeypatch.setattr("moseg_benchmark.run.run_learned_case", count)
    assert call(capsys, *words)[0] == 0
    assert measured == []
    assert json.loads((out / "report.json").read_text())["rows"] == rows
    # Who learned from 22 learns anew, and 22 itself is compared anew.
    named = data / "labels" / "22_labels.txt"
    named.write_text(named.read_text().replace("one", "three"))
    (out / "cases" / "24-learned-1-1.seg").unlink()
    code, _, _ = call(capsys, *words, "--category", "Cup")
    assert code == 0
    alone = {key for key in measured if "-1-" in key}
    assert alone == {"21-learned-1-0", "21-learned-1-1", *(f"22-learned-1-{k}" for k in (0, 1))} | {
        "24-learned-1-1"
    }
    assert len(measured) == len(alone) + 8


@pytest.mark.slow
def test_one_collection_teaches_and_another_is_searched(members, learner, tmp_path, capsys):
    train = tmp_path / "train"
    shutil.copytree(members, train)
    for number in (23, 24, 25, 26):
        (train / "off" / f"{number}.off").unlink()
    words = ("--train", train, "--test", members, "--learner", learner, "--workers", "2")
    code, _, _ = call(capsys, *words, "-o", tmp_path / "r")
    assert code == 0
    rows = json.loads((tmp_path / "r" / "report.json").read_text())["rows"]
    examples = {row["model"]: row["examples"] for row in rows if row["method"] == "learned"}
    assert examples == {21: 1, 22: 1, 23: 2, 24: 2, 25: 2, 26: 2}
