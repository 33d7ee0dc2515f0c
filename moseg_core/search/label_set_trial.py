"""The searches for all label sets of a shape, in one budget (:mod:`moseg_core.search.variants`).

They share the processes, which take label sets side by side; the seconds; and the shape, whose
coarse version, neighbours and fields are computed before there are several processes. What a
process sends back is the result without shape and problem (:class:`Outcome`). What each
search is asked to do is said in :mod:`moseg_core.search.label_set_options`; the last steps
(:mod:`moseg_core.search.last_steps`) are left to whoever knows which label set is taken.

Of many label sets the better half goes on, as of several starts
(:mod:`moseg_core.search.restarts`): all are first searched for briefly, on super-elements alone.
Where a seeder is a search in itself (:class:`moseg_core.components.protocols.Seeder`) and there is
one start, seeds say enough, and the search goes on from them; so of three label sets two go on
already. On 27 models with three or four label sets that were learned from others it dropped the
one that would have been taken once, and as much area was named right as without.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from moseg_core.components.protocols import Centers, Progress, Report, placed
from moseg_core.errors import MosegError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.variants import Variants
from moseg_core.search.label_set_options import (
    brief_search,
    for_task,
    seeds_alone,
    seeds_say_enough,
    shared_starts,
)
from moseg_core.search.restarts import Listener, searched_shape
from moseg_core.search.result import Result
from moseg_core.search.segment import solve
from moseg_core.search.typical_cost import score
from moseg_core.search.workers import Workers
from moseg_core.shape.pins import NO_PINS
from moseg_core.shape.shape import Shape

#: More label sets than this are tried briefly first, and the better half goes on: where seeds say
#: enough, and elsewhere.
_PAIR, _FEW = 2, 4
#: How long a search takes beside a brief one, when they share the seconds.
_LONGER = 3


@dataclass(frozen=True)
class Outcome:
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
    def of(cls, number: int, result: Result | None, failure: MosegError | None = None) -> Outcome:
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
            "incumbents",
            "warnings",
        )
        return cls(number, {name: getattr(result, name) for name in names}, failure)

    def result(self, shape: Shape, problem: Problem) -> Result:
        """The result again."""
        return Result(shape=shape, problem=problem, **self.record)


@dataclass(kw_only=True)
class Trial:
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
    ) -> Trial:
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
            few = _PAIR if self._by_seeds else _FEW
            if len(every) > few and self.options.settings == "default":
                half = math.ceil(len(every) / 2)
                self._take(every, pool, listener, brief=True, later=half)
                if self.failure is not None or listener.stopped:
                    return
                ranked = sorted(self.found, key=lambda k: score(self.found[k]))
                every = self.finalists = sorted(ranked[:half])
            self._take(every, pool, listener, brief=False, later=0)

    def _take(
        self,
        numbers: Sequence[int],
        pool: Workers,
        listener: Listener,
        *,
        brief: bool,
        later: int,
    ) -> None:
        """Search for certain label sets, before so many others.

        The last has all processes, for its starts, where it would else have one and the others
        nothing to do.
        """
        todo = len(numbers)
        work = [
            (k, brief, todo - place, later, None if brief else self._start(k))
            for place, k in enumerate(numbers)
        ]
        shared = work[-1:] if self.processes > 1 and todo % self.processes == 1 else []
        outcomes: list[Outcome] = pool.map(
            "search",
            work[: todo - len(shared)],
            enough=lambda place, outcome: outcome.failure is not None,
        )
        whole = len(outcomes) == todo - len(shared)
        if whole and not listener.stopped and all(each.failure is None for each in outcomes):
            outcomes += [self.search(*each, alone=True, report=listener) for each in shared]
        for outcome in outcomes:
            if outcome.record:
                k = outcome.number
                found = outcome.result(self.shape, self.variants.tasks[k].problem)
                if k in self.found and self._by_seeds:
                    found = replace(found, history={**self.found[k].history, **found.history})
                self.found[k] = found
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

    def _start(self, k: int) -> Centers | None:
        """Where the search for a label set begins, if somebody knows."""
        return self.found[k].centers if self._by_seeds and k in self.found else self.more["start"]

    @cached_property
    def _by_seeds(self) -> bool:
        """Whether seeds say enough of a label set, and the search can go on from them."""
        if self.more["start"] is not None:
            return False
        task = self.variants.tasks[0]
        options = for_task(self.options, task, self.variants)
        return seeds_say_enough(task, options, len(self.variants.tasks))

    def search(
        self,
        k: int,
        brief: bool,
        todo: int,
        later: int,
        start: Centers | None,
        *,
        alone: bool = False,
        report: Report,
    ) -> Outcome:
        """Search for one label set, in its share of the time that is left.

        Parameters
        ----------
        k : int
        brief : bool
            Whether to find seeds alone, where they say enough; else by the components' own
            parameters, from one start.
        todo, later : int
            How many are to be searched for in this way from here on, and in full afterwards.
        start : Centers or None
            Where to begin, in place of seeds.
        alone : bool
            Whether no other is searched for at the same time.
        report : callable
        """
        task, name = self.variants.tasks[k], self.variants.short_texts[k]
        mine = for_task(self.options, task, self.variants)
        method = shared_starts(task, mine, len(self.variants.tasks))
        level = self.shape
        if brief:
            level = self._level(task)
            coarse = level is not self.shape
            if self._by_seeds:
                mine = seeds_alone(mine, method, coarse=coarse)
            else:
                mine, method = brief_search(mine, method, task, coarse=coarse), Method()
        if self.processes > 1 and not alone:
            mine = replace(mine, workers=1)
        if self.deadline is not None:
            rounds = math.ceil(todo / self.processes) + _LONGER * math.ceil(later / self.processes)
            inner = sum(1 for _ in task.levels()) - 1
            left = max(0.0, self.deadline - time.monotonic())
            mine = replace(mine, max_seconds=left / (rounds + inner))

        def named(progress: Progress) -> bool:
            return report(replace(progress, stage=f"{name}: {progress.stage}"))

        with_place = placed(named, f"label set {k + 1} of {len(self.variants.tasks)}")
        try:
            found = solve(
                level,
                task.problem,
                mine,
                defaults=method,
                report=with_place,
                finished=False,
                **{**self.more, "start": start},
            )
        except MosegError as error:
            found = error.result
            return Outcome.of(k, None if found is None else self._on_input(found), error)
        return Outcome.of(k, self._on_input(found))

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
