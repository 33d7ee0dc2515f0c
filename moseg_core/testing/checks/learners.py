"""Checks of learners: a recipe comes back, of the examples' labels, the same in whatever order.

A learner's recipe is kept as a text, which its owner reads, changes and sends; so what it says must
survive being written. Learners are tried with one labelled lump, with two, and with a third one
that has other labels (:mod:`moseg_core.testing.fixtures.examples`).
"""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterator
from typing import Any

from moseg_core.problem.learning import Example
from moseg_core.problem.recipe import Recipe, parse_recipe
from moseg_core.testing.check import ContractFailure, Subject, check
from moseg_core.testing.fixtures.comparison import Raised, attempt
from moseg_core.testing.fixtures.examples import sets_of_examples
from moseg_core.testing.fixtures.trial import required


def _learned(subject: Subject, examples: tuple[Example, ...]) -> Any:
    """What the learner makes of examples, or what it raised."""
    return attempt(subject.load(), examples, **required(subject))


def _recipes(subject: Subject) -> Iterator[tuple[str, tuple[Example, ...], Recipe]]:
    """Each set of examples, what it is, and the recipe; none where something else comes back."""
    for what, examples in sets_of_examples():
        found = _learned(subject, examples)
        if isinstance(found, Recipe):
            yield what, examples, found


@check("learner-returns-recipe", kinds=["learner"], gate=True)
def _returns_recipe(subject: Subject) -> None:
    """Who has labelled an example expects a recipe, however little it says."""
    for what, examples in sets_of_examples():
        found = _learned(subject, examples)
        if not isinstance(found, Recipe):
            raise ContractFailure(
                did=f"it was given {what}",
                got=str(found) if isinstance(found, Raised) else f"a {type(found).__name__}",
                expected="a moseg_core.Recipe",
                fix="return Recipe(name=..., statement=Statement(labels=..., minimize=...))",
            )


@check("learner-reads-back", kinds=["learner"])
def _reads_back(subject: Subject) -> None:
    """A recipe is kept as a text; what is not in the text is lost to whoever reads it."""
    for what, _, recipe in _recipes(subject):
        try:
            again: Any = parse_recipe(recipe.toml(), recipe.name, source=subject.registry)
        except Exception as error:  # noqa: BLE001  # whatever a strange statement may lead to
            again = error
        if again != recipe:
            raise ContractFailure(
                did=f"its recipe of {what} was written as TOML and read",
                got=str(again)[:200],
                expected="the same recipe",
                fix="round numbers before they go into the recipe; name labels by letters, digits"
                " and '_'",
            )


@check("learner-problem-stands", kinds=["learner"])
def _problem_stands(subject: Subject) -> None:
    """A recipe that names what there is not is noticed by the next user, when it is searched."""
    for what, _, recipe in _recipes(subject):
        try:
            recipe.hierarchies(source=subject.registry)
        except Exception as error:
            raise ContractFailure(
                did=f"the problem of its recipe of {what} was made",
                got=str(error),
                expected="a problem",
                fix="use objectives and components that the bundle's distribution requires, with"
                " parameters that they have",
            ) from error


@check("learner-any-order", kinds=["learner"])
def _any_order(subject: Subject) -> None:
    """Files are given in whatever order a shell lists them in, and mean the same in each."""
    for what, examples, recipe in _recipes(subject):
        other = _learned(subject, examples[::-1])
        if other != recipe:
            raise ContractFailure(
                did=f"it was given {what}, first and last exchanged",
                got="another recipe",
                expected="the same",
                fix="sort examples by what is in them, or sums by their terms: math.fsum does not"
                " depend on the order",
            )


@check("learner-keeps-labels", kinds=["learner"])
def _keeps_labels(subject: Subject) -> None:
    """A part that was shown and is not looked for is missing from everything that is cut."""
    for what, examples, recipe in _recipes(subject):
        labels = recipe.statement.labels
        for name in sorted({name for example in examples for name in example.borne}):
            if not any(_stands_for(label, name) for label in labels):
                raise ContractFailure(
                    did=f"it was given {what}, some of which bear '{name}'",
                    got=f"a recipe of the labels {', '.join(labels)}",
                    expected=f"a label '{name}', or of its kind",
                    fix="let the recipe have a label for every name in example.borne",
                )


def _stands_for(label: str, name: str) -> bool:
    """Whether a label is of the kind of a name: ``leg{2..4}`` and ``leg2`` of that of ``leg1``."""
    kinds = [re.sub(r"[0-9*]*(\{.*\})?\Z", "", text) for text in (label, name)]
    return kinds[0] == kinds[1] or fnmatch.fnmatchcase(name, label)
