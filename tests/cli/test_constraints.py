"""Constraints and embeddings on the command line: options, messages, what the result tells."""

from __future__ import annotations

import json

import pytest

import moseg_core

TABLE = ["--labels", "head,handle", "--minimize", "3*narrow(handle) + perpendicular(handle, head)"]
SHORT = ["--optimizer", "pattern_search(max_evaluations=30)"]


@pytest.fixture(scope="module")
def hammer():
    return str(moseg_core.sample_path("hammer"))


def test_the_dimension_is_said_and_saved(moseg, hammer, tmp_path):
    out = tmp_path / "a.json"
    given = ["--constraint", "on_plane(h*)", "--plane", "y"]
    done = moseg("segment", hammer, *TABLE, *SHORT, *given, "-o", str(out))
    assert done.code == 0, done.err
    assert "constraints leave 6 of 8 dimensions to search" in done.err
    document = json.loads(out.read_text())
    assert document["dimension"] == {"free": 6, "all": 8}
    assert document["problem"]["constraints"] == ["on_plane(head)", "on_plane(handle)"]
    assert document["problem"]["plane"] == "y"
    # The centres are on the plane y = middle of the box; a run that goes on keeps to it.
    again = tmp_path / "b.json"
    assert moseg("segment", hammer, "--start", str(out), *SHORT, "-o", str(again)).code == 0
    for path in (out, again):
        parts = json.loads(path.read_text())["parts"]
        assert parts[0]["center"][1] == pytest.approx(parts[1]["center"][1], abs=1e-9)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (["--constraint", "on_plain(head)"], "unknown constraint 'on_plain'"),
        (["--constraint", "on_plane(haed)"], "unknown label 'haed'"),
        (["--plane", "x"], "--plane x is given, but no constraint needs a plane"),
        (["--constraint", "on_plane(head)", "--plane", "w"], "plane 'w'"),
        (["--embedding", "msd"], "unknown embedding 'msd'; did you mean 'mds'?"),
        (["--space", "mds"], "unknown space 'mds'"),
    ],
)
def test_typos_are_named(moseg, hammer, given, message):
    done = moseg("segment", hammer, *TABLE, *given)
    assert done.code == 2
    assert message in done.err


def test_a_space_without_its_embedding_is_pointed_at(moseg, hammer):
    done = moseg("segment", hammer, "--labels", "a,b", "--minimize", "narrow(a) @ mds")
    assert done.code == 2
    assert done.err.splitlines()[-1].strip() == "^^^"
    assert "give the embedding 'mds' too" in done.err


def test_none_leaves_out_what_a_recipe_has(moseg, tmp_path):
    dove, out = str(moseg_core.sample_path("dove")), tmp_path / "a.json"
    done = moseg(
        "segment", dove, "--recipe", "paper_dove", "--constraint", "none", *SHORT, "-o", str(out)
    )
    assert done.code == 0, done.err
    document = json.loads(out.read_text())
    assert document["dimension"] == {"free": 16, "all": 16}
    assert "constraints" not in document["problem"]


FEW = "landmarks=20, refine=5"


@pytest.mark.parametrize("words", ["geodesics=exact", 'geodesics = "exact"'])
def test_an_embedding_with_a_word_is_saved_and_taken_up_again(moseg, mallet, tmp_path, words):
    first, second = tmp_path / "a.json", tmp_path / "b.json"
    given = ["--embedding", f"mds({words}, {FEW})"]
    done = moseg("segment", mallet, *TABLE, *SHORT, *given, "-o", first)
    assert done.code == 0, done.err
    done = moseg("segment", mallet, "--start", first, *SHORT, "-o", second)
    assert done.code == 0, done.err
    for path in (first, second):
        problem = json.loads(path.read_text())["problem"]
        assert problem["embedding"] == f"mds(geodesics=exact, {FEW})"


def test_an_embedding_that_a_table_gives_is_taken_up_from_the_result(moseg, mallet, tmp_path):
    recipe, first, second = tmp_path / "t.toml", tmp_path / "a.json", tmp_path / "b.json"
    recipe.write_text(
        'labels = ["head", "handle"]\nminimize = "narrow(handle)"\n'
        'embedding = { name = "mds", geodesics = "exact", landmarks = 20, refine = 5 }\n'
    )
    done = moseg("segment", mallet, "--recipe", recipe, *SHORT, "-o", first)
    assert done.code == 0, done.err
    done = moseg("segment", mallet, "--start", first, *SHORT, "-o", second)
    assert done.code == 0, done.err
    assert json.loads(second.read_text())["problem"] == json.loads(first.read_text())["problem"]


def test_a_constraint_takes_a_plane_of_numbers_in_quotes(moseg, mallet, tmp_path):
    out, again = tmp_path / "a.json", tmp_path / "b.json"
    rule = 'on_plane(head, plane="0,0,0,0,1,0")'
    done = moseg("segment", mallet, *TABLE, *SHORT, "--constraint", rule, "-o", out)
    assert done.code == 0, done.err
    assert json.loads(out.read_text())["problem"]["constraints"] == [rule]
    done = moseg("segment", mallet, "--start", out, *SHORT, "-o", again)
    assert done.code == 0, done.err
    assert json.loads(again.read_text())["parts"][0]["center"][1] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("given", "saved"),
    [
        ("greedy(order=head)", "core:greedy(order=head)"),
        ('greedy(order="head,handle")', 'core:greedy(order="head,handle")'),
    ],
)
def test_a_labeler_takes_words_and_what_is_saved_reads_back(moseg, mallet, tmp_path, given, saved):
    out = tmp_path / "a.json"
    for choice in (given, saved):
        done = moseg("segment", mallet, *TABLE, *SHORT, "--labeler", choice, "-o", out)
        assert done.code == 0, done.err
        assert json.loads(out.read_text())["method"]["labeler"] == saved


@pytest.mark.parametrize(
    ("given", "message", "place"),
    [
        (["--labeler", "greedy(head)"], "expected key=value", "head"),
        (["--labeler", "greedy(order=head,handle)"], 'stand in quotes: key="a,b"', "handle"),
        (["--embedding", 'mds(geodesics="exact)'], "the quote does not end", '"exact)'),
        (["--constraint", "on_plane(head, plane=)"], "expected a number or a word", ")"),
        (["--minimize", "narrow(head, mode=fast)"], "unknown parameter 'mode'", "mode"),
        (["--minimize", "narrow(head, mode=a b)"], "expected ',' or ')'", "b"),
    ],
)
def test_a_mistake_in_any_call_is_pointed_at(moseg, mallet, given, message, place):
    problem = TABLE[:2] if "--minimize" in given else TABLE
    done = moseg("segment", mallet, *problem, *given)
    assert done.code == 2
    assert message in done.err
    *_, text, carets = done.err.rstrip().splitlines()
    assert text[carets.index("^") : len(carets)] == place
