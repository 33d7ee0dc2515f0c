"""A user's walk-through: centres by hand, run, change a weight, go on, pin a part, interrupt.

The same steps stand in ``docs/steering.md``.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core import load

SENTENCE = "3*narrow(handle) + perpendicular(handle, head) + convex_parts"


def read(path):
    return json.loads(path.read_text())


def test_walk_through(moseg, mallet, tmp_path):
    first, second, third = (tmp_path / f"{name}.json" for name in ("first", "second", "third"))
    problem = ("--labels", "handle,head", "--minimize", SENTENCE)

    by_hand = ("--centers", "handle=-0.5,0,0,head=2.2,0,0")
    assert moseg("segment", mallet, *problem, *by_hand, "-o", first).code == 0
    assert read(first)["method"]["seeder"].startswith('core:given(centers="handle=-0.5,0,0')

    # What if the handle mattered more? No search: the same labels under another expression.
    heavier = SENTENCE.replace("3*", "9*")
    told = moseg(
        *("explain", mallet, "--labels", "handle,head", "--minimize", heavier),
        *("--parts", first, "--json"),
    )
    before = json.loads(told.out)["cost"]["value"]
    assert before > read(first)["cost"]["value"]

    # Go on from there: labels come from the result, the expression is the new one.
    run = moseg("segment", mallet, "--start", first, "--minimize", heavier, "-o", second)
    assert run.code == 0
    assert read(second)["problem"] == {"labels": ["handle", "head"], "minimize": heavier}
    assert read(second)["cost"]["value"] <= before + 1e-12

    # Pin faces that came out as the handle, next to the head, to the head.
    shape = load(mallet)
    labels = np.array(read(second)["labels"])
    handle = np.flatnonzero(labels == 0)
    pinned = handle[np.argsort(-shape.points[handle, 0])[:3]].tolist()
    pin = f"head={','.join(str(face) for face in pinned)}"
    run = moseg("segment", mallet, "--start", second, "--pin", pin, "-o", third)
    assert run.code == 0
    assert [read(third)["labels"][face] for face in pinned] == [1, 1, 1]
    assert read(third)["cost"]["broken_pins"] == 0

    # The result without a search: everything frozen.
    run = moseg("segment", mallet, "--start", second, "--freeze", "handle,head", "--json")
    assert json.loads(run.out)["cost"]["value"] == read(second)["cost"]["value"]


CUT = "graph_cut(band=0.1, field=none)"
FEW = ("--optimizer", "pattern_search(max_evaluations=5)")


def test_names_carry_over_to_another_shape(moseg, mallet, tmp_path):
    """To a mallet that lies otherwise and is twice as large."""
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    problem = ("--labels", "handle,head", "--minimize", SENTENCE)
    by_hand = ("--centers", "handle=-0.5,0,0,head=2.2,0,0")
    assert moseg("segment", mallet, *problem, *by_hand, "-o", first).code == 0
    there = load(mallet)
    turned = 2 * there.geometry.vertices[:, [1, 2, 0]] + 5
    faces = there.geometry.triangles
    other = tmp_path / "other.obj"
    other.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in turned.tolist())
        + "".join(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())
    )
    run = moseg("segment", other, "--start-from", first, "-o", second)
    assert run.code == 0
    assert "'mallet' is laid onto it, 2 times as large; the surfaces are" in run.err
    labels = np.array(read(second)["labels"])
    expected = np.array(read(first)["labels"])[there.geometry.triangle_polygon]
    assert (labels == expected).mean() > 0.95
    assert (
        "--start-from lays that onto this one"
        in moseg("segment", other, "--start", first, "--freeze", "handle,head").err
    )

    run = moseg("segment", other, "--start-from", first, "--start", first)
    assert (run.code, run.err) == (
        2,
        "moseg: --start and --start-from both say where to begin; give one of them\n",
    )
    other_labels = ("--labels", "handle,top", "--minimize", "narrow(handle)")
    run = moseg("segment", other, "--start-from", first, *other_labels)
    assert run.code == 2
    assert "the start has the labels handle, head; the problem has handle, top" in run.err
    run = moseg("segment", other, "--start-from", first, "--recipe", "any_shape", "--parts", "2")
    assert "--start-from speaks of single labels" in run.err
    mallet.rename(tmp_path / "elsewhere")
    run = moseg("segment", other, "--start-from", first)
    assert run.code == 3
    assert "is not found; put it beside 'first.json'" in run.err


def test_boundaries_are_refined_and_a_start_goes_on_from_the_centres(moseg, mallet, tmp_path):
    plain, cut, after = (tmp_path / f"{name}.json" for name in ("plain", "cut", "after"))
    askew = ("--centers", "handle=-1,0,0,head=1.5,0,0")
    problem = ("segment", mallet, "--recipe", "paper_hammer", *FEW, *askew)
    assert moseg(*problem, "-o", plain).code == 0
    run = moseg(*problem, "--refiner", CUT, "-o", cut)
    assert run.code == 0, run.err
    before, found = read(plain), read(cut)
    assert found["labels"] != before["labels"]
    assert found["method"]["refiner"] == "core:graph_cut(band=0.1, field=none)"
    assert found["versions"]["core:graph_cut"].startswith("moseg-core ")
    values = [record["value"] for record in found["history"]["refine"]]
    assert values == [before["cost"]["value"], found["cost"]["value"]]
    frozen = ("--freeze", "handle,head")
    assert moseg("segment", mallet, "--start", cut, *frozen, "-o", after).code == 0
    assert read(after)["labels"] == before["labels"]
    assert "refiner" not in read(after)["method"]


def test_a_recipes_refiner_is_left_out_on_request(moseg, mallet, tmp_path):
    recipe, out = tmp_path / "mine.toml", tmp_path / "out.json"
    text = moseg("recipes", "paper_hammer").out
    recipe.write_text(f"{text}\nrefiner = {CUT!r}\n")
    asked = ("segment", mallet, "--recipe", recipe, *FEW, "-o", out)
    assert moseg(*asked).code == 0
    assert "refine" in read(out)["history"]
    assert moseg(*asked, "--refiner", "none").code == 0
    assert "refine" not in read(out)["history"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--recipe", "paper_hammer", "--refiner", "graph_cat"], "did you mean 'graph_cut'"),
        (["--recipe", "paper_hammer", "--refiner", "graph_cut(bend=1)"], "did you mean 'band'"),
        (["--recipe", "paper_hammer", "--refiner", "graph_cut(band=2)"], "allowed is 0 to 1"),
        (
            ["--recipe", "paper_hammer", "--refiner", "graph_cut(field=creases)"],
            "goes by the field 'creases': unknown field 'creases'",
        ),
        (
            ["--recipe", "paper_hammer", "--centers", "handle=0,0,0"],
            "'head' needs three coordinates",
        ),
        (
            ["--recipe", "paper_hammer", "--centers", "head=90,0,0,handle=0,0,0"],
            "'head' gets no part",
        ),
        (["--recipe", "paper_hammer", "--seeder", "given"], "parameter 'centers' is missing"),
        (
            ["--recipe", "paper_hammer", "--seeder", "kmeans", "--centers", "a=1,2,3"],
            "--centers goes with a seeder that takes centres, 'core:given', not 'kmeans'",
        ),
        (["--recipe", "paper_hammer", "--pin", "head"], "write --pin label=120,121"),
        (["--recipe", "paper_hammer", "--pin", "head=a"], "write --pin label=120,121"),
        (["--recipe", "paper_hammer", "--pin", "haed=1"], "did you mean 'head'"),
        (["--recipe", "paper_hammer", "--pin", "head=99999"], "there is no element 99999"),
        (["--recipe", "paper_hammer", "--freeze", "handel"], "did you mean 'handle'"),
        (["--recipe", "paper_hammer", "--restarts", "0"], "at least one start"),
        (["--start", "nowhere.json"], "cannot be read as a result"),
    ],
)
def test_mistakes_exit_2_in_one_line(moseg, mallet, words, says):
    run = moseg("segment", mallet, *words)
    assert run.code == 2
    assert says in run.err
    assert len(run.err.strip().splitlines()) == 1


def test_a_start_with_other_labels_is_refused(moseg, mallet, tmp_path):
    first = tmp_path / "first.json"
    assert moseg("segment", mallet, "--recipe", "paper_hammer", "-o", first).code == 0
    run = moseg(
        *("segment", mallet, "--start", first, "--labels", "a,b", "--minimize", "narrow(a)")
    )
    assert run.code == 2
    assert "has the labels handle, head; the problem has a, b" in run.err


def test_a_label_may_have_several_centres(moseg, mallet, tmp_path):
    first, second = (tmp_path / f"{name}.json" for name in ("first", "second"))
    problem = ("--labels", "handle,head", "--minimize", SENTENCE)
    several = ("--parameterization", 'voronoi(centers="head=2")')
    assert moseg("segment", mallet, *problem, *several, "-o", first).code == 0
    assert [len(part.get("more", [])) for part in read(first)["parts"]] == [0, 1]
    assert moseg("segment", mallet, "--start", first, *several, "-o", second).code == 0
    assert read(second)["cost"]["value"] <= read(first)["cost"]["value"]
    # A start has its own parameterization, unless another is asked for.
    third = tmp_path / "third.json"
    assert moseg("segment", mallet, "--start", first, "-o", third).code == 0
    assert read(third)["cost"] == read(second)["cost"]
    run = moseg("segment", mallet, "--start", first, "--parameterization", "voronoi")
    assert run.code == 2
    assert """--parameterization 'voronoi(centers="head=2")'""" in run.err
