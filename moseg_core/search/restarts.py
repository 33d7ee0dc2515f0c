"""Several starts, on a coarse shape first: how the searches of one run are put together.

A shape of many elements is searched on a coarse version of it (:mod:`moseg_core.shape.coarse`),
from several starts; :mod:`moseg_core.search.run` does a single one. Where a search ends hangs more
on where it began than on how long it took, so many are tried for a while, the better half goes on
for longer, and so forth, until a few finalists are left that go on to the end (successive halving:
Jamieson and Talwalkar 2016, arXiv:1502.07943). What was found is then partitioned element by
element, ranked by what it costs now, and the first few are polished: a short search with small
steps (:func:`polisher`), of which there is no need where a refiner moves all boundaries anyway. Of
a large mesh that is done on a third level, of :data:`FINER` times as many super-elements, so that a
search takes no longer on a million faces than on fifty thousand. The cost that is reported is
always that of the input elements, and so is the choice by cost.

Starts, finalists and polishing go to several processes (:mod:`moseg_core.search.workers`), if
wanted. What is found does not depend on their number.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from moseg_core.components.chosen import PreparedComponent, prepare
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Registry
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.profile import timed
from moseg_core.components.protocols import Centers, Progress, Report, placed
from moseg_core.errors import MosegError, UsageError
from moseg_core.problem.settings import SearchOptions
from moseg_core.search.beginning import begin
from moseg_core.search.best_so_far import TrackedWorkers
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.exchange import exchanged_vector
from moseg_core.search.incumbents import EXCHANGE, Incumbent, followed
from moseg_core.search.run import Run, RunOutcome, anew, go_on, set_up
from moseg_core.search.workers import Task, Workers
from moseg_core.shape.coarse import WORTH, coarse_pins, coarsen
from moseg_core.shape.pins import Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

#: After how many evaluations for each coordinate starts are first judged, and by what factor
#: this grows from each time to the next, when half as many are left.
_TRIAL, _LONGER = 20, 3
#: How many times as many elements as the search has the polish has at most. Where the search has
#: 2000, those of the polish are between a quarter and three quarters of a percent of the diagonal
#: across, on a hammer, a cow and a cup.
FINER = 20


#: A result that costs so many times as much on input elements as on super-elements has lost
#: something between the levels: a thin part is in pieces, or touches nothing any more.
_LOST = 1.5


class Listener:
    """Passes reports on, and remembers that it was once asked to stop."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self.stopped = False

    def __call__(self, progress: Progress) -> bool:
        """Pass a report on; whether anybody has asked to stop so far."""
        self.stopped = bool(self._report(progress)) or self.stopped
        return self.stopped


def searched_shape(shape: Shape, resolution: int | str, pins: Pins) -> Shape:
    """The shape to search on: a coarse one where that is clearly smaller."""
    if resolution == "full" or shape.n_elements <= WORTH * int(resolution):
        return shape
    with timed("stage", "super-elements"):
        coarse = coarsen(shape, int(resolution), pins=pins)
    return coarse if shape.n_elements > WORTH * coarse.n_elements else shape


def on_level(
    whole: ProblemEvaluator, resolution: int | str, parameterization: PreparedComponent
) -> ProblemEvaluator:
    """The evaluator on about so many super-elements; the same where those would hardly be fewer."""
    level = searched_shape(whole.shape, resolution, whole.pins)
    if level is whole.shape:
        return whole
    partition = make_partition(parameterization, level, whole.problem)
    pins = coarse_pins(whole.pins, level)
    return ProblemEvaluator(level, whole.problem, partition, pins=pins, input=whole)


def polisher(optimizer: PreparedComponent, registry: Registry) -> PreparedComponent:
    """What polishes: the optimizer itself where it names parameters for that, else the default one.

    Parameters
    ----------
    optimizer : PreparedComponent
        The one of the search.
    registry : Registry
        Where to find the default one.
    """
    if "polish" not in optimizer.presets:
        optimizer = prepare(SearchOptions().settled().optimizer, "optimizer", registry)
    return optimizer.preset("polish")


@dataclass(frozen=True, eq=False, kw_only=True)
class Attempt:
    """A start, as far as it has come.

    Parameters
    ----------
    run : Run
    outcome : RunOutcome
    drew : bool
        Whether random numbers were drawn: without any, all starts are the same.
    """

    run: Run
    outcome: RunOutcome
    drew: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """Everything that the starts of a run have in common.

    Parameters
    ----------
    coarse, whole : ProblemEvaluator
        On the shape that is searched, and on that of the input elements; one and the same where
        those are searched.
    resolution : int or "full"
        About how many elements the coarse shape has.
    ready : mapping of kind to PreparedComponent
    restarts, finalists, polished : int
        Number of starts, how many of them go on to the end, and how many of what they find on a
        coarse shape are polished.
    seed : int
    start : Centers or None
        Where all begin, instead of seeding and labeling.
    frozen : sequence of int
        Labels whose centres stay where they start.
    deadline : float or None
        On the clock of :func:`time.monotonic`.
    repeats : bool
        Whether starts that draw no random numbers are repeated all the same.
    exchanges : bool
        Whether labels are exchanged where that costs less (:mod:`moseg_core.search.exchange`).
    """

    coarse: ProblemEvaluator
    whole: ProblemEvaluator
    resolution: int | str
    ready: Mapping[Kind, PreparedComponent]
    restarts: int
    finalists: int
    polished: int
    seed: int
    start: Centers | None
    frozen: Sequence[int]
    deadline: float | None
    repeats: bool
    exchanges: bool

    @property
    def is_large(self) -> bool:
        """Whether results are polished on a level between the two."""
        if self.coarse is self.whole:
            return False
        return self.whole.shape.n_elements > WORTH * FINER * int(self.resolution)

    @cached_property
    def fine(self) -> ProblemEvaluator:
        """On the shape on which results are polished; made when the first one is."""
        if not self.is_large:
            return self.whole
        resolution = FINER * int(self.resolution)
        return on_level(self.whole, resolution, self.ready["parameterization"])

    @property
    def races(self) -> bool:
        """Whether starts are judged before their end; a limit on evaluations is its own end."""
        limit = self.ready["optimizer"].parameters.get("max_evaluations")
        return self.finalists < self.restarts and limit is None

    @property
    def varies(self) -> bool:
        """Whether later starts are seeded in another way; what is frozen stays in one place."""
        anew = self.start is None and not self.frozen
        return anew and "again" in self.ready["seeder"].presets

    def attempt(self, k: int, *, report: Report) -> Attempt:
        """Start number `k`: search for a while, or to the end where none is dropped."""
        report = placed(report, _counted("start", k, self.restarts))
        rng = np.random.default_rng(self.seed if k == 0 else [self.seed, k])
        fresh = rng.bit_generator.state
        ready = dict(self.ready)
        if k > 0 and self.varies:
            ready["seeder"] = ready["seeder"].varied()
        run = begin(
            self.coarse,
            ready,
            rng=rng,
            report=report,
            start=self.start,
            frozen=self.frozen,
            deadline=self.deadline,
        )
        until = _TRIAL * int(run.free.sum()) if self.races else math.inf
        run, outcome = self.further(run, until, report=report)
        return Attempt(run=run, outcome=outcome, drew=rng.bit_generator.state != fresh)

    def further(self, run: Run, until: float, *, report: Report) -> tuple[Run, RunOutcome]:
        """Search until so many evaluations are done.

        The run comes back, since it may have been a copy, or taken up anew from other labels.
        """
        optimizer = self.ready["optimizer"]
        outcome = go_on(
            run, self.coarse, optimizer, report=report, deadline=self.deadline, until=until
        )
        if outcome.reason != "paused":
            return run, self.settled(run, outcome, self.coarse, report=report)
        better = self.exchanged(outcome, self.coarse)
        if better is not outcome:
            run = anew(run, better, self.coarse, optimizer, frozen=self.frozen)
        return run, better

    def resumed(
        self, run: Run, until: float, k: int, left: int, *, report: Report
    ) -> tuple[Run, RunOutcome]:
        """The same of the search that is the `k`-th of so many that are left."""
        return self.further(run, until, report=placed(report, f"{k + 1} of the best {left}"))

    def exchanged(self, outcome: RunOutcome, evaluator: ProblemEvaluator) -> RunOutcome:
        """The same where no exchange of labels lowers its cost, else that with other labels."""
        if not self.exchanges or outcome.reason in ("interrupted", "seconds"):
            return outcome
        vector, cost = exchanged_vector(evaluator, outcome.vector, outcome.cost, frozen=self.frozen)
        if vector is outcome.vector:
            return outcome
        centers = evaluator.parameterization.decode(vector)
        step = Incumbent(
            stage=EXCHANGE, evaluations=outcome.evaluations, cost=cost, centers=centers
        )
        incumbents = followed(outcome.incumbents, [step])
        return replace(outcome, vector=vector, cost=cost, incumbents=incumbents)

    def settled(
        self, run: Run, outcome: RunOutcome, evaluator: ProblemEvaluator, *, report: Report
    ) -> RunOutcome:
        """The end of a search: labels exchanged and centres moved by turns while that helps."""
        while (better := self.exchanged(outcome, evaluator)) is not outcome:
            if better.reason != "converged":  # a limit on evaluations is kept
                return better
            ready = polisher(self.ready["optimizer"], evaluator.problem.registry)
            run = anew(run, better, evaluator, ready, frozen=self.frozen)
            reason = better.reason
            outcome = go_on(run, evaluator, ready, report=report, deadline=self.deadline)
            if outcome.reason == "evaluations":  # that of a short search, as it is meant to be
                outcome = replace(outcome, reason=reason)
        return outcome

    def polish(self, outcome: RunOutcome, k: int, of: int, *, report: Report) -> RunOutcome:
        """Improve on more elements what was found on super-elements, the `k`-th of so many.

        Vector and cost that come back are those on the finer level.
        """
        report = placed(report, _counted("result", k, of))
        fine, whole = self.fine, self.whole
        ready = polisher(self.ready["optimizer"], whole.problem.registry)
        rng = np.random.default_rng(0)
        vector = carried(outcome.vector, whole, fine)
        run = set_up(fine, ready, vector, rng=rng, frozen=self.frozen, stage="polish")
        better = go_on(run, fine, ready, report=report, deadline=self.deadline)
        better = self.settled(run, better, fine, report=report)
        reason = "seconds" if better.reason == "seconds" else outcome.reason
        done = outcome.evaluations
        return replace(
            better,
            reason=reason,
            history={**outcome.history, **better.history},
            warning=outcome.warning,
            evaluations=done + better.evaluations,
            incumbents=followed(outcome.incumbents, better.incumbents, done=done),
        )


def _counted(what: str, k: int, of: int) -> str:
    """The place of one of several, counted from 0; empty for an only one."""
    return f"{what} {k + 1} of {of}" if of > 1 else ""


def carried(vector: FloatArray, there: ProblemEvaluator, here: ProblemEvaluator) -> FloatArray:
    """(m,) float: the vector of the same centres on another level of the shape."""
    if there is here:
        return vector
    return here.parameterization.encode(there.parameterization.decode(vector))


def carry_out(plan: Plan, workers: int, listener: Listener) -> tuple[list[RunOutcome], RunOutcome]:
    """Run all starts.

    Parameters
    ----------
    plan : Plan
    workers : int
        Number of processes.
    listener : Listener

    Returns
    -------
    outcomes : list of RunOutcome
        Of every start, on the shape that was searched; "paused" where it was not a finalist.
        Empty where the run failed.
    best : RunOutcome
        On input elements. It carries the error, where one ended the run.

    Raises
    ------
    MosegError
        Before anything was found.
    """
    tasks: dict[str, Task] = {
        "attempt": plan.attempt,
        "resumed": plan.resumed,
        "polish": plan.polish,
    }
    for level in (plan.coarse, plan.whole):
        level.shape.make_ready()
    tracked = TrackedWorkers(plan.coarse, plan.whole)
    with Workers(tracked.tasks(tasks), workers, listener) as pool:
        tracked.join(pool)
        try:
            outcomes = all_starts(plan, tracked)
            if plan.coarse is plan.whole:
                return outcomes, min(outcomes, key=lambda outcome: outcome.cost)
            return outcomes, finish(plan, outcomes, tracked)
        except MosegError as error:
            best = tracked.best_found(error)
            if best is None:
                raise
            return [], best


def all_starts(plan: Plan, pool: TrackedWorkers) -> list[RunOutcome]:
    """Run the search from every start, until asked to stop.

    A run that draws no random numbers, and would be seeded no other way, is the same each time; it
    is repeated only on request.
    """

    def alone(k: int, attempt: Attempt) -> bool:
        return k == 0 and not (plan.repeats or attempt.drew or plan.varies)

    def enough(k: int, attempt: Attempt) -> bool:
        return alone(k, attempt) or attempt.outcome.reason == "seconds"

    attempts = pool.map("attempt", [(k,) for k in range(plan.restarts)], enough=enough)
    if alone(0, attempts[0]):
        attempts = attempts[:1]
    outcomes = [attempt.outcome for attempt in attempts]
    runs = [attempt.run for attempt in attempts]
    left = _distinct(plan.coarse, outcomes)
    until = float(_TRIAL * int(runs[0].free.sum()))
    while math.isfinite(until):
        keep = max(plan.finalists, -(-len(left) // 2))
        until = until * _LONGER if keep > plan.finalists else math.inf
        left = sorted(left, key=lambda k: outcomes[k].cost)[:keep]
        paused = [k for k in left if outcomes[k].reason == "paused"]
        ends = pool.map(
            "resumed", [(runs[k], until, place, len(paused)) for place, k in enumerate(paused)]
        )
        for k, (run, end) in zip(paused, ends, strict=False):  # fewer where asked to stop
            runs[k], outcomes[k] = run, end
    return outcomes


def _distinct(evaluator: ProblemEvaluator, outcomes: Sequence[RunOutcome]) -> list[int]:
    """Numbers of the outcomes, without those that have the labels of an earlier one."""
    found: dict[bytes, int] = {}
    for k, outcome in enumerate(outcomes):
        found.setdefault(evaluator.labels(outcome.vector).tobytes(), k)
    return list(found.values())


def finish(plan: Plan, outcomes: Sequence[RunOutcome], pool: TrackedWorkers) -> RunOutcome:
    """The best of what was found on the coarse shape, by its cost on the whole one.

    The finalists, and all others where each of those loses a part between the levels, are
    partitioned anew. The best on super-elements and the best by what they cost now are polished,
    and the least exact cost wins: one with an empty part comes after all without. Where nothing is
    to be polished, the best on super-elements is all the same if all have lost something.
    """
    coarse, whole = plan.coarse, plan.whole

    def exact(outcome: RunOutcome, level: ProblemEvaluator = coarse) -> RunOutcome:
        vector = carried(outcome.vector, level, whole)
        return replace(outcome, vector=vector, cost=whole.evaluate(vector).cost)

    if plan.is_large:
        # What processes have found out of millions of elements takes room; those that polish are
        # made anew, and share what this one has made by then.
        pool.release()
    by_cost = sorted((outcomes[k] for k in _distinct(coarse, outcomes)), key=lambda o: o.cost)
    finalists = [outcome for outcome in by_cost if outcome.reason != "paused"]
    found = [exact(outcome) for outcome in finalists]
    if all(outcome.cost.empty for outcome in found):
        found += [exact(outcome) for outcome in by_cost if outcome.reason == "paused"]
    # The best on super-elements first: a part that it loses between levels a few steps may mend.
    ranked = [found[0], *sorted(found[1:], key=lambda outcome: outcome.cost)]
    polished: list[RunOutcome] = []
    left = min(outcome.cost for outcome in found)
    count = plan.polished or int(_has_lost(left, (finalists or by_cost)[0].cost))
    if count and (plan.deadline is None or time.monotonic() < plan.deadline):
        first = ranked[:count]
        plan.fine.shape.make_ready(like=whole.shape)
        polished = pool.map("polish", [(each, k, len(first)) for k, each in enumerate(first)])
        if plan.fine is not whole:  # measured in this process alone, as the others were
            polished = [exact(outcome, plan.fine) for outcome in polished]
    best = min([*polished, *ranked], key=lambda outcome: outcome.cost)
    return replace(best, reason="evaluations") if best.reason == "paused" else best


def _has_lost(exact: Cost, coarse: Cost) -> bool:
    """Whether what is left costs clearly more on input elements than the best on super-elements."""
    return exact.empty > coarse.empty or exact.value > _LOST * coarse.value > 0


def shared_budget(
    ready: dict[Kind, PreparedComponent], restarts: int
) -> dict[Kind, PreparedComponent]:
    """The components with a limit on evaluations divided among the starts."""
    optimizer = ready["optimizer"]
    budget = optimizer.parameters.get("max_evaluations")
    if restarts == 1 or budget is None:
        return ready
    if budget < restarts:
        raise UsageError(f"{restarts} starts cannot share {budget} evaluations; allow more")
    shared = {**optimizer.parameters, "max_evaluations": budget // restarts}
    return {**ready, "optimizer": replace(optimizer, parameters=shared)}


def disagreement(outcomes: Sequence[RunOutcome]) -> list[str]:
    """A warning where several starts that went on to the end came to clearly different costs."""
    values = [outcome.cost.value for outcome in outcomes if outcome.reason != "paused"]
    least, greatest = min(values, default=0.0), max(values, default=0.0)
    if greatest - least <= 0.05 * abs(least):
        return []
    of = f" of {len(outcomes)}" if len(values) < len(outcomes) else ""
    return [
        f"{len(values)}{of} starts ended at costs from {least:.4g} to {greatest:.4g}; the best is"
        f" reported, and more starts may find better"
    ]
