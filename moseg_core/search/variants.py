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
fields and neighbours, which are computed once. Of more than four, all are searched for briefly, by
the components' own parameters for the settings from one start, and the better half goes on to the
search that was asked for. Label sets compete on the first level; the parts of the winner are then
divided, where they are.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, prepare
from moseg_core.components.protocols import Centers, Progress, Report, never_stop
from moseg_core.errors import MosegError, UsageError
from moseg_core.problem.aggregate import Evaluation
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import NO_REFINER, Method, OptionValues, SearchOptions
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


#: More label sets than this are tried briefly first, and the better half goes on.
_FEW = 4
#: How long a search takes beside a brief one, when they share the seconds.
_LONGER = 3


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
    ...     labels=("handle", "head{1..3}"),
    ...     minimize="is(handle, area=0.6+-0.1) + is(head*, area=0.4+-0.1)",
    ... )
    >>> result = moseg.segment_variants(hammer, stated, seeder="kmeans", restarts=1)
    >>> list(result.parts)
    ['handle', 'head1']
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
    trial.run(listener)
    if not trial.found:
        assert trial.failure is not None  # the first label set is always tried
        raise trial.failure
    best = trial.best()
    chosen = chosen_among(
        trial.found[best],
        [trial.found[k] for k in (trial.finalists or trial.found)],
        failed=trial.failure is not None,
        tried={TRIED + variants.texts[k]: (trial.record(k),) for k in sorted(trial.found)},
    )
    if trial.failure is not None:
        trial.failure.result = chosen
        raise trial.failure
    best_task = variants.tasks[best]
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
    areas = np.zeros(len(problem.labels))
    np.add.at(areas, result.labels, result.shape.areas)
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
    number : int
        Of the label set.
    record : dict
        The fields of the result, without the shape and the problem; empty where there is none.
    failure : MosegError or None
    """

    number: int
    record: dict[str, Any]
    failure: MosegError | None = None

    @classmethod
    def of(cls, number: int, result: Result | None, failure: MosegError | None = None) -> _Outcome:
        """That of a search."""
        if failure is not None:
            failure.result = None
        if result is None:
            return cls(number, {}, failure)
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
        return cls(number, {name: getattr(result, name) for name in names}, failure)

    def result(self, shape: Shape, problem: Problem) -> Result:
        """The result again."""
        return Result(shape=shape, problem=problem, **self.record)


@dataclass(kw_only=True)
class _Trial:
    """The searches for all label sets, and what they have found so far.

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
    found : dict of int to Result
        By the number of the label set.
    finalists : list of int
        Which went on, where all were tried briefly first.
    failure : MosegError or None
        What kept the others from being tried.
    """

    shape: Shape
    variants: Variants
    options: SearchOptions
    more: Mapping[str, Any]
    processes: int
    deadline: float | None
    found: dict[int, Result] = field(default_factory=dict)
    finalists: list[int] = field(default_factory=list)
    failure: MosegError | None = None

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

    def run(self, listener: Listener) -> None:
        """Search for one label set after the other, or several at a time."""
        if self.processes > 1:
            self._prepare()
        every = list(range(len(self.variants.tasks)))
        with Workers({"search": self.search}, self.processes, listener) as pool:
            if len(every) > _FEW and self.options.settings == "default":
                half = math.ceil(len(every) / 2)
                self._take(every, pool, brief=True, later=half)
                if self.failure is not None or listener.stopped:
                    return
                ranked = sorted(self.found, key=lambda k: score(self.found[k]))
                every = self.finalists = sorted(ranked[:half])
            self._take(every, pool, brief=False, later=0)

    def _take(self, numbers: Sequence[int], pool: Workers, *, brief: bool, later: int) -> None:
        """Search for certain label sets, before so many others."""
        todo = len(numbers)
        outcomes: list[_Outcome] = pool.map(
            "search",
            [(k, brief, todo - place, later) for place, k in enumerate(numbers)],
            enough=lambda place, outcome: outcome.failure is not None,
        )
        for outcome in outcomes:
            if outcome.record:
                task = self.variants.tasks[outcome.number]
                self.found[outcome.number] = outcome.result(self.shape, task.problem)
            self.failure = self.failure or outcome.failure

    def best(self) -> int:
        """The number of the label set to take, of those that went on."""
        return min(self.finalists or self.found, key=lambda k: score(self.found[k]))

    def record(self, k: int) -> dict[str, float]:
        """What a label set came to."""
        result = self.found[k]
        empty, typical = score(result)
        return {
            "parts": len(result.problem.labels),
            "cost": result.evaluation.cost.value,
            "typical cost": typical,
            "empty": empty,
            **({"finalist": int(k in self.finalists)} if self.finalists else {}),
        }

    def search(self, k: int, brief: bool, todo: int, later: int, *, report: Report) -> _Outcome:
        """Search for one label set, in its share of the time that is left.

        Parameters
        ----------
        k : int
        brief : bool
            Whether by the components' own parameters, from one start.
        todo, later : int
            How many are to be searched for in this way from here on, and in full afterwards.
        report : callable
        """
        task, name = self.variants.tasks[k], self.variants.short_texts[k]
        mine = for_task(self.options, task, self.variants)
        method = _shared_starts(task, mine, len(self.variants.tasks))
        level = self.shape
        if brief:
            level = self._level(task)
            mine, method = _brief(mine, method, task, coarse=level is not self.shape), Method()
        if self.processes > 1:
            mine = replace(mine, workers=1)
        if self.deadline is not None:
            rounds = math.ceil(todo / self.processes) + _LONGER * math.ceil(later / self.processes)
            inner = sum(1 for _ in task.levels()) - 1
            left = max(0.0, self.deadline - time.monotonic())
            mine = replace(mine, max_seconds=left / (rounds + inner))

        def named(progress: Progress) -> bool:
            return report(replace(progress, stage=f"{name}: {progress.stage}"))

        try:
            found = solve(level, task.problem, mine, defaults=method, report=named, **self.more)
        except MosegError as error:
            found = error.result
            return _Outcome.of(k, None if found is None else self._on_input(found), error)
        return _Outcome.of(k, self._on_input(found))

    def _level(self, task: Hierarchy) -> Shape:
        """What a brief search is done on: super-elements alone, unless elements are pinned."""
        if self.more["pins"]:
            return self.shape
        embedded = task.problem.embed(self.shape)
        resolution = self.options.settled(task.search).resolution
        level = searched_shape(embedded, resolution, NO_PINS)
        return self.shape if level is embedded else level

    def _on_input(self, result: Result) -> Result:
        """A result on super-elements as one on input elements."""
        members = result.shape.members
        if result.shape is self.shape or members is None:
            return result
        labels = result.labels[members]
        evaluation = result.problem.evaluate(self.shape, labels)
        return replace(result, shape=self.shape, labels=labels, evaluation=evaluation)

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
            level = problem.embed(self._level(task))
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


def _brief(
    options: SearchOptions, method: Method, task: Hierarchy, *, coarse: bool
) -> SearchOptions:
    """A short search: the components that were chosen, with their own parameters, from one start.

    On super-elements there is nothing to polish. Parameters of the parameterization stay: they say
    what is searched for.
    """
    settled = options.over(method).settled()
    optimizer = Choice(settled.optimizer.name)
    if coarse:
        ready = prepare(optimizer, "optimizer", task.registry).tuned("default").tuned("coarse")
        optimizer = Choice(settled.optimizer.name, ready.parameters)
    return replace(
        options,
        parameterization=settled.parameterization,
        seeder=Choice(settled.seeder.name),
        labeler=Choice(settled.labeler.name),
        optimizer=optimizer,
        refiner=NO_REFINER,
        resolution="full" if coarse else settled.resolution,
        restarts=1,
        finalists=1,
    )
