"""From options to a statement of a problem and to search options.

The recipe or an earlier result gives the statement, and options replace parts of it
(:func:`read_statement`); :func:`read_variants` looks its names up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from moseg_core.cli.flags import ProblemFlags, SearchedProblemFlags, SearchFlags, SteeringFlags
from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import registry
from moseg_core.components.discovery.specs import SeederSpec
from moseg_core.errors import ExpressionError, UsageError, nearest, unknown
from moseg_core.io.result_json import SavedResult, read_result
from moseg_core.problem.full_names import meant_by_result, statement_in_full
from moseg_core.problem.label_sets import declared_labels, named_sets
from moseg_core.problem.recipe import load_recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.number_of_parts import ANY_SHAPE, numbers_to_try
from moseg_core.search.workers import available_workers


def read_variants(flags: ProblemFlags, *, start: SavedResult | None = None) -> Variants:
    """The problem that the options ask for, how it is searched, and the same for its parts.

    Parameters
    ----------
    flags : ProblemFlags
    start : SavedResult or None
        A result to go on from, whose own problem stands in where no recipe is given.

    Returns
    -------
    Variants
        One hierarchy for each label set: a single one where no label has a count. It is of one
        level where the recipe gives no problems for parts. The other options replace what the
        recipe says of the first level; ``--labels`` chooses among the labels of a recipe that has
        counts, and replaces those of others. Where the number of parts is open, it is that of the
        first number that is to be tried.

    Raises
    ------
    UsageError
        Nothing says what the labels or the expression are, or anything is wrong in them.
    """
    found = _chosen_sets(flags)
    if found is None:
        statement = read_statement(flags, start=start)
        if isinstance(flags, SearchedProblemFlags) and flags.parts is not None:
            statement = statement.with_parts(numbers_to_try(statement, flags.parts)[0])
        try:
            found = Variants.of(statement)
        except ExpressionError as error:
            raise _misspelt(flags) or error from None
    plane = getattr(flags, "plane", None)
    if plane is not None and not any(
        "plane" in bound.parameters
        for task in found.tasks
        for bound in task.problem.bound_constraints
    ):
        raise UsageError(
            f"--plane {plane} is given, but no constraint needs a plane; add one, such as"
            f" --constraint 'on_plane({found.tasks[0].problem.labels[0]})'"
        )
    return found


def _chosen_sets(flags: ProblemFlags) -> Variants | None:
    """The label sets that ``--labels`` names of those that a recipe declares; else None."""
    if flags.recipe is None or flags.labels is None:
        return None
    stated = read_statement(replace(flags, labels=None))
    sets = named_sets(_names(flags.labels), stated.labels) if stated.has_counts else None
    return None if sets is None else Variants.of(stated, sets)


def _misspelt(flags: ProblemFlags) -> UsageError | None:
    """What to say of a label that is nearly one of a recipe's, where its expression is kept.

    Another that it does not have may be meant to stand beside them.
    """
    if flags.recipe is None or flags.labels is None or flags.minimize is not None:
        return None
    labels = load_recipe(flags.recipe).statement.labels
    known = {*declared_labels(labels), *(label.partition("{")[0] for label in labels)}
    for name in _names(flags.labels):
        stem = name.partition("{")[0]
        if stem not in known and nearest(stem, sorted(known)) is not None:
            return UsageError(f"--labels: {unknown('label', stem, known)}")
    return None


def _names(labels: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in labels.split(","))


def read_statement(flags: ProblemFlags, *, start: SavedResult | None = None) -> Statement:
    """What is asked for: the recipe's or the start's statement, with what replaces parts of it.

    Raises
    ------
    UsageError
        As for :func:`read_variants`, names apart, which are not looked up here.
    """
    changes: dict[str, Any] = {}
    if flags.labels is not None:
        changes |= {"labels": _names(flags.labels), "variants": ()}
    if flags.minimize is not None:
        changes["minimize"] = flags.minimize
    if flags.embedding == "none":
        changes |= {"embedding": None, "space": None}
    elif flags.embedding is not None:
        changes["embedding"] = Choice.read(flags.embedding, "embedding")
    if flags.space is not None:
        changes["space"] = flags.space
    if isinstance(flags, SearchedProblemFlags):
        if flags.constraint:
            none = flags.constraint == ["none"]
            changes["constraints"] = () if none else tuple(flags.constraint)
        if flags.plane is not None:
            changes["plane"] = flags.plane
    if flags.recipe is not None:
        return replace(load_recipe(flags.recipe).statement, **changes)
    by_number = isinstance(flags, SearchedProblemFlags) and flags.parts is not None
    if by_number and (flags.labels is None or flags.minimize is None):
        return replace(load_recipe(ANY_SHAPE).statement, **changes)
    if start is not None:
        meaning = meant_by_result(start.versions, registry())
        return replace(statement_in_full(start.statement, meaning, leave=changes), **changes)
    if flags.labels is None or flags.minimize is None:
        raise UsageError(
            "say what to look for: --recipe NAME, or --labels a,b and --minimize '...'; or cut into"
            " parts of which nothing is known, with --parts 5 or --parts auto"
        )
    return Statement(**changes)


def read_search(flags: SearchFlags, steering: SteeringFlags) -> SearchOptions:
    """The search options; centres given by hand are a seeder.

    Raises
    ------
    UsageError
        A value that makes no sense, or another seeder beside given centres.
    """
    values: Any = {field.name: getattr(flags, field.name) for field in fields(flags)}
    if flags.workers is None:
        values["workers"] = available_workers()
    options = SearchOptions(**values)
    if steering.centers is None:
        return options
    seeder = _placing(options.seeder if isinstance(options.seeder, Choice) else None)
    centers = {"centers": steering.centers}
    return replace(options, seeder=Choice(seeder.name, {**seeder.parameters, **centers}))


def _placing(seeder: Choice | None) -> Choice:
    """A seeder that takes centres given by hand: the one asked for, or the first that there is."""
    able = [
        component
        for component in registry().components("seeder")
        if cast(SeederSpec, component.spec).takes_centers
    ]
    if seeder is None:
        return Choice(able[0].id)
    if registry().find("seeder", seeder.name) not in able:
        ids = " or ".join(f"'{component.id}'" for component in able)
        raise UsageError(
            f"--centers goes with a seeder that takes centres, {ids}, not '{seeder.name}'"
        )
    return seeder


def read_start(path: Path | None) -> SavedResult | None:
    """The result to go on from, where one is given.

    Raises
    ------
    UsageError
        It cannot be read, or it is one of several levels.
    """
    found = None if path is None else read_result(path)
    if found is not None and found.statement.parts:
        raise UsageError(
            f"'{path}' is a result of several levels, whose centres belong to different"
            " partitions; start from a result of one level"
        )
    return found


def partitioned_as(earlier: SavedResult | None, options: SearchOptions) -> SearchOptions:
    """The options with the parameterization of an earlier result, whose centres are its centres.

    The same where there is none, or the options say which.
    """
    if earlier is None or options.parameterization is not None:
        return options
    return replace(options, parameterization=earlier.search().parameterization)


def centered(text: str) -> list[str]:
    """The labels that ``--centers`` names.

    Examples
    --------
    >>> centered("head=0,1,2, body=3,4,5")
    ['head', 'body']
    """
    return [piece.rpartition("=")[0].strip() for piece in text.split(",") if "=" in piece]


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
