"""Recipes within recipes: inline, by name and by path, and every mistake before a shape is read."""

from __future__ import annotations

import pytest

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ObjectiveSpec
from moseg_core.errors import ExpressionError, UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.recipe import load_recipe, parse_recipe

TOP = 'labels = ["head", "leg1", "leg2"]\nminimize = "narrow(leg*)"\n'
EARS = 'labels = ["ear1", "ear2"]\nminimize = "compact(ear*)"\n'


def test_a_table_for_a_part_is_a_recipe():
    recipe = parse_recipe(
        f"""{TOP}
        [parts.head]
        {EARS}
        seeder = "kmeans(rounds=5)"
        restarts = 2
        [parts.head.parts.ear2]
        labels = ["tip", "root"]
        minimize = "narrow(tip)"
        [parts."leg*"]
        labels = ["thigh", "shin"]
        minimize = "narrow(shin)"
        """,
        "mine",
    )
    parts = dict(recipe.statement.parts)
    assert list(parts) == ["head", "leg1", "leg2"]
    assert parts["head"].search.seeder == Choice("kmeans", {"rounds": 5})
    assert parts["head"].search.restarts == 2
    assert parts["leg1"] == parts["leg2"]
    task = recipe.hierarchy()
    assert task.labels == (
        "head/ear1",
        "head/ear2/tip",
        "head/ear2/root",
        "leg1/thigh",
        "leg1/shin",
        "leg2/thigh",
        "leg2/shin",
    )
    assert task.children["head"].search.restarts == 2
    assert recipe.problem().labels == ("head", "leg1", "leg2")


def test_the_order_of_tables_does_not_matter():
    head, leg = f"[parts.head]\n{EARS}", f"[parts.leg1]\n{EARS}"
    assert parse_recipe(TOP + head + leg, "x") == parse_recipe(TOP + leg + head, "x")


def test_an_installed_recipe_for_a_part():
    recipe = parse_recipe(f'{TOP}[parts.head]\nrecipe = "paper_hammer"', "mine")
    assert recipe.hierarchy().labels[:2] == ("head/handle", "head/head")
    assert dict(recipe.statement.parts)["head"] == load_recipe("paper_hammer").statement


def test_paths_are_relative_to_the_file_that_gives_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "far" / "below").mkdir(parents=True)
    (tmp_path / "far" / "mine.toml").write_text(f'{TOP}[parts.head]\nrecipe = "below/head.toml"')
    (tmp_path / "far" / "below" / "head.toml").write_text(
        f'{EARS}[parts.ear1]\nrecipe = "./ear.toml"'
    )
    (tmp_path / "far" / "below" / "ear.toml").write_text('labels = ["tip"]\nminimize = "flat(tip)"')
    recipe = load_recipe("far/mine.toml")
    assert recipe.hierarchy().labels == ("head/ear1/tip", "head/ear2", "leg1", "leg2")


def test_a_recipe_that_is_among_its_own_parts_ends(tmp_path):
    (tmp_path / "a.toml").write_text(f'{TOP}[parts.head]\nrecipe = "./b.toml"')
    (tmp_path / "b.toml").write_text(f'{EARS}[parts.ear1]\nrecipe = "a.toml"')
    with pytest.raises(UsageError, match=r"a\.toml' is among its own parts"):
        load_recipe(str(tmp_path / "a.toml"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"[parts.haed]\n{EARS}", r"^recipe 'mine': parts: unknown label 'haed'; did you mean 'h"),
        (f'[parts."arm*"]\n{EARS}', r"^recipe 'mine': parts: 'arm\*' matches none of the labels"),
        ("parts = 3", r"^recipe 'mine': 'parts' must be tables such as \[parts.head\]; it is 3"),
        ("parts.head = 3", r"^recipe 'mine/head' must be a table with labels and minimize"),
        ("[parts.head]", r"^recipe 'mine/head': 'labels' must be a list of texts; it is missing"),
        (
            f"[parts.head]\n{EARS}sed = 3",
            r"^recipe 'mine/head': unknown key 'sed'; did you mean 's",
        ),
        ('[parts.head]\nrecipe = "hamer"', r"^unknown recipe 'hamer'; did you mean 'hammer'"),
        ("[parts.head]\nrecipe = 3", r"^recipe 'mine/head': 'recipe' must be a text; it is 3"),
        (
            '[parts.head]\nrecipe = "paper_hammer"\nseeder = "kmeans"',
            r"^recipe 'mine/head': 'recipe' stands alone, without 'seeder'",
        ),
        (
            f'[parts.head]\n{EARS}[parts.head.parts.ear]\nrecipe = "paper_hammer"',
            r"^recipe 'mine/head': parts: unknown label 'ear'; did you mean 'ear",
        ),
        (
            '[parts.head]\nlabels = ["ear*"]\nminimize = "narrow(ear*)"',
            r"^recipe 'mine/head' leaves the number of parts open \(ear\*\).*; list them",
        ),
        ('[parts.head]\nrecipe = "any_shape"', r"^recipe 'mine/head' leaves the number of parts"),
        ('[parts.head]\nrecipe = "./none.toml"', r"^recipe './none.toml' cannot be read"),
    ],
)
def test_mistakes_in_parts(text, message):
    with pytest.raises(UsageError, match=message):
        parse_recipe(TOP + text, "mine")


def test_mistakes_in_a_parts_expression_show_with_the_problems():
    recipe = parse_recipe(f'{TOP}[parts.head]\nlabels = ["a"]\nminimize = "narow(a)"', "mine")
    with pytest.raises(ExpressionError, match="did you mean 'narrow'"):
        recipe.hierarchy()


def test_parts_know_their_own_labels_only():
    recipe = parse_recipe(f'{TOP}[parts.head]\nlabels = ["a"]\nminimize = "narrow(leg1)"', "mine")
    with pytest.raises(ExpressionError, match="unknown label 'leg1'"):
        recipe.hierarchy()


def test_parts_of_a_bundles_recipe_mean_its_own_objectives():
    others = registry()
    rival = Component("rival", "rival 1.0", ObjectiveSpec(name="convex_parts", target="rival:f"))
    crowded = Registry(
        [*others.bundles, Bundle("rival", "rival", "1.0", "rival", components=(rival,))]
    )
    beside = load_recipe("symmetry_then_convex", source=crowded)
    assert {part.minimize for _, part in beside.statement.parts} == {"basic:convex_parts"}


def test_each_part_of_an_open_label_is_divided():
    recipe = parse_recipe(
        f'labels = ["body", "limb*"]\nminimize = "narrow(limb*)"\n[parts."limb*"]\n{EARS}', "mine"
    )
    assert parse_recipe(recipe.toml(), "mine") == recipe
    assert Hierarchy.of(recipe.statement.with_parts(3)).labels == (
        "body",
        *("limb1/ear1", "limb1/ear2", "limb2/ear1", "limb2/ear2"),
    )
