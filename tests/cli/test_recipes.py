"""``moseg recipes``: the list, and the text of one."""

from __future__ import annotations

import json
import types

import pytest

from moseg_core import RecipeSpec
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.problem.recipe import load_recipe


def test_lists_what_is_installed(moseg):
    run = moseg("recipes")
    assert (run.code, run.err) == (0, "")
    lines = run.out.splitlines()
    assert lines[0].split() == ["recipe", "bundle", "parts", "description"]
    assert len(lines) >= 1 + len(registry().components("recipe"))
    hammer = next(line for line in lines if line.startswith("hammer "))
    assert "basic" in hammer
    assert load_recipe("hammer").description in hammer
    assert hammer.split()[2] == "2"
    open_one = next(line for line in lines if line.startswith("any_shape"))
    assert open_one.split()[:3] == ["any_shape", "basic", "any"]


def test_lists_as_json(moseg):
    listed = json.loads(moseg("recipes", "--json").out)
    assert [entry["id"] for entry in listed] == [c.id for c in registry().components("recipe")]
    hammer = next(entry for entry in listed if entry["name"] == "hammer")
    assert hammer["labels"] == ["handle", "head"]
    assert hammer["problem"] is None
    assert "toml" not in hammer


def test_prints_a_recipe_as_it_was_shipped(moseg, tmp_path):
    text = registry().find("recipe", "paper_horse").load()
    assert moseg("recipes", "any_shape").out == registry().find("recipe", "any_shape").load()
    for name in ("paper_horse", "basic:paper_horse"):
        run = moseg("recipes", name)
        assert (run.code, run.out, run.err) == (0, text, "")
    mine = tmp_path / "mine.toml"
    mine.write_text(run.out)
    assert load_recipe(str(mine)).labels == load_recipe("paper_horse").labels
    told = json.loads(moseg("recipes", "paper_horse", "--json").out)
    assert told["toml"] == text
    assert told["minimize"] == load_recipe("paper_horse").minimize


def test_an_unknown_recipe_suggests(moseg):
    run = moseg("recipes", "hamer")
    assert (run.code, run.out) == (2, "")
    assert "unknown recipe 'hamer'; did you mean 'hammer'?" in run.err


@pytest.fixture
def shelf(monkeypatch):
    """Three recipes: one of them not TOML, one not a text, and two of a name."""
    home = types.ModuleType("home")
    home.good = 'description = "fine"\nlabels = ["a"]\nminimize = "narrow(a)"\n'
    home.bad = "labels = ["
    home.number = 3
    monkeypatch.setitem(__import__("sys").modules, "home", home)

    def bundle(name, **recipes):
        specs = [RecipeSpec(name=key, target=f"home:{value}") for key, value in recipes.items()]
        parts = tuple(Component(name, f"moseg-{name} 1.0", spec) for spec in specs)
        return Bundle(name, f"moseg-{name}", "1.0", name, parts)

    found = Registry((bundle("one", same="good", odd="number"), bundle("two", same="bad")))
    monkeypatch.setattr("moseg_core.cli.recipes.registry", lambda: found)


@pytest.mark.usefixtures("shelf")
def test_a_broken_recipe_does_not_hide_the_others(moseg):
    run = moseg("recipes")
    assert run.code == 0
    rows = [line.split() for line in run.out.splitlines()[1:]]
    assert [row[0] for row in rows] == ["one:same", "odd", "two:same"]
    assert rows[0][1:] == ["one", "1", "fine"]
    assert "cannot be used: recipe 'one:odd' of moseg-one 1.0 is a int" in run.out
    assert "not valid TOML" in run.out
    listed = json.loads(moseg("recipes", "--json").out)
    assert [entry["problem"] is None for entry in listed] == [True, False, False]
    assert moseg("recipes", "odd").code == 1
    # What is not TOML can still be looked at.
    assert moseg("recipes", "two:same").out == "labels = ["
    ambiguous = moseg("recipes", "same")
    assert ambiguous.code == 2
    assert "one:same, two:same" in ambiguous.err


QUICK = ("--optimizer", "core:pattern_search(max_evaluations=4)", "--resolution", "full")


def test_a_result_goes_on_with_the_same_components_whatever_is_installed(
    moseg, install_stranger, mallet, tmp_path
):
    before, after, again = (tmp_path / f"{k}.json" for k in ("before", "after", "again"))
    done = moseg("segment", mallet, "--recipe", "paper_dove", *QUICK, "-o", before)
    assert done.code == 0, done.err
    install_stranger()
    done = moseg("segment", mallet, "--recipe", "paper_dove", *QUICK, "-o", after)
    assert done.code == 0, done.err
    alone, crowded = (json.loads(path.read_text()) for path in (before, after))
    assert "basic:narrow(" in crowded["problem"]["minimize"]
    assert "symmetry:mirror(wing2, wing1)" in crowded["problem"]["constraints"]
    for key in ("labels", "cost", "versions", "dimension"):
        assert crowded[key] == alone[key]
    # Written before the stranger came, and after.
    for path in (before, after):
        done = moseg("segment", mallet, "--start", path, *QUICK, "-o", again)
        assert done.code == 0, done.err
        assert json.loads(again.read_text())["problem"] == crowded["problem"]
        assert moseg("explain", path).code == 0


def test_a_result_in_an_embedding_goes_on_in_the_same(moseg, install_stranger, mallet, tmp_path):
    before, again = tmp_path / "before.json", tmp_path / "again.json"
    given = ("--recipe", "paper_hammer", "--embedding", "mds(landmarks=20, refine=5)")
    done = moseg("segment", mallet, *given, *QUICK, "-o", before)
    assert done.code == 0, done.err
    install_stranger()
    done = moseg("segment", mallet, "--start", before, *QUICK, "-o", again)
    assert done.code == 0, done.err
    problem = json.loads(again.read_text())["problem"]
    assert problem["embedding"] == "mds:mds(landmarks=20, refine=5)"


@pytest.mark.parametrize("name", ["paper_bulldog", "symmetry_then_convex"])
def test_a_printed_recipe_means_the_same_in_a_file_of_ones_own(
    moseg, install_stranger, tmp_path, name
):
    shipped = moseg("recipes", name).out
    meant = load_recipe(name).hierarchy()
    versions = meant.versions
    install_stranger()
    printed = moseg("recipes", name).out
    assert printed != shipped
    (tmp_path / "mine.toml").write_text(printed)
    found = load_recipe(str(tmp_path / "mine.toml")).hierarchy()
    assert found.versions == versions
    assert found.labels == meant.labels
