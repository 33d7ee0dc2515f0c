"""Members that differ: every label set is searched for, and one is chosen.

A recipe whose labels have counts (``leg{2..5}``, :mod:`moseg_core.problem.label_sets`) does not say
which labels a shape has. :func:`segment_variants` solves the problem of each label set
(:class:`moseg_core.problem.variants.Variants`) and takes the one whose parts are most like what the
recipe says of parts (:func:`typical_cost`): the mean of the parts' costs, weighted by the root of
their areas. The total cost would not do: it is a sum over parts, and so it would favour fewer. Of
two results the one with fewer empty parts is better whatever they cost, since an empty part means
that the label set has too many labels.

The label sets share what one search would have: the starts that nobody gave a number for, the
seconds, the processes, which take label sets side by side; and the shape with its coarse version,
fields and neighbours, which are computed once. Label sets compete on the first level; the parts of
the winner are then divided, where they are.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice
from moseg_core.components.protocols import Centers, Progress, Report, never_stop
from moseg_core.errors import MosegError, UsageError
from moseg_core.problem.aggregate import Evaluation
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import Method, OptionValues, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants, parameterization_of
from moseg_core.search.alternatives import chosen_among
from moseg_core.search.levels import check_hierarchy, divided, solve_hierarchy
from moseg_core.search.restarts import Listener, searched_shape
from moseg_core.search.result import Result
from moseg_core.search.segment import solve
from moseg_core.search.workers import Workers
from moseg_core.shape.pins import NO_PINS
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

TRIED = "labels "
"""What the stages of the history begin with that have the record of a label set that was tried."""


def segment_variants(
    shape: Shape,
    recipe: str | Recipe | Statement,
    *,
    start: Centers | Result | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
    **options: Unpack[OptionValues],
) -> Result:
    """Segment a shape by a recipe whose labels have counts, and find out which labels it has.

    Parameters
    ----------
    shape : Shape
    recipe : str, Recipe or Statement
        A recipe's name or path, a recipe, or a statement. Where no label has a count it is
        segmented as by :func:`moseg_core.segment_hierarchy`.
    start, freeze, pins
        As for :func:`moseg_core.segment`, about the first level only. Only label sets that have
        the labels which they name are tried; of a start all labels.
    report : callable, optional
        As for :func:`moseg_core.segment`; the label set stands in front of the stage.
    **options
        The fields of :class:`moseg_core.SearchOptions`. The seconds are shared among the label
        sets, and so are the starts, where neither these options nor the recipe say how many.

    Returns
    -------
    Result
        Of the label set whose parts fit best (:func:`typical_cost`). Its history has a record for
        each that was tried, under "labels torso, leg{4}": number of parts, cost, typical cost, and
        how many parts are empty.

    Raises
    ------
    UsageError
        No term speaks of single parts, so that label sets can't be compared; else as for
        :func:`moseg_core.segment`.
    ShapeError, PluginError
        As for :func:`moseg_core.segment`, with the best that was found as the error's ``result``.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> stated = moseg.Statement(
    ...     labels=("handle", "head", "claw{0..2}"),
    ...     minimize="is(handle, area=0.6+-0.1) + is(head, area=0.4+-0.1) + is(claw*, area=0.4+-0.1)",
    ... )
    >>> result = moseg.segment_variants(hammer, stated, seeder="kmeans", restarts=1)
    >>> list(result.parts)
    ['handle', 'head']
    """
    if isinstance(recipe, str):
        recipe = load_recipe(recipe)
    statement = recipe.statement if isinstance(recipe, Recipe) else recipe
    if not isinstance(statement, Statement):
        raise UsageError(f"segment_variants takes a Recipe or a Statement, not {recipe!r:.60}")
    variants = Variants.of(statement)
    named = {*freeze, *(pins or {})}
    variants = variants.having(named, "freeze and pins") if named else variants
    if isinstance(start, Result):
        variants = variants.having(start.problem.labels, "start", exactly=True)
    return solve_variants(
        shape,
        variants,
        SearchOptions.of(options),
        start=start,
        freeze=freeze,
        pins=pins,
        report=report,
    )


def typical_cost(problem: Problem, evaluation: Evaluation, areas: FloatArray) -> float:
    """How well the parts of a result fit what the problem says of single parts.

    The mean over the parts of what the unary terms say of each, weight times value, summed over the
    terms; weighted by the root of the parts' areas, so that many small parts do not outweigh the
    body, nor the body all limbs. Parts of which no unary term says anything are left out, as are
    empty ones.

    Parameters
    ----------
    problem : Problem
    evaluation : Evaluation
        Of a labelling under this problem.
    areas : (n,) float
        Of each label's part.

    Returns
    -------
    float
        Least is best; 0 where nothing is said of any part.

    Examples
    --------
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]],
    ...                         [[0, 1, 4, 3], [1, 2, 5, 4]])
    >>> problem = Problem(["a", "b"], "2*area_fraction(a, max=0.25) + flat(b)")
    >>> evaluation = problem.evaluate(strip, [0, 1])
    >>> [call.value for term in evaluation.terms for call in term.calls]
    [0.25, 0.0]
    >>> typical_cost(problem, evaluation, strip.areas)
    0.25
    """
    costs = np.full(len(problem.labels), np.nan)
    for term, valued in zip(problem.terms, evaluation.terms, strict=True):
        if term.objective.traits.arity != "unary":
            continue
        for (label,), call in zip(term.calls, valued.calls, strict=True):
            if call.value is not None:
                costs[label] = np.nan_to_num(costs[label]) + term.weight * call.value
    weights = np.where(np.isnan(costs), 0.0, np.sqrt(areas))
    if not weights.any():
        return 0.0
    return float(np.average(np.nan_to_num(costs), weights=weights))


def solve_variants(
    shape: Shape,
    variants: Variants,
    options: SearchOptions,
    *,
    start: Centers | Result | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
) -> Result:
    """The same as :func:`segment_variants`, with names looked up and options in one piece."""
    more: dict[str, Any] = {"start": start, "freeze": freeze, "pins": pins}
    if len(variants.tasks) == 1:
        task = variants.tasks[0]
        options = for_task(options, task, variants)
        return solve_hierarchy(shape, task, options, report=report, **more)
    check_variants(variants, options)
    # More labels than elements: the smaller label sets can still be tried.
    able = [t for t in variants.tasks if len(t.problem.labels) <= shape.n_elements]
    variants = replace(variants, tasks=tuple(able) or variants.tasks[:1])
    listener = Listener(report or never_stop)
    trial = _Trial.of(shape, variants, options, more)
    began = time.monotonic()
    outcomes = trial.run(listener)
    found = [
        (task, outcome.result(shape, task.problem))
        for task, outcome in zip(variants.tasks, outcomes, strict=False)
        if outcome.record
    ]
    failure = next((o.failure for o in outcomes if o.failure is not None), None)
    if not found:
        assert failure is not None  # the first label set is always tried
        raise failure
    scores = {id(result): score(result) for _, result in found}
    best_task, best = min(found, key=lambda pair: scores[id(pair[1])])
    texts = dict(zip(variants.tasks, variants.texts, strict=True))
    chosen = chosen_among(
        best,
        [result for _, result in found],
        failed=failure is not None,
        tried={
            TRIED + texts[task]: (_record(result, scores[id(result)]),) for task, result in found
        },
    )
    if failure is not None:
        failure.result = chosen
        raise failure
    if not best_task.children:
        return chosen
    if options.max_seconds is not None:
        left = max(0.0, options.max_seconds - (time.monotonic() - began))
        options = replace(options, max_seconds=left)
    return divided(chosen, best_task, options, listener)


def check_variants(variants: Variants, options: SearchOptions) -> None:
    """Check for every label set what can be checked before a shape is there.

    Raises
    ------
    UsageError, PluginError
        As for :func:`moseg_core.check_hierarchy`; no term speaks of single parts.
    """
    for task in variants.tasks:
        check_hierarchy(task, for_task(options, task, variants))
    if len(variants.tasks) > 1 and not any(task.problem.unary_terms for task in variants.tasks):
        raise UsageError(
            f"'{variants.statement.minimize}' says nothing of single parts, by which label sets are"
            f" compared; add a term such as is(label, area=0.2+-0.1), or name the labels, such as"
            f' --labels "{variants.texts[-1]}"'
        )


def score(result: Result) -> tuple[int, float]:
    """What label sets are compared by: empty parts and broken pins, then the typical cost."""
    problem = result.problem
    assert isinstance(problem, Problem)  # the first level alone
    areas = np.bincount(result.labels, result.shape.areas, minlength=len(problem.labels))
    return result.evaluation.cost.empty, typical_cost(problem, result.evaluation, areas)


def tried_sets(history: Mapping[str, Sequence[dict[str, float]]]) -> dict[str, dict[str, float]]:
    """The record of each label set that was tried, by its text; of other results none.

    Examples
    --------
    >>> tried_sets({"labels a, b": ({"parts": 2, "typical cost": 0.5},), "restarts": ()})
    {'a, b': {'parts': 2, 'typical cost': 0.5}}
    """
    return {
        stage.removeprefix(TRIED): records[0]
        for stage, records in history.items()
        if stage.startswith(TRIED)
    }


@dataclass(frozen=True)
class _Outcome:
    """What the search for one label set came to, small enough to be sent between processes.

    Parameters
    ----------
    record : dict
        The fields of the result, without the shape and the problem; empty where there is none.
    failure : MosegError or None
    """

    record: dict[str, Any]
    failure: MosegError | None = None

    @classmethod
    def of(cls, result: Result | None, failure: MosegError | None = None) -> _Outcome:
        """That of a search."""
        if failure is not None:
            failure.result = None
        if result is None:
            return cls({}, failure)
        names = (
            "labels",
            "evaluation",
            "centers",
            "history",
            "method",
            "seed",
            "versions",
            "reason",
            "dimension",
            "warnings",
        )
        return cls({name: getattr(result, name) for name in names}, failure)

    def result(self, shape: Shape, problem: Problem) -> Result:
        """The result again."""
        return Result(shape=shape, problem=problem, **self.record)


@dataclass(frozen=True, kw_only=True)
class _Trial:
    """The searches for all label sets.

    Parameters
    ----------
    shape : Shape
    variants : Variants
    options : SearchOptions
    more : dict
        Start, frozen labels and pins.
    processes : int
        How many label sets are searched for side by side.
    deadline : float or None
        On the clock of :func:`time.monotonic`.
    """

    shape: Shape
    variants: Variants
    options: SearchOptions
    more: Mapping[str, Any]
    processes: int
    deadline: float | None

    @classmethod
    def of(
        cls, shape: Shape, variants: Variants, options: SearchOptions, more: Mapping[str, Any]
    ) -> _Trial:
        """Searches that have not begun."""
        seconds = options.max_seconds
        return cls(
            shape=shape,
            variants=variants,
            options=options,
            more=more,
            processes=min(options.workers, len(variants.tasks)),
            deadline=None if seconds is None else time.monotonic() + seconds,
        )

    def run(self, listener: Listener) -> list[_Outcome]:
        """Search for one label set after the other, or several at a time."""
        if self.processes > 1:
            self._prepare()
        with Workers({"search": self.search}, self.processes, listener) as pool:
            return pool.map(
                "search",
                [(k,) for k in range(len(self.variants.tasks))],
                enough=lambda k, outcome: outcome.failure is not None,
            )

    def search(self, k: int, *, report: Report) -> _Outcome:
        """Search for one label set, in its share of the time that is left."""
        task, name = self.variants.tasks[k], self.variants.short_texts[k]
        mine = for_task(self.options, task, self.variants)
        if self.processes > 1:
            mine = replace(mine, workers=1)
        if self.deadline is not None:
            rounds = math.ceil((len(self.variants.tasks) - k) / self.processes)
            inner = sum(1 for _ in task.levels()) - 1
            left = max(0.0, self.deadline - time.monotonic())
            mine = replace(mine, max_seconds=left / (rounds + inner))

        def named(progress: Progress) -> bool:
            return report(replace(progress, stage=f"{name}: {progress.stage}"))

        try:
            return _Outcome.of(
                solve(
                    self.shape,
                    task.problem,
                    mine,
                    defaults=_shared_starts(task, mine, len(self.variants.tasks)),
                    report=named,
                    **self.more,
                )
            )
        except MosegError as error:
            return _Outcome.of(error.result, error)

    def _prepare(self) -> None:
        """Compute what all processes need, before there are any.

        A labelling in slabs asks each objective once: fields, neighbours and whatever else is kept
        with the shape are then known on both levels.
        """
        asked: set[str] = set()
        for task in self.variants.tasks:
            problem = task.problem
            new = {term.call for term in problem.expression.terms} - asked
            if not new:
                continue
            asked |= new
            settled = self.options.settled(task.search)
            embedded = problem.embed(self.shape)
            level = embedded
            if not self.more["pins"]:
                level = searched_shape(embedded, settled.resolution, NO_PINS)
            order = np.argsort(level.points[:, 0], kind="stable")
            slabs = np.empty(level.n_elements, np.int64)
            slabs[order] = np.arange(level.n_elements) * len(problem.labels) // level.n_elements
            problem.evaluate(level, slabs)


def for_task(options: SearchOptions, task: Hierarchy, variants: Variants) -> SearchOptions:
    """The options for one label set: what they say of labels that it lacks is left out."""
    if not isinstance(options.parameterization, Choice):
        return options
    chosen = parameterization_of(
        options.parameterization,
        task.problem.labels,
        variants.statement.declared,
        task.registry,
    )
    return replace(options, parameterization=chosen)


def _shared_starts(task: Hierarchy, options: SearchOptions, count: int) -> Method:
    """How a label set is searched: with its share of the starts, where nobody says how many."""
    if options.restarts is not None or task.search.restarts is not None:
        return task.search
    starts = options.settled(task.search).restarts
    return replace(task.search, restarts=max(1, starts // count))


def _record(result: Result, scored: tuple[int, float]) -> dict[str, float]:
    empty, typical = scored
    return {
        "parts": len(result.problem.labels),
        "cost": result.evaluation.cost.value,
        "typical cost": typical,
        "empty": empty,
    }
