"""From options to a problem: the recipe or an earlier result, and what replaces parts of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from moseg_core.errors import UsageError
from moseg_core.io.saved import SavedResult, read_result
from moseg_core.method import Method
from moseg_core.plugins import registry
from moseg_core.problem import Problem
from moseg_core.recipe import load_recipe, said_in_full


def read_problem(
    recipe: str | None,
    labels: str | None,
    minimize: str | None,
    *,
    start: SavedResult | None = None,
) -> tuple[Problem, Method]:
    """The problem and the method that the options ask for.

    Parameters
    ----------
    recipe, labels, minimize : str or None
        As given on the command line.
    start : SavedResult or None
        A result to go on from, whose own problem stands in where no recipe is given.

    Raises
    ------
    UsageError
        Nothing says what the labels or the expression are, or anything is wrong in them.
    """
    method = Method()
    names: Sequence[str] | None = None
    expression: str | None = None
    if recipe is not None:
        found = load_recipe(recipe)
        names, expression, method = found.labels, found.minimize, found.method
    elif start is not None:
        meant = {term.text.partition("(")[0]: term.objective for term in start.evaluation.terms}
        names, expression = start.names, said_in_full(start.minimize, meant.get, registry())
    if labels is not None:
        names = [name.strip() for name in labels.split(",")]
    if minimize is not None:
        expression = minimize
    if names is None or expression is None:
        raise UsageError(
            "say what to look for: --recipe NAME, or --labels a,b and --minimize '...'"
        )
    return Problem(names, expression), method


def read_start(path: Path | None) -> SavedResult | None:
    """The result to go on from, where one is given."""
    return None if path is None else read_result(path)


def read_pins(words: Sequence[str]) -> dict[str, np.ndarray]:
    """Pins from words such as ``head=120,121``; several for one label add up.

    Raises
    ------
    UsageError
        A word of another form.

    Examples
    --------
    >>> {name: elements.tolist() for name, elements in read_pins(["head=3,5"]).items()}
    {'head': [3, 5]}
    """
    found: dict[str, list[int]] = {}
    for word in words:
        name, equals, numbers = word.partition("=")
        try:
            elements = [int(number) for number in numbers.split(",")]
        except ValueError:
            elements = []
        if not equals or not elements:
            raise UsageError(f"'--pin {word}' is not understood; write --pin label=120,121")
        found.setdefault(name.strip(), []).extend(elements)
    return {name: np.array(elements) for name, elements in found.items()}
