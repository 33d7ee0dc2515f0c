"""From options to a problem: the recipe, and what replaces parts of it."""

from __future__ import annotations

from moseg_core.errors import UsageError
from moseg_core.method import Method
from moseg_core.problem import Problem
from moseg_core.recipe import load_recipe


def read_problem(
    recipe: str | None, labels: str | None, minimize: str | None
) -> tuple[Problem, Method]:
    """The problem and the method that the options ask for.

    Raises
    ------
    UsageError
        Neither a recipe nor both labels and expression, or anything wrong in them.
    """
    found = load_recipe(recipe) if recipe is not None else None
    if found is None and (labels is None or minimize is None):
        raise UsageError(
            "say what to look for: --recipe NAME, or --labels a,b and --minimize '...'"
        )
    names = [name.strip() for name in labels.split(",")] if labels is not None else None
    if names is None:
        assert found is not None  # checked above
        names = list(found.labels)
    if minimize is None:
        assert found is not None  # checked above
        minimize = found.minimize
    return Problem(names, minimize), found.method if found else Method()
