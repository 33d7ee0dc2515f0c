"""Nothing known but the number of parts, or not even that.

A recipe for any number of parts (:attr:`moseg_core.problem.statement.Statement.is_open`) says what
the parts of any shape are like: joined along short lines in creases, each as thick everywhere.
:func:`segment_parts` takes it at the number that is asked for. Nothing tells its labels apart, so
that they are numbered from the largest part to the smallest (:func:`numbered_by_size`).

Where no number is asked for, each from 2 to a most is tried, and the one with the least cost is
taken. So a recipe for any number of parts should have a cost that compares between numbers of them:
a mean over parts, or over the area, no sum over parts.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from numbers import Integral
from typing import Unpack

import numpy as np

from moseg_core.components.protocols import Progress, Report, never_stop, placed
from moseg_core.errors import MosegError, UsageError, shown
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import OptionValues, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.search.alternatives import chosen_among
from moseg_core.search.described_run import run_of
from moseg_core.search.levels import check_hierarchy, solve_hierarchy
from moseg_core.search.pieces import on_large_pieces
from moseg_core.search.restarts import Listener
from moseg_core.search.result import Result, find_warnings
from moseg_core.shape.shape import Shape

ANY_SHAPE = "basic:any_shape"
"""The recipe for any number of parts where none is named."""

AUTO = "auto"
"""Said in place of a number that is to be found."""

MOST = 12
"""The greatest number of parts that is tried."""

TRIED = "number of parts"
"""The stage of the history with a record for each number that was tried."""


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
    if isinstance(given, str) and given.isdecimal() and len(given) < 10:
        given = int(given)
    if isinstance(given, bool) or not isinstance(given, Integral) or given < 1:
        raise UsageError(
            f"the number of parts must be a number from 1 on or 'auto', not {shown(given)}"
        )
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

    def tasks() -> list[Hierarchy]:
        numbers = numbers_to_try(statement, given)
        return [Hierarchy.of(statement.with_parts(number)) for number in numbers]

    asked = {"parts": str(given), **statement.document()}
    with run_of(shape, tasks, options, asked=asked):
        return _solved(shape, statement, tasks, options, report=report)


def _solved(
    shape: Shape,
    statement: Statement,
    wanted: Callable[[], list[Hierarchy]],
    options: SearchOptions,
    *,
    report: Report,
) -> Result:
    """See :func:`solve_parts`."""
    if options.ignore_pieces_below > 0:
        return on_large_pieces(
            shape,
            options,
            lambda part, rest, _: _solved(part, statement, wanted, rest, report=report),
        )
    tasks = wanted()
    for task in tasks:
        check_hierarchy(task, options)
    if len(tasks) == 1:
        found = solve_hierarchy(shape, tasks[0], options, report=report)
        return numbered_by_size(found, statement)
    # More parts than elements: the smaller numbers can still be tried.
    tasks = [task for task in tasks if _count(task) <= shape.n_elements] or tasks[:1]
    trial = _Trial(listener=Listener(report))
    seconds = options.max_seconds
    deadline = None if seconds is None else time.monotonic() + seconds
    for k, task in enumerate(tasks):
        mine = options
        if deadline is not None:  # each number has its share of what is left
            left = max(0.0, deadline - time.monotonic()) / (len(tasks) - k)
            mine = replace(options, max_seconds=left)
        trial.solve(shape, task, mine, place=f"number {k + 1} of {len(tasks)}")
        if trial.ended:
            break
    best = trial.best()
    if trial.failure is not None:
        trial.failure.result = best
        raise trial.failure
    return numbered_by_size(best, statement)


@dataclass(kw_only=True)
class _Trial:
    """The numbers that were tried so far.

    Parameters
    ----------
    listener : Listener
    found : list of Result
    failure : MosegError or None
        What ended the trial before all numbers had their turn.
    """

    listener: Listener
    found: list[Result] = field(default_factory=list)
    failure: MosegError | None = None

    @property
    def ended(self) -> bool:
        """Whether no other number is to be tried."""
        return self.listener.stopped or self.failure is not None

    def solve(self, shape: Shape, task: Hierarchy, options: SearchOptions, *, place: str) -> None:
        """Try one number."""

        def report(progress: Progress) -> bool:
            stage = f"{_count(task)} parts: {progress.stage}"
            return self.listener(replace(progress, stage=stage))

        try:
            self.found.append(solve_hierarchy(shape, task, options, report=placed(report, place)))
        except MosegError as error:
            if error.result is not None:
                self.found.append(error.result)
            elif not self.found:
                raise
            self.failure = error

    def best(self) -> Result:
        """The result of least cost, with a record of each number and why the whole trial ended."""
        return chosen_among(
            min(self.found, key=lambda result: result.evaluation.cost),
            self.found,
            failed=self.failure is not None,
            tried={TRIED: tuple(map(_record, self.found))},
        )


def _count(task: Hierarchy) -> int:
    """How many parts the whole is cut into."""
    return len(task.problem.labels)


def _record(result: Result) -> dict[str, float]:
    cost = result.evaluation.cost
    problem = result.problem
    whole = problem.problem if isinstance(problem, Hierarchy) else problem
    return {"parts": len(whole.labels), "cost": cost.value, "empty": cost.empty}


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
        As given where the numbers tell parts apart: where the cost or constraints say something of
        one and not of another, or where parts are divided further. Parts of more centres than
        others, as ``voronoi(centers="part1=2")`` gives them, are numbered among themselves.
    """
    problem = result.problem
    if isinstance(problem, Hierarchy) or statement.parts or problem.bound_constraints:
        return result
    areas = np.array([part.area for part in result.parts.values()])
    is_numbered = np.array([label not in statement.labels for label in problem.labels])
    order = np.arange(len(areas))
    for centers in np.unique(result.centers.per_part):
        alike = np.flatnonzero(is_numbered & (result.centers.per_part == centers))
        order[alike] = alike[np.argsort(-areas[alike], kind="stable")]
    rank = np.argsort(order).astype(np.int32)
    labels = rank[result.labels]
    evaluation = problem.evaluate(result.shape, labels)
    if not math.isclose(evaluation.cost.value, result.cost, rel_tol=1e-9, abs_tol=1e-12):
        return result
    found = replace(
        result,
        labels=labels,
        centers=result.centers.ordered(order),
        incumbents=tuple(
            replace(step, centers=step.centers.ordered(order)) for step in result.incumbents
        ),
        evaluation=evaluation,
    )
    told = find_warnings(result.evaluation, result.segmentation, problem.labels, result.reason)
    others = tuple(warning for warning in result.warnings if warning not in told)
    anew = find_warnings(found.evaluation, found.segmentation, problem.labels, found.reason)
    return replace(found, warnings=anew + others)
