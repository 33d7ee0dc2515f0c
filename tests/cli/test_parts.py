"""``moseg segment --parts``, and what else the command line does with open recipes."""

from __future__ import annotations

import json
import sys

import pytest

from moseg_core import load, load_recipe, save_labels
from moseg_core.search import number_of_parts
from moseg_core.search.number_of_parts import TRIED
from tests.cli.test_console import on_a_terminal

QUICK = ("--seeder", "kmeans", "--optimizer", "pattern_search(max_evaluations=20)")
FEW = (*QUICK, "--restarts", "1", "--workers", "1")


@pytest.fixture
def at_most_four(monkeypatch):
    monkeypatch.setattr(number_of_parts, "MOST", 4)


@pytest.fixture
def open_recipe(tmp_path):
    path = tmp_path / "open.toml"
    path.write_text('labels = ["body", "limb*"]\nminimize = "compact(body) + narrow(limb*)"\n')
    return path


def test_as_many_parts_as_are_asked_for(moseg, mallet, tmp_path):
    out = tmp_path / "m.json"
    run = moseg("segment", mallet, "--parts", "3", *FEW, "-o", out, "--json")
    assert run.code == 0, run.err
    told, kept = json.loads(run.out), json.loads(out.read_text())
    shares = [part["area_share"] for part in told["parts"]]
    assert [part["label"] for part in told["parts"]] == ["part1", "part2", "part3"]
    assert shares == sorted(shares, reverse=True)
    assert "numbers" not in told
    assert kept["problem"]["labels"] == ["part1", "part2", "part3"]
    assert kept["problem"]["minimize"] == load_recipe("any_shape").minimize
    assert TRIED not in kept["history"]


@pytest.mark.usefixtures("at_most_four")
def test_the_number_is_found_and_what_others_cost_is_told(moseg, mallet, tmp_path):
    out = tmp_path / "m.json"
    run = moseg("segment", mallet, "--parts", "auto", *FEW, "-o", out, "--json")
    assert run.code == 0, run.err
    told, kept = json.loads(run.out), json.loads(out.read_text())
    assert [record["parts"] for record in told["numbers"]] == [2, 3, 4]
    least = min(told["numbers"], key=lambda record: (record["empty"], record["cost"]))
    assert len(told["parts"]) == least["parts"]
    assert told["cost"]["value"] == pytest.approx(least["cost"])
    assert kept["history"][TRIED] == told["numbers"]
    # A chart of it can be drawn, and it is a result like any other.
    assert moseg("plot", out, "-o", tmp_path / "m.svg").code == 0
    assert ">Number of parts<" in (tmp_path / "m.svg").read_text()
    assert moseg("explain", out).code == 0


@pytest.mark.usefixtures("at_most_four")
def test_the_numbers_are_a_table(moseg, mallet):
    run = moseg("segment", mallet, "--parts", "auto", *FEW)
    assert run.code == 0, run.err
    lines = [line.split() for line in run.out.splitlines()]
    assert lines[0] == ["number", "of", "parts", "cost", "empty"]
    assert [line[0] for line in lines[1:4]] == ["2", "3", "4"]
    assert min(float(line[1]) for line in lines[1:4]) == float(lines[-1][1])


def test_on_a_terminal_it_is_told_which_number_is_tried(mallet):
    run = [sys.executable, "-c", TWO_TO_FOUR, "segment", str(mallet), "--parts", "auto", *FEW]
    code, printed = on_a_terminal(run)
    assert code == 0, printed
    for n in (2, 3, 4):
        assert f"{n} parts: pattern_search" in printed


TWO_TO_FOUR = """
import sys
from moseg_core.search import number_of_parts
number_of_parts.MOST = 4
from moseg_core.cli import main
main(sys.argv[1:])
"""


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--parts", "nine"], "a number from 1 on or 'auto', not 'nine'"),
        (["--parts", "0"], "a number from 1 on or 'auto', not 0"),
        (["--parts", "2.5"], "a number from 1 on or 'auto', not '2.5'"),
        (["--parts", "3", "--recipe", "hammer"], "fixed by the labels handle, head"),
        (["--parts", "auto", "--recipe", "hammer"], "fixed by the labels handle, head"),
        (["--parts", "2", "--labels", "a,b"], "fixed by the labels a, b"),
        (["--parts", "3", "--labels", "a*,b*"], "one label may end with '*'"),
        (["--parts", "3", "--labels", "*"], "label '*' is not allowed"),
        (["--parts", "1", "--labels", "a,b*"], "1 parts are too few for the labels a, b*"),
        (["--parts", "3", "--minimize", "narrow(part4)"], "unknown label 'part4'"),
        (["--parts", "3", "--centers", "part1=0,0,0"], "--centers speaks of single labels"),
        (["--parts", "3", "--start", "x.json"], "--start speaks of single labels"),
        (["--parts", "3", "--pin", "part1=3"], "--pin speaks of single labels"),
        (["--parts", "3", "--freeze", "part1"], "--freeze speaks of single labels"),
        (["--recipe", "any_shape"], "label 'part*' stands for any number of parts"),
        (["--labels", "leg*", "--minimize", "narrow(leg*)"], "--parts 5"),
        ([], "--parts 5 or --parts auto"),
    ],
)
@pytest.mark.parametrize("present", [True, False])
def test_mistakes_are_told_before_the_shape_is_read(moseg, mallet, tmp_path, present, words, says):
    run = moseg("segment", mallet if present else tmp_path / "x.ply", *words)
    assert (run.code, run.out) == (2, "")
    assert says in run.err
    assert run.err.count("\n") <= 3


def test_an_open_recipe_of_ones_own(moseg, mallet, open_recipe, tmp_path):
    out = tmp_path / "m.json"
    run = moseg("segment", mallet, "--recipe", open_recipe, "--parts", "3", *FEW, "-o", out)
    assert run.code == 0, run.err
    assert json.loads(out.read_text())["problem"]["labels"] == ["body", "limb1", "limb2"]


def test_labels_and_expression_of_ones_own(moseg, mallet, tmp_path):
    out = tmp_path / "m.json"
    given = ("--labels", "rod, end*", "--minimize", "narrow(rod) + compact(end*)")
    run = moseg("segment", mallet, "--parts", "3", *given, *FEW, "-o", out)
    assert run.code == 0, run.err
    problem = json.loads(out.read_text())["problem"]
    assert problem == {"labels": ["rod", "end1", "end2"], "minimize": "narrow(rod) + compact(end*)"}
    # One of the two stands in for the recipe's.
    run = moseg("segment", mallet, "--parts", "2", "--labels", "piece*", *FEW, "-o", out)
    problem = json.loads(out.read_text())["problem"]
    assert problem["labels"] == ["piece1", "piece2"]
    assert problem["minimize"] == load_recipe("any_shape").minimize


def test_several_centres_and_clipped_boundaries(moseg, mallet, tmp_path):
    out, clipped = tmp_path / "m.json", tmp_path / "m.ply"
    several = ("--parameterization", 'voronoi(centers="part1=2")')
    run = moseg(
        "segment", mallet, "--parts", "3", *several, "--clip", *FEW, "-o", out, "-o", clipped
    )
    assert run.code == 0, run.err
    parts = json.loads(out.read_text())["parts"]
    assert ["more" in part for part in parts] == [True, False, False]
    assert clipped.exists()
    # Gone on from, with the same number of centres.
    run = moseg("segment", mallet, "--start", out, *several, *QUICK[2:], "-o", tmp_path / "n.json")
    assert run.code == 0, run.err


def test_a_centre_for_a_part_that_there_is_not(moseg, mallet):
    wrong = ("--parameterization", 'voronoi(centers="part4=2")')
    run = moseg("segment", mallet, "--parts", "3", *wrong)
    assert run.code != 0
    assert "unknown label 'part4'" in run.err


# --- explain


def cost(moseg, *words):
    run = moseg("explain", *words, "--json")
    assert run.code == 0, run.err
    return json.loads(run.out)["cost"]["value"]


def test_explain_takes_the_number_of_parts_from_the_labelling(moseg, mallet, tmp_path):
    result, seg = tmp_path / "m.json", tmp_path / "m.seg"
    run = moseg("segment", mallet, "--parts", "4", *FEW, "-o", result, "-o", seg)
    assert run.code == 0, run.err
    kept = json.loads(result.read_text())["cost"]["value"]
    for parts in (result, seg):
        assert cost(moseg, mallet, "--recipe", "any_shape", "--parts", parts) == pytest.approx(kept)
    run = moseg("explain", mallet, "--recipe", "any_shape", "--parts", result)
    assert run.err == ""


def test_explain_numbers_the_names_of_others(moseg, mallet, tmp_path):
    shape, names = load(mallet), tmp_path / "names.txt"
    head = (shape.points[:, 0] > 1.8).astype(int)
    save_labels(head, names, names=["shaft", "head"])
    run = moseg("explain", mallet, "--recipe", "any_shape", "--parts", names)
    assert run.code == 0
    assert run.err == "moseg: part1 is 'shaft', part2 is 'head'\n"
    seg = tmp_path / "names.seg"
    save_labels(head, seg)
    words = (mallet, "--recipe", "any_shape", "--parts")
    assert cost(moseg, *words, names) == cost(moseg, *words, seg)


def test_explain_matches_fixed_labels_by_name(moseg, mallet, open_recipe, tmp_path):
    shape, names = load(mallet), tmp_path / "names.txt"
    head = (shape.points[:, 0] > 1.8).astype(int)
    save_labels(head, names, names=["shaft", "body"])
    words = (mallet, "--recipe", open_recipe, "--parts", names)
    found = json.loads(moseg("explain", *words, "--json").out)
    assert moseg("explain", *words).err == "moseg: limb1 is 'shaft'\n"
    assert [term["calls"][0]["labels"] for term in found["terms"]] == [["body"], ["limb1"]]
    plain = ("--labels", "limb1,body", "--minimize", "compact(body) + narrow(limb1)")
    seg = tmp_path / "names.seg"
    save_labels(head, seg)
    assert found["cost"]["value"] == cost(moseg, mallet, *plain, "--parts", seg)


def test_explain_of_fewer_parts_than_the_recipe_names(moseg, mallet, open_recipe, tmp_path):
    seg = tmp_path / "one.seg"
    save_labels([0] * load(mallet).n_elements, seg)
    run = moseg("explain", mallet, "--recipe", open_recipe, "--parts", seg)
    assert run.code == 2
    assert "1 parts are too few for the labels body, limb*; give 2 or more" in run.err


def test_explain_of_parts_that_are_divided(moseg, mallet, tmp_path):
    recipe, out = tmp_path / "open.toml", tmp_path / "m.json"
    recipe.write_text(
        'labels = ["piece*"]\nminimize = "compact(piece*)"\n'
        '[parts."piece*"]\nlabels = ["a", "b"]\nminimize = "narrow(a)"\n'
    )
    run = moseg("segment", mallet, "--recipe", recipe, "--parts", "2", *FEW, "-o", out)
    assert run.code == 0, run.err
    kept = json.loads(out.read_text())["cost"]["value"]
    assert cost(moseg, mallet, "--recipe", recipe, "--parts", out) == pytest.approx(kept)
    # Other names for the wholes, the same below them.
    text = out.read_text().replace('"piece1/', '"upper/').replace('"piece2/', '"lower/')
    (tmp_path / "n.json").write_text(text)
    run = moseg("explain", mallet, "--recipe", recipe, "--parts", tmp_path / "n.json", "--json")
    assert json.loads(run.out)["cost"]["value"] == pytest.approx(kept)
    assert "piece1 is 'upper', piece2 is 'lower'" in run.err
    assert TRIED not in json.loads(text)["history"]
