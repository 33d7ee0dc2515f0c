"""One run of the search: an optimizer, asked and told until it ends (Sec. 7).

A run can be paused and go on later: of several starts (:mod:`moseg_core.search.restarts`) those
that look poor after a while are not finished. The optimizer may see fewer coordinates than the
parameterization has: what constraints determine (:mod:`moseg_core.problem.constraints`) is left
out, and those of frozen labels stay as they are at the start. Where a run begins is the business
of :mod:`moseg_core.search.beginning`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.cost import WORST, Cost
from moseg_core.components.profile import timed
from moseg_core.components.protocols import (
    Batch,
    Optimizer,
    Progress,
    Report,
    Seeding,
)
from moseg_core.errors import REPORT, MosegError, PluginError
from moseg_core.problem.constraints import Constraints
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.incumbents import START, Improvement, Incumbent, followed, note
from moseg_core.types import BoolArray, FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class RunOutcome:
    """What one run found.

    Parameters
    ----------
    vector : (m,) float
    cost : Cost
    reason : str
        "converged", "paused", "failed", or the limit that ended the search.
    history : mapping of str to tuple of dict
        Records of the stages "seeding" and "search".
    warning : str
        From the seeder; empty where all is well.
    failure : MosegError or None
        What ended the search, where that was an error.
    evaluations : int
        Candidates evaluated so far.
    incumbents : tuple of Incumbent
        How the search came there.
    """

    vector: FloatArray
    cost: Cost
    reason: str
    history: Mapping[str, tuple[dict[str, float], ...]]
    warning: str = ""
    failure: MosegError | None = None
    evaluations: int = 0
    incumbents: tuple[Incumbent, ...] = ()


@dataclass(eq=False, kw_only=True)
class Run:
    """A search under way: an optimizer, and what it does not know of.

    Parameters
    ----------
    search : Optimizer or None
        None where no coordinate is free.
    base : (k,) float
        Where it began, in the coordinates that the constraints leave, with the values of those
        that are not free.
    free : (k,) bool
        The coordinates that the optimizer sees.
    stage : str
        What to call it in reports and in the history.
    seeding : tuple of dict
        History of the seeder.
    warning : str
        From the seeder; empty where all is well.
    evaluations : int
        Candidates evaluated so far.
    earlier : tuple of dict
        History of the search that this one goes on from.
    improvements : list of Improvement
        The optimizer's best, each time that it had become better.
    incumbents : tuple of Incumbent
        Of the search that this one goes on from.
    """

    search: Optimizer | None
    base: FloatArray
    free: BoolArray
    stage: str
    seeding: tuple[dict[str, float], ...] = ()
    warning: str = ""
    evaluations: int = 0
    earlier: tuple[dict[str, float], ...] = ()
    improvements: list[Improvement] = field(default_factory=list)
    incumbents: tuple[Incumbent, ...] = ()


def set_up(
    evaluator: ProblemEvaluator,
    ready: PreparedComponent,
    vector: FloatArray,
    *,
    rng: np.random.Generator,
    frozen: Sequence[int],
    stage: str,
    seeding: Seeding | None = None,
) -> Run:
    """An optimizer over the coordinates that neither constraints determine nor labels freeze."""
    constraints = evaluator.constraints
    base = constraints.reduce(vector)
    free = free_coordinates(constraints, frozen)
    search: Optimizer | None = None
    if free.any():
        bounds = constraints.lower[free], constraints.upper[free], constraints.scale[free]
        search = ready.make(base[free].clip(bounds[0], bounds[1]), *bounds, rng=rng)
    return Run(
        search=search,
        base=base,
        free=free,
        stage=stage,
        seeding=tuple(seeding.history) if seeding else (),
        warning=seeding.warning if seeding else "",
    )


def anew(
    run: Run,
    outcome: RunOutcome,
    evaluator: ProblemEvaluator,
    ready: PreparedComponent,
    *,
    frozen: Sequence[int],
) -> Run:
    """The run taken up from the vector of an outcome, by an optimizer that begins there."""
    stage = "polish" if run.stage == "polish" else "search"
    rng = np.random.default_rng(0)
    begun = set_up(evaluator, ready, outcome.vector, rng=rng, frozen=frozen, stage=run.stage)
    return replace(
        begun,
        seeding=run.seeding,
        warning=run.warning,
        evaluations=run.evaluations,
        earlier=outcome.history[stage],
        incumbents=outcome.incumbents,
    )


def go_on(
    run: Run,
    evaluator: ProblemEvaluator,
    ready: PreparedComponent,
    *,
    report: Report,
    deadline: float | None = None,
    until: float = math.inf,
) -> RunOutcome:
    """Ask and tell until the optimizer has finished, or something says stop.

    Parameters
    ----------
    run : Run
    evaluator : ProblemEvaluator
    ready : PreparedComponent
        What the optimizer was made from, to call it by its name.
    report : callable
    deadline : float, optional
        On the clock of :func:`time.monotonic`; looked at after each batch.
    until : float
        After how many evaluations to pause; the outcome's reason is then "paused".

    Returns
    -------
    RunOutcome
        Its history has the stages "seeding", where there was one, and "search" or "polish".
    """
    stage = "polish" if run.stage == "polish" else "search"
    seeding = {} if stage == "polish" else {"seeding": run.seeding}
    search = run.search
    if search is None:
        vector = evaluator.constraints.expand(run.base[None])[0]
        cost = evaluator.evaluate(vector).cost
        return RunOutcome(
            vector=vector,
            cost=cost,
            reason="converged",
            history={**seeding, stage: run.earlier},
            warning=run.warning,
            evaluations=run.evaluations,
            incumbents=run.incumbents,
        )
    with timed("stage", stage):
        reason = _ask_and_tell(run, search, evaluator, ready, report, deadline, until)
    with ready.guard():
        (found, cost), records = search.best, plain_records(search.history)
    return RunOutcome(
        vector=evaluator.constraints.expand(_filled(found[None], run.base, run.free))[0],
        cost=cost,
        reason=reason,
        history={**seeding, stage: _followed(run.earlier, records)},
        warning=run.warning,
        evaluations=run.evaluations,
        incumbents=followed(run.incumbents, _incumbents(run, evaluator)),
    )


def _ask_and_tell(
    run: Run,
    search: Optimizer,
    evaluator: ProblemEvaluator,
    ready: PreparedComponent,
    report: Report,
    deadline: float | None,
    until: float,
) -> str:
    """The loop; why it ended."""
    with ready.guard():
        finished = search.finished
    least = run.improvements[-1].cost if run.improvements else WORST
    while not finished:
        if run.evaluations >= until:
            return "paused"
        batch = _ask(ready, search, int(run.free.sum()))
        costs = _costs(evaluator, batch, _filled(batch.vectors, run.base, run.free))
        with ready.guard():
            search.tell(costs)
            finished, (found, best), fraction = search.finished, search.best, search.progress
        run.evaluations += len(batch.vectors)
        if best < least and math.isfinite(best.value):
            least = best
            _note(run, found, best)
        stop = report(Progress(stage=run.stage, done=run.evaluations, best=best, fraction=fraction))
        if stop and not finished:
            return "interrupted"
        if deadline is not None and time.monotonic() >= deadline and not finished:
            return "seconds"
    return finished


def _note(run: Run, found: FloatArray, cost: Cost) -> None:
    """Note an incumbent of a run, in the coordinates that the constraints leave."""
    vector = _filled(np.asarray(found)[None], run.base, run.free)[0]
    first = not run.improvements and not run.incumbents and run.stage != "polish"
    stage = "polish" if run.stage == "polish" else "search"
    if first and np.array_equal(vector, run.base):
        stage = START
    note(run.improvements, Improvement(stage, run.evaluations, cost, vector))


def _incumbents(run: Run, evaluator: ProblemEvaluator) -> list[Incumbent]:
    """The improvements of a run, as centres."""
    if not run.improvements:
        return []
    vectors = evaluator.constraints.expand(np.array([step.vector for step in run.improvements]))
    return [
        Incumbent(
            stage=step.stage,
            evaluations=step.evaluations,
            cost=step.cost,
            centers=evaluator.parameterization.decode(vector),
        )
        for step, vector in zip(run.improvements, vectors, strict=True)
    ]


def _costs(evaluator: ProblemEvaluator, batch: Batch, free: FloatArray) -> list[Cost]:
    """Costs of a batch; those that constraints lead out of the bounds are as bad as can be."""
    vectors = evaluator.constraints.expand(free)
    inside = evaluator.constraints.within(vectors)
    if inside.all():
        return evaluator.costs(replace(batch, vectors=vectors))
    costs = [WORST] * len(vectors)
    if inside.any():
        found = evaluator.costs(replace(batch, vectors=vectors[inside]))
        for k, cost in zip(np.flatnonzero(inside).tolist(), found, strict=True):
            costs[k] = cost
    return costs


def free_coordinates(constraints: Constraints, frozen: Sequence[int]) -> BoolArray:
    """(k,) bool: the coordinates that do not decide about a frozen label."""
    free = np.ones(constraints.n_free, np.bool_)
    for label in frozen:
        free[constraints.coordinates(label)] = False
    return free


def _filled(vectors: FloatArray, base: FloatArray, free: BoolArray) -> FloatArray:
    """(B, k) vectors with the coordinates that are not free at their base."""
    whole = np.repeat(base[None], len(vectors), axis=0)
    whole[:, free] = vectors
    return whole


def _followed(
    earlier: tuple[dict[str, float], ...], records: tuple[dict[str, float], ...]
) -> tuple[dict[str, float], ...]:
    """Records of two searches as those of one, evaluations counted on."""
    done = earlier[-1].get("evaluations", 0) if earlier else 0
    counted = ("evaluations" in record for record in records)
    return earlier + tuple(
        {**record, "evaluations": record["evaluations"] + done} if counts else record
        for record, counts in zip(records, counted, strict=True)
    )


def plain_records(
    history: Sequence[Mapping[str, float]],
) -> tuple[dict[str, float], ...]:
    """Records of plain numbers, whatever number types a component keeps; others raise."""
    return tuple(
        {
            str(key): int(value) if isinstance(value, (int, np.integer)) else float(value)
            for key, value in record.items()
        }
        for record in history
    )


def _ask(ready: PreparedComponent, search: Optimizer, size: int) -> Batch:
    """Ask the optimizer, and check that it asks for something."""
    with ready.guard():
        batch = search.ask()
    try:
        vectors = np.asarray(batch.vectors, dtype=np.float64)
        fits = isinstance(batch, Batch) and vectors.ndim == 2 and len(vectors) > 0
        fits = fits and vectors.shape[1] == size and bool(np.isfinite(vectors).all())
    except (AttributeError, TypeError, ValueError):
        fits = False
    if not fits:
        raise PluginError(
            f"{ready.who} must ask for a Batch of one or more finite vectors of {size} numbers;"
            f" {REPORT}"
        )
    return replace(batch, vectors=vectors)
