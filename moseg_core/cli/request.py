"""From options to a problem: the recipe or an earlier result, and what replaces parts of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import registry
from moseg_core.errors import UsageError
from moseg_core.io.result_json import SavedResult, read_result
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import load_recipe, said_in_full
from moseg_core.problem.settings import Method


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options that say what to look for, as given on the command line.

    Parameters
    ----------
    recipe, labels, minimize, plane, embedding, space : str or None
    constraints : sequence of str
        The word "none" alone leaves out the recipe's, as it does for the embedding.
    """

    recipe: str | None = None
    labels: str | None = None
    minimize: str | None = None
    constraints: Sequence[str] = ()
    plane: str | None = None
    embedding: str | None = None
    space: str | None = None

    @property
    def anything(self) -> bool:
        """Whether any option was given."""
        return any(getattr(self, field.name) for field in fields(self))


def read_task(asked: Asked, *, start: SavedResult | None = None) -> Hierarchy:
    """The problem that the options ask for, its method, and those of its parts.

    Parameters
    ----------
    asked : Asked
    start : SavedResult or None
        A result to go on from, whose own problem stands in where no recipe is given.

    Returns
    -------
    Hierarchy
        Of one level where the recipe gives no problems for parts. The other options replace what
        the recipe says of the first level.

    Raises
    ------
    UsageError
        Nothing says what the labels or the expression are, or anything is wrong in them.
    """
    method = Method()
    parts: dict[str, Hierarchy] = {}
    names: Sequence[str] | None = None
    expression: str | None = None
    constraints: Sequence[str] = ()
    plane = space = None
    embedding: Choice | str | None = None
    if asked.recipe is not None:
        found = load_recipe(asked.recipe)
        names, expression, method = found.labels, found.minimize, found.method
        constraints, plane = found.constraints, found.plane
        embedding, space = found.embedding, found.space
        parts = {label: part.hierarchy() for label, part in found.parts}
    elif start is not None:
        meant = {_name(term.text): term.objective for term in start.evaluation.terms}
        names, expression = start.names, said_in_full(start.minimize, meant.get, registry())
        constraints, plane = start.constraints, start.plane
        embedding, space = start.embedding, start.space
    if asked.labels is not None:
        names = [name.strip() for name in asked.labels.split(",")]
    if asked.minimize is not None:
        expression = asked.minimize
    if asked.constraints:
        constraints = () if list(asked.constraints) == ["none"] else asked.constraints
    if asked.embedding is not None:
        if asked.embedding == "none":
            embedding = space = None
        else:
            embedding = asked.embedding
    if names is None or expression is None:
        raise UsageError(
            "say what to look for: --recipe NAME, or --labels a,b and --minimize '...'"
        )
    problem = Problem(
        names,
        expression,
        constraints=constraints,
        plane=plane if asked.plane is None else asked.plane,
        embedding=embedding,
        space=space if asked.space is None else asked.space,
    )
    if asked.plane is not None and not any("plane" in rule.parameters for rule in problem.rules):
        raise UsageError(
            f"--plane {asked.plane} is given, but no constraint needs a plane; add one, such as"
            f" --constraint 'on_plane({problem.labels[0]})'"
        )
    return Hierarchy(problem, parts, method)


def _name(text: str) -> str:
    """The objective in the text of a term, such as ``narrow(leg*) @ mds``."""
    return text.partition("(")[0].partition("@")[0].strip()


def read_start(path: Path | None) -> SavedResult | None:
    """The result to go on from, where one is given.

    Raises
    ------
    UsageError
        It cannot be read, or it is one of several levels.
    """
    found = None if path is None else read_result(path)
    if found is not None and found.levels:
        raise UsageError(
            f"'{path}' is a result of several levels, whose centres belong to different"
            " partitions; start from a result of one level"
        )
    return found


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
