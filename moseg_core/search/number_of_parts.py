"""Nothing known but the number of parts, or not even that.

A recipe for any number of parts (:attr:`moseg_core.problem.statement.Statement.is_open`) says what
the parts of any shape are like: joined along short lines in creases, each as thick everywhere.
:func:`segment_parts` takes it at the number that is asked for. Nothing tells its labels apart, so
that they are numbered from the largest part to the smallest.

Where no number is asked for, each from 2 to a most is tried, and the one with the least cost is
taken. So a recipe for any number of parts should have a cost that compares between numbers of them:
a mean over parts, or over the area, no sum over parts.
"""

from __future__ import annotations

import math
from dataclasses import replace
from numbers import Integral
from typing import Unpack

import numpy as np

from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.protocols import Progress, Report, never_stop
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import OptionValues, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.search.levels import check_hierarchy, solve_hierarchy
from moseg_core.search.result import Result, find_warnings
from moseg_core.shape.shape import Shape

ANY_SHAPE = "basic:any_shape"
"""The recipe for any number of parts where none is named."""

AUTO = "auto"
"""Said in place of a number that is to be found."""

MOST = 12
"""The greatest number of parts that is tried."""


def segment_parts(
    shape: Shape,
    n_parts: int | str = AUTO,
    *,
    recipe: str | Recipe = ANY_SHAPE,
    report: Report | None = None,
    **options: Unpack[OptionValues],
) -> Result:
    """Cut a shape into parts of which nothing is known but, maybe, their number.

    Parameters
    ----------
    shape : Shape
    n_parts : int or "auto"
        How many there are altogether; "auto" tries every number from 2 to 12.
    recipe : str or Recipe
        One that leaves the number of parts open.
    report : callable, optional
        As for :func:`moseg_core.segment`.
    **options
        The fields of :class:`moseg_core.SearchOptions`.

    Returns
    -------
    Result
        With labels ``part1`` to ``partN``, from the largest part to the smallest. Where the number
        was found, the history has a record for each that was tried, under "number of parts".

    Raises
    ------
    UsageError
        A recipe whose number of parts is fixed; a number that makes no sense.
    ShapeError, PluginError
        As for :func:`moseg_core.segment`.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> few = "pattern_search(max_evaluations=9)"
    >>> result = moseg.segment_parts(hammer, 2, seeder="kmeans", optimizer=few)
    >>> list(result.parts), result.parts["part1"].area > result.parts["part2"].area
    (['part1', 'part2'], True)
    """
    stated = (load_recipe(recipe) if isinstance(recipe, str) else recipe).statement
    return solve_parts(
        shape, stated, n_parts, SearchOptions.of(options), report=report or never_stop
    )


def read_number(given: int | str) -> int | None:
    """A number of parts; None for "auto".

    Raises
    ------
    UsageError
        Neither.

    Examples
    --------
    >>> read_number("5"), read_number("auto")
    (5, None)
    """
    if given == AUTO:
        return None
    if isinstance(given, str) and given.isdecimal():
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, Integral) or given < 1:
        raise UsageError(f"the number of parts must be a number from 1 on or 'auto', not {given!r}")
    return int(given)


def numbers_to_try(statement: Statement, given: int | str) -> list[int]:
    """How many parts to look for: the number that is given, or each that is tried.

    Raises
    ------
    UsageError
        The statement's number of parts is fixed, or the number makes no sense for it.
    """
    number = read_number(given)
    if number is not None:
        statement.with_parts(number)
        return [number]
    fewest = max(2, len(statement.labels))
    statement.with_parts(fewest)
    return list(range(fewest, max(MOST, fewest) + 1))


def solve_parts(
    shape: Shape,
    statement: Statement,
    given: int | str,
    options: SearchOptions,
    *,
    report: Report,
) -> Result:
    """The same as :func:`segment_parts`, with statement and options in one piece each."""
    numbers = numbers_to_try(statement, given)
    tasks = [Hierarchy.of(statement.with_parts(number)) for number in numbers]
    for task in tasks:
        check_hierarchy(task, options)
    # More parts than elements: the smaller numbers can still be tried.
    tried = [task for task in tasks if len(task.problem.labels) <= shape.n_elements] or tasks[:1]
    found: list[Result] = []
    stopped = False
    for task in tried:
        n = len(task.problem.labels)

        def listen(progress: Progress, n: int = n) -> bool:
            nonlocal stopped
            stage = progress.stage if len(tried) == 1 else f"{n} parts: {progress.stage}"
            stopped = bool(report(replace(progress, stage=stage))) or stopped
            return stopped

        found.append(solve_hierarchy(shape, task, options, report=listen))
        if stopped:
            break
    best = min(found, key=lambda result: result.evaluation.cost)
    if len(tried) > 1:
        records = tuple(
            {"parts": len(result.problem.labels), "cost": result.cost} for result in found
        )
        best = replace(best, history={**best.history, "number of parts": records})
    return numbered_by_size(best, statement)


def numbered_by_size(result: Result, statement: Statement) -> Result:
    """The same parts, those of the open label numbered from the largest to the smallest.

    Parameters
    ----------
    result : Result
    statement : Statement
        Open; the result is one of it.

    Returns
    -------
    Result
        As given where parts are divided further, or where the cost tells the numbers apart.
    """
    problem = result.problem
    if isinstance(problem, Hierarchy):
        return result
    numbered = [k for k, label in enumerate(problem.labels) if label not in statement.labels]
    areas = np.array([part.area for part in result.parts.values()])
    order = np.arange(len(areas))
    order[numbered] = np.array(numbered)[np.argsort(-areas[numbered], kind="stable")]
    rank = np.empty(len(order), np.int32)
    rank[order] = np.arange(len(order))
    labels = rank[result.labels]
    evaluation = problem.evaluate(result.shape, labels)
    if not math.isclose(evaluation.cost.value, result.cost, rel_tol=1e-9, abs_tol=1e-12):
        return result
    segmentation = Segmentation.from_labels(
        result.shape, labels, len(order), lookup=Lookup(problem.registry)
    )
    named = find_warnings(result.evaluation, result.segmentation, problem.labels, result.reason)
    others = tuple(warning for warning in result.warnings if warning not in named)
    return replace(
        result,
        labels=labels,
        centers=result.centers.ordered(order),
        evaluation=evaluation,
        warnings=find_warnings(evaluation, segmentation, problem.labels, result.reason) + others,
    )
