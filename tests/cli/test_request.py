"""From options to a statement and to search options: what replaces what."""

from __future__ import annotations

import re

import pytest

from moseg_core.cli.flags import ProblemFlags, SearchedProblemFlags, SearchFlags, SteeringFlags
from moseg_core.cli.request import read_pins, read_search, read_statement, read_variants
from moseg_core.components.chosen import Choice
from moseg_core.errors import UsageError
from moseg_core.language import Target
from moseg_core.problem.recipe import load_recipe


def test_options_replace_what_the_recipe_says_and_nothing_else():
    recipe = load_recipe("paper_bulldog").statement
    assert read_statement(SearchedProblemFlags(recipe="paper_bulldog")) == recipe
    changed = read_statement(SearchedProblemFlags(recipe="paper_bulldog", minimize="narrow(leg*)"))
    assert (changed.labels, changed.minimize) == (recipe.labels, "narrow(leg*)")
    assert (changed.constraints, changed.plane) == (recipe.constraints, recipe.plane)


def test_another_expression_may_name_the_recipes_tables(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(
        'labels = ["a", "b"]\nminimize = "is(a, given=a)"\n[given.a]\narea = "0.3+-0.1"\n'
    )
    flags = SearchedProblemFlags(recipe=str(path), minimize="is(b, given=a) + compact(a)")
    (term, _) = read_variants(flags).tasks[0].problem.terms
    assert (term.calls, term.parameters) == (((1,),), {"area": Target(0.3, 0.1)})


def test_none_leaves_out_what_the_recipe_has():
    found = read_statement(SearchedProblemFlags(recipe="paper_bulldog", constraint=["none"]))
    assert found.constraints == ()
    octopus = load_recipe("paper_octopus").statement
    assert octopus.embedding is not None
    found = read_statement(ProblemFlags(recipe="paper_octopus", embedding="none"))
    assert (found.embedding, found.space) == (None, None)


def test_without_a_recipe_labels_and_expression_are_needed():
    found = read_statement(ProblemFlags(labels=" a, b ", minimize="narrow(a)"))
    assert (found.labels, found.minimize) == (("a", "b"), "narrow(a)")
    for flags in (ProblemFlags(), ProblemFlags(labels="a"), ProblemFlags(minimize="narrow(a)")):
        with pytest.raises(UsageError, match="say what to look for"):
            read_statement(flags)


@pytest.mark.parametrize(
    ("recipe", "labels", "says"),
    [
        ("hammer", "handel,head", "--labels: unknown label 'handel'; did you mean 'handle'?"),
        ("fourleg", "torso, leq{4}", "--labels: unknown label 'leq'; did you mean 'leg'?"),
        # What is missing is a label that the recipe speaks of: nothing is misspelt.
        ("hammer", "head", "unknown label 'handle' in"),
        ("hammer", "head, claw", "unknown label 'handle' in"),
    ],
)
def test_a_label_that_the_recipe_does_not_have_is_named_with_the_nearest(recipe, labels, says):
    with pytest.raises(UsageError, match=re.escape(says)):
        read_variants(SearchedProblemFlags(recipe=recipe, labels=labels))


def test_a_label_more_may_stand_beside_those_that_the_recipe_speaks_of():
    found = read_variants(SearchedProblemFlags(recipe="hammer", labels="handle,head,rest"))
    assert found.tasks[0].problem.labels == ("handle", "head", "rest")


def test_a_plane_that_nothing_needs_is_an_error():
    flags = SearchedProblemFlags(labels="a,b", minimize="narrow(a)", plane="x")
    with pytest.raises(UsageError, match=r"--plane x .* such as --constraint 'on_plane\(a\)'"):
        read_variants(flags)


def test_centres_by_hand_are_a_seeder():
    options = read_search(SearchFlags(seed=4), SteeringFlags(centers="a=0,0,0"))
    assert options.seeder == Choice("core:given", {"centers": "a=0,0,0"})
    assert options.seed == 4
    with pytest.raises(
        UsageError, match="goes with a seeder that takes centres, 'core:given', not 'kmeans'"
    ):
        read_search(SearchFlags(seeder="kmeans"), SteeringFlags(centers="a=0,0,0"))


def test_as_many_workers_as_there_are_processors(monkeypatch):
    monkeypatch.setattr("moseg_core.cli.request.available_workers", lambda: 5)
    assert read_search(SearchFlags(), SteeringFlags()).workers == 5
    assert read_search(SearchFlags(workers=1), SteeringFlags()).workers == 1


def test_pins_of_one_label_add_up():
    found = read_pins(["head=3,5", "leg=0", "head=7"])
    assert {name: elements.tolist() for name, elements in found.items()} == {
        "head": [3, 5, 7],
        "leg": [0],
    }


@pytest.mark.parametrize("word", ["head", "head=", "head=a", "=", "head=1,,2"])
def test_other_words_are_no_pins(word):
    with pytest.raises(UsageError, match="write --pin label=120,121"):
        read_pins([word])
