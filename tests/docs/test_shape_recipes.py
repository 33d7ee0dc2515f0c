"""What is said of the recipes of the bundle ``shapes``, and how they are made."""

from __future__ import annotations

import re

import pytest
from moseg_benchmark.psb import CATEGORIES, Model
from moseg_recipes_shapes.plugin import RECIPES

from tools.learn_shape_recipes import FOLDER, README, chosen, filled, table

AGAIN = "run: python tools/learn_shape_recipes.py"


def test_the_readme_lists_the_recipes_as_they_are():
    text = README.read_text()
    assert text == filled(text, table()), AGAIN
    assert filled(filled(text, "OTHER"), table()) == text


def test_the_table_has_a_line_for_each_with_the_models():
    lines = table().splitlines()
    assert lines[0] == "| recipe | of | labels | learned from |"
    assert len(lines) == 2 + len(RECIPES)
    (octopus,) = [line for line in lines if line.startswith("| `octopus` |")]
    said = (FOLDER / "octopus.toml").read_text()
    models = octopus.split("|")[4].split(",")
    assert len(models) == 5
    assert all(f"Benchmark {model.strip()}: body" in said for model in models)


def test_a_page_without_the_marks_is_refused():
    with pytest.raises(SystemExit, match="no place that is marked"):
        filled("# A page\n", table())


def test_every_category_of_the_benchmark_has_a_recipe():
    assert sorted(RECIPES) == sorted(category.lower() for category in CATEGORIES)


def models(numbers, unnamed=()):
    return [
        Model(
            number=number,
            category="Bird",
            mesh=README,
            people=(),
            names=None if number in unnamed else README,
        )
        for number in numbers
    ]


@pytest.mark.parametrize("known", [range(241, 261), [241, 245, 249, 253, 257]], ids=["all", "dev"])
def test_every_fourth_model_is_learned_from(known):
    assert [model.number for model in chosen(models(known), "Bird")] == [241, 245, 249, 253, 257]


@pytest.mark.parametrize(
    ("given", "category", "said"),
    [
        (models(range(242, 261)), "Bird", "Bird: there is no model 241"),
        (models([241, 245, 253, 257]), "Bird", "Bird: there is no model 249"),
        (models(range(241, 261), unnamed=[257]), "Bird", "there is no file labels/257_labels.txt"),
        (models(range(241, 261)), "Fish", "Fish: there is no model"),
    ],
)
def test_a_model_that_is_missing_is_an_error(given, category, said):
    with pytest.raises(SystemExit, match=re.escape(said)):
        chosen(given, category)
