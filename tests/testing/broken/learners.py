"""Learners that are broken in one way each."""

from __future__ import annotations

from moseg_core import LearnerSpec, Recipe, Statement

_NAMES = {
    "learner-returns-recipe": "text_alone",
    "learner-reads-back": "says_more_than_it_writes",
    "learner-problem-stands": "wants_what_there_is_not",
    "learner-any-order": "first_come_first_served",
    "learner-keeps-labels": "first_label_only",
}

BROKEN = {
    id: LearnerSpec(name="broken", target=f"tests.testing.broken.learners:{name}")
    for id, name in _NAMES.items()
}


def recipe_of(labels, minimize="convex_parts", description=""):
    statement = Statement(labels=tuple(labels), minimize=minimize)
    return Recipe(name="learned", statement=statement, description=description)


def all_names(examples):
    return sorted({name for example in examples for name in example.borne})


def text_alone(examples):
    """The text of a recipe in place of the recipe."""
    return recipe_of(all_names(examples)).toml()


class Loud(Recipe):
    """A recipe whose name, which no text has, tells it from others."""

    def toml(self):
        return super().toml().replace("shown", "SHOWN")


def says_more_than_it_writes(examples):
    """What it writes differs from what it says."""
    plain = recipe_of(all_names(examples), description="As shown.")
    return Loud(name=plain.name, statement=plain.statement, description=plain.description)


def wants_what_there_is_not(examples):
    """An objective that nobody has."""
    return recipe_of(all_names(examples), "as_in_the_examples")


def first_come_first_served(examples):
    """Labels in the order of the examples."""
    return recipe_of(dict.fromkeys(name for example in examples for name in example.borne))


def first_label_only(examples):
    """All but one label is forgotten."""
    return recipe_of(all_names(examples)[:1])


def sound(examples):
    """Nothing is said of the parts, and nothing is wrong."""
    return recipe_of(all_names(examples))
