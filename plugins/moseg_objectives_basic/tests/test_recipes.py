"""The paper's recipes word for word; and those in the words of people, on the samples."""

from __future__ import annotations

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core import Problem, SearchOptions, UsageError, load_recipe, segment
from moseg_core.agreement import named_right

LEGS = [("leg1",), ("leg2",), ("leg3",), ("leg4",)]

# Figure 9 of the paper: weight, objective, and the labels of each call.
FIGURE_9 = {
    "paper_hammer": (
        ("handle", "head"),
        [
            (3.0, "basic:narrow", [("handle",)]),
            (1.0, "basic:perpendicular", [("handle", "head")]),
            (1.0, "basic:convex_parts", [()]),
        ],
    ),
    "paper_horse": (
        ("head", "body", "leg1", "leg2", "leg3", "leg4"),
        [
            (1.0, "basic:planar_symmetric", [("head",)]),
            (1.0, "basic:planar_symmetric", [("body",)]),
            (1.0, "basic:ellipsoidal", [("body",)]),
            (10.0, "basic:narrow", LEGS),
            (1.0, "basic:similar_proportions", [("leg1", "leg2", "leg3", "leg4")]),
            (1.0, "basic:convex_parts", [()]),
        ],
    ),
}


def bound(name):
    recipe = load_recipe(name)
    problem = Problem(recipe.labels, recipe.minimize)
    terms = [
        (term.weight, term.id, [tuple(recipe.labels[k] for k in call) for call in term.calls])
        for term in problem.terms
    ]
    assert all(term.parameters == {} for term in problem.terms)
    return recipe, problem, terms


def test_recipes_are_figure_9():
    for name, (labels, terms) in FIGURE_9.items():
        recipe, _, found = bound(name)
        assert recipe.name == name
        assert recipe.labels == labels
        assert found == terms
        assert recipe.description.endswith(".")


def test_recipes_are_solved_as_in_the_paper():
    for name in FIGURE_9:
        found = SearchOptions(settings="paper").settled(load_recipe(name).statement.search)
        chosen = [found.parameterization, found.seeder, found.labeler, found.optimizer]
        seeder = {"paper_hammer": "kmeans", "paper_horse": "evolution"}[name]
        names = [str(choice).removeprefix("core:") for choice in chosen]
        assert names == ["voronoi", seeder, "hungarian", "pattern_search"]


def test_hammer_recipe_prefers_a_hammer_cut_as_one(make):
    handle = make.box(8, 1, 1)
    head = make.moved(make.box(1.2, 3, 1.2), shift=[4.6, 0, 0])
    whole = make.segmented([handle, head])
    shape, labels = whole.shape, whole.labels
    _, problem, _ = bound("paper_hammer")
    right = problem.evaluate(shape, labels)
    assert right.cost.empty == 0
    assert max(abs(term.value) for term in right.terms[1:]) < 1e-12
    assert right.cost < problem.evaluate(shape, 1 - labels).cost


def test_horse_recipe_takes_any_shape_of_six_parts(make):
    meshes = [make.moved(make.box(3, 2, 1), shift=[5 * k, 0, 0]) for k in range(6)]
    whole = make.segmented(meshes)
    _, problem, _ = bound("paper_horse")
    found = problem.evaluate(whole.shape, whole.labels)
    worth = {term.text: term.value for term in found.terms}
    # Six equal boxes: symmetric, alike, and their own hulls.
    for text in (
        "planar_symmetric(head)",
        "planar_symmetric(body)",
        "similar_proportions(leg*)",
        "convex_parts",
    ):
        assert abs(worth[text]) < 1e-20
    legs = next(term for term in found.terms if term.text == "narrow(leg*)")
    assert len(legs.calls) == 4
    assert found.cost.value > legs.weighted > 0


OF_ANY_SHAPE = {"is", "separate_parts", "even_parts"}
"""What is known of the parts, and what holds for those of any shape."""

# What each is made of: its labels, and objectives that say what is said of them.
IN_WORDS = {
    "hammer": ("handle head", {"is", "narrow", "remote", "perpendicular", "separate"}),
    "words_fourleg": ("body neck head leg1 leg2 leg3 leg4", {"touching", *OF_ANY_SHAPE}),
    "words_bird": ("body head tail wing1 wing2", {"touching", *OF_ANY_SHAPE}),
    "words_octopus": ("body leg1 leg2 leg3 leg4 leg5 leg6 leg7 leg8", {"touching", *OF_ANY_SHAPE}),
    "words_hand": ("hand thumb finger1 finger2 finger3 finger4", {"touching", *OF_ANY_SHAPE}),
    "words_chair": ("seat back leg1 leg2 leg3 leg4 arm1 arm2", {"is", "touching", "separate"}),
    "words_table": ("top leg1 leg2 leg3 leg4", {"touching", *OF_ANY_SHAPE}),
    "words_cup": ("body handle", OF_ANY_SHAPE),
}


@pytest.mark.parametrize("name", IN_WORDS)
def test_recipes_in_words_say_of_every_part_how_large_it_is(name):
    recipe = load_recipe(name)
    assert recipe.name == name
    assert recipe.description.endswith(".")
    labels, objectives = IN_WORDS[name]
    assert list(recipe.labels) == labels.split()
    problem = recipe.problem()
    assert objectives <= {term.id.removeprefix("basic:") for term in problem.terms}
    assert np.isfinite(problem.expected_shares).all()
    assert 0.7 <= problem.expected_shares.sum() <= 1.4
    assert recipe.statement.search.seeder.name == "sized_evolution"


@pytest.mark.parametrize("name", IN_WORDS)
def test_recipes_in_words_treat_parts_of_one_kind_alike(name):
    recipe = load_recipe(name)
    problem = recipe.problem()
    folded = np.array([label.rstrip("0123456789") for label in recipe.labels])
    for kind in set(folded):
        assert np.ptp(problem.expected_shares[folded == kind]) == 0


def found_on_sample(name, recipe, rename=None):
    """The share of a sample that a recipe names right."""
    shape = moseg.load(moseg.sample_path(name))
    truth = moseg.read_labels(moseg.sample_labels_path(name), shape.n_elements)
    recipe = load_recipe(recipe)
    result = segment(shape, recipe.problem(), defaults=recipe.statement.search, workers=2)
    names = result.problem.labels
    return named_right(result.labels, names, truth.labels, truth.names, shape.areas, rename=rename)


@pytest.mark.slow
def test_the_sample_hammer_is_cut_where_the_head_begins():
    assert found_on_sample("hammer", "hammer") >= 0.98


@pytest.mark.slow
def test_the_sample_octopus_is_cut_where_its_arms_begin():
    assert found_on_sample("octopus", "words_octopus", {"body": "head", "leg": "arm"}) >= 0.9


@pytest.mark.parametrize("name", ["horse", "bulldog", "dove"])
def test_a_recipe_that_only_the_paper_has_is_found_by_its_plain_name(name):
    with pytest.raises(UsageError, match=f"unknown recipe '{name}'; did you mean 'paper_{name}'"):
        load_recipe(name)
