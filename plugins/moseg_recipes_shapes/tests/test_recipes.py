"""What holds of learned recipes whatever their numbers, which change with the learner."""

from __future__ import annotations

import re

import numpy as np
import pytest
from moseg_recipes_shapes.plugin import RECIPES

import moseg_core as moseg
from moseg_core import load_recipe, registry, segment_variants
from moseg_core.agreement import fold, named_right

# What the benchmark calls the parts of each kind of shape, in the models that were learned from.
KINDS = {
    "human": "foot hand head lowerarm lowerleg torso upperarm upperleg",
    "fourleg": "earhorn head leg neck tail torso",
    "octopus": "body leg",
    "table": "leg support",
    "chair": "arm backsupport leg support",
}


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_says_what_it_is_of_and_was_learned_from(name):
    recipe = load_recipe(name)
    assert recipe.name == name
    assert recipe.description.lower() == f"{RECIPES[name].lower()}."
    form = re.compile(r"Princeton Segmentation Benchmark (\d+): ")
    models = {form.match(said)[1] for said in recipe.learned_from}
    assert len(models) == len(recipe.learned_from) == 5


@pytest.mark.parametrize("name", RECIPES)
def test_every_label_set_is_a_problem_that_stands(name):
    recipe = load_recipe(name)
    tasks = recipe.hierarchies()
    assert len(tasks) == max(1, len(recipe.statement.variants))
    for task in tasks:
        assert len(task.labels) >= 2
        ids = {term.id for term in task.problem.terms}
        assert {"basic:is", "learn:likely", "basic:separate_parts"} <= ids


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_is_written_as_it_is_read(name, tmp_path):
    recipe = load_recipe(name)
    path = tmp_path / f"{name}.toml"
    path.write_text(recipe.toml())
    assert load_recipe(str(path)) == recipe


@pytest.mark.parametrize("name", RECIPES)
def test_a_recipe_is_numbers_and_names(name):
    """No mesh: a text of some pages, without a line of many numbers."""
    text = registry().find("recipe", name).load()
    assert text.startswith("# Made by tools/learn_shape_recipes.py")
    assert len(text) < 100_000
    assert max(len(re.findall(r"\d+\.\d+", line)) for line in text.splitlines()) <= 2


@pytest.mark.parametrize("name", KINDS)
def test_labels_are_called_what_the_benchmark_calls_them(name):
    kinds = {re.sub(r"\{.*\}|\d+$", "", label) for label in load_recipe(name).statement.labels}
    assert kinds == set(KINDS[name].split())


def test_a_sample_is_segmented_by_a_recipe():
    """With a search that is much too short: what comes out is of one of the label sets."""
    shape = moseg.load(moseg.sample_path("octopus"))
    result = segment_variants(
        shape,
        "octopus",
        seeder="kmeans",
        optimizer="pattern_search(max_evaluations=20)",
        resolution=300,
    )
    known = [task.labels for task in load_recipe("octopus").hierarchies()]
    assert result.problem.labels in known
    assert np.isfinite(result.evaluation.cost.value)
    assert set(result.versions) >= {"basic:is", "learn:likely"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sample", "name", "rename", "least"),
    [
        ("octopus", "octopus", {"body": "head", "leg": "arm"}, 0.9),
        (
            "horse",
            "fourleg",
            {"torso": "body", "tail": "body", "neck": "head", "earhorn": "head"},
            0.7,
        ),
    ],
)
def test_a_sample_is_cut_as_it_was_made(sample, name, rename, least):
    shape = moseg.load(moseg.sample_path(sample))
    truth = moseg.read_labels(moseg.sample_labels_path(sample), shape.n_elements)
    result = segment_variants(shape, name, seed=0, workers=2)
    given = result.problem.labels
    kinds = {fold(label) for label in given}  # the label set that was found may lack a tail
    right = named_right(
        *(result.labels, given, truth.labels, truth.names, shape.areas),
        rename={kind: other for kind, other in rename.items() if kind in kinds},
    )
    assert right >= least
