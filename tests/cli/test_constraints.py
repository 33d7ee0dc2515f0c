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
        "segment", dove, "--recipe", "dove", "--constraint", "none", *SHORT, "-o", str(out)
    )
    assert done.code == 0, done.err
    document = json.loads(out.read_text())
    assert document["dimension"] == {"free": 16, "all": 16}
    assert "constraints" not in document["problem"]
