"""Learn the recipes of the bundle ``shapes`` from the Princeton Segmentation Benchmark.

For each of its 19 categories five models, every fourth of the twenty, with their named parts
(:mod:`moseg_benchmark.psb`), are given to the learner ``profiles``. What it learns is written, with
comments, into ``plugins/moseg_recipes_shapes/moseg_recipes_shapes/recipes``; and a table of what
each was learned from into the bundle's README, between two marks. The same data give the same
files::

    python tools/learn_shape_recipes.py --data DIR

``DIR`` has ``off/<id>.off``, ``seg`` and ``labels/<id>_labels.txt``. A model that is missing is an
error, and what the learner says of one, that it is of a single part, say, is in the table. No file
is to be edited by hand: run it again after a change of the learner. Without ``--data`` the table
alone is made, from the recipes as they are.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import replace
from pathlib import Path

from moseg_benchmark.psb import CATEGORIES, Model, find_models
from moseg_learn.text import annotated
from moseg_recipes_shapes.plugin import RECIPES

from moseg_core import Example, Recipe, learn, load, load_recipe, read_labels

BUNDLE = Path(__file__).parents[1] / "plugins" / "moseg_recipes_shapes"
FOLDER = BUNDLE / "moseg_recipes_shapes" / "recipes"
README = BUNDLE / "README.md"

SOURCE = "Princeton Segmentation Benchmark"
IN_A_CATEGORY = 20
STEP = 4
"""Of the models of a category, every fourth is learned from."""

MADE = (
    "# Made by tools/learn_shape_recipes.py, not by hand; what is measured are the models below.\n"
)
BEGIN = "<!-- recipes: made by tools/learn_shape_recipes.py -->\n"
END = "<!-- end of recipes -->\n"


def chosen(models: list[Model], category: str) -> list[Model]:
    """The models of a category to learn from.

    Raises
    ------
    SystemExit
        One is missing, or its parts have no names.
    """
    found = {model.number: model for model in models if model.category == category}
    first = next(iter(found), 1) - 1
    first -= first % IN_A_CATEGORY
    numbers = range(first + 1, first + IN_A_CATEGORY + 1, STEP)
    for number in numbers:
        if number not in found:
            sys.exit(f"{category}: there is no model {number}")
        if found[number].names is None:
            sys.exit(f"{category}: there is no file labels/{number}_labels.txt")
    return [found[number] for number in numbers]


def example(model: Model) -> Example:
    """A model with its named parts."""
    assert model.names is not None
    shape = load(model.mesh)
    labelling = read_labels(model.names, shape.n_elements)
    assert labelling.names is not None
    return Example(shape, labelling.labels, labelling.names)


def learned(name: str, examples: list[Example]) -> Recipe:
    """The recipe of a category, with what it is of and where its numbers come from."""
    recipe = learn(examples)
    return replace(
        recipe,
        name=name,
        description=f"{RECIPES[name][0].upper()}{RECIPES[name][1:]}.",
        learned_from=tuple(f"{SOURCE} {said}" for said in recipe.learned_from),
    )


def make(name: str, models: list[Model]) -> None:
    """Write the recipe of a category, and say what it was learned from."""
    recipe = learned(name, [example(model) for model in models])
    (FOLDER / f"{name}.toml").write_text(MADE + annotated(recipe), encoding="utf-8")
    print(f"{name}: {seen(recipe)}", flush=True)


def seen(recipe: Recipe) -> str:
    """The models of a recipe by number, with what is noted of one."""
    form = re.compile(rf"{SOURCE} (\d+): .*?( \(.*\))?")
    matches = [match for said in recipe.learned_from if (match := form.fullmatch(said))]
    models = sorted((int(match[1]), match[2] or "") for match in matches)
    return ", ".join(f"{number}{note}" for number, note in models)


def table() -> str:
    """The recipes as they are in the bundle: labels, and what they were learned from."""
    lines = ["recipe", "of", "labels", "learned from"], ["---"] * 4
    rows = [_row(name, load_recipe(f"shapes:{name}")) for name in RECIPES]
    return "".join(f"| {' | '.join(line)} |\n" for line in (*lines, *rows))


def _row(name: str, recipe: Recipe) -> list[str]:
    labels = ", ".join(f"`{label}`" for label in recipe.labels)
    return [f"`{name}`", recipe.description.partition(":")[0].lower(), labels, seen(recipe)]


def filled(text: str, made: str) -> str:
    """The text of the README with the table between its marks."""
    before, _, rest = text.partition(BEGIN)
    _, mark, after = rest.partition(END)
    if not mark:
        sys.exit(f"{README} has no place that is marked for the table of recipes")
    return f"{before}{BEGIN}\n{made}\n{END}{after}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Learn the recipes of the bundle 'shapes'.")
    parser.add_argument("--data", type=Path, help="folder of the benchmark: off, seg, labels")
    data = parser.parse_args().data
    if data is not None:
        models = find_models(data)
        tasks = {category.lower(): chosen(models, category) for category in CATEGORIES}
        for name, own in tasks.items():
            make(name, own)
    README.write_text(filled(README.read_text(encoding="utf-8"), table()), encoding="utf-8")


if __name__ == "__main__":
    main()
