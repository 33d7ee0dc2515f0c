"""One run of the search: where it starts, and the loop of asking and telling (Sec. 5 to 7).

A run can be paused and go on later: of several starts (:mod:`moseg_core.starts`) those that look
poor after a while are not finished. The optimizer may see fewer coordinates than the
parameterization has: what constraints determine (:mod:`moseg_core.constraints`) is left out, and
those of frozen labels stay as they are at the start. Everything else about a run, how it is seeded
and labelled, is decided by the components that it is given.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from moseg_core.choice import Ready
from moseg_core.constraints import Constraints
from moseg_core.cost import WORST, Cost
from moseg_core.errors import REPORT, MosegError, PluginError, UsageError
from moseg_core.evaluation import Evaluator
from moseg_core.protocols import (
    Batch,
    Centers,
    Optimizer,
    Progress,
    Report,
    Seeding,
)
from moseg_core.specs import Kind
from moseg_core.types import BoolArray, FloatArray, IntArray

_PLACES = 16
"""Pinned elements of a label that are tried as the place of its centre."""

_STILL = 1e-9
"""How far a frozen centre may move where constraints are made to hold, in diagonals."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
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
    """

    vector: FloatArray
    cost: Cost
    reason: str
    history: Mapping[str, tuple[dict[str, float], ...]]
    warning: str = ""
    failure: MosegError | None = None


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
    """

    search: Optimizer | None
    base: FloatArray
    free: BoolArray
    stage: str
    seeding: tuple[dict[str, float], ...] = ()
    warning: str = ""
    evaluations: int = 0


def begin(
    evaluator: Evaluator,
    ready: Mapping[Kind, Ready],
    *,
    rng: np.random.Generator,
    report: Report,
    start: Centers | None = None,
    frozen: Sequence[int] = (),
    deadline: float | None = None,
) -> Run:
    """Seed and label, and set up the optimizer.

    Parameters
    ----------
    evaluator : Evaluator
    ready : mapping of kind to Ready
        Seeder, labeler and optimizer.
    rng : numpy.random.Generator
    report : callable
    start : Centers, optional
        Centres in the order of the labels, instead of seeding and labeling.
    frozen : sequence of int
        Labels whose centres stay where they start.
    deadline : float, optional
        On the clock of :func:`time.monotonic`.
    """
    partition = evaluator.parameterization
    n = partition.n_parts
    seeding = None
    if start is None:
        seeding = _seed(ready["seeder"], evaluator, rng, _until(deadline, report))
        vector = partition.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
        if not seeding.labelled:
            vector = partition.permute(vector, _label(ready["labeler"], evaluator, vector))
            # Labels with pins were assigned by these, and stay.
            pinned = set(evaluator.pins.labels.tolist())
            free = [[k for k in group if k not in pinned] for group in evaluator.problem.alike]
            order = evaluator.constraints.nearest_order(vector, free)
            vector = partition.permute(vector, order)
    else:
        vector = partition.encode(start)
    if not (
        np.isfinite(vector).all()
        and (vector >= partition.lower).all()
        and (vector <= partition.upper).all()
    ):
        if start is not None:
            raise UsageError("the start must have finite centres and positive, finite weights")
        raise PluginError(f"{ready['seeder'].who} placed centres outside the bounds; {REPORT}")
    vector = _towards_pins(evaluator, _made_feasible(evaluator, vector, start, frozen), frozen)
    return set_up(
        evaluator,
        ready["optimizer"],
        vector,
        rng=rng,
        frozen=frozen,
        stage=ready["optimizer"].component.spec.name,
        seeding=seeding,
    )


def set_up(
    evaluator: Evaluator,
    ready: Ready,
    vector: FloatArray,
    *,
    rng: np.random.Generator,
    frozen: Sequence[int],
    stage: str,
    seeding: Seeding | None = None,
) -> Run:
    """An optimizer over the coordinates that neither constraints determine nor labels freeze."""
    rules = evaluator.constraints
    base = rules.reduce(vector)
    free = _free(rules, frozen)
    search: Optimizer | None = None
    if free.any():
        bounds = rules.lower[free], rules.upper[free], rules.scale[free]
        search = ready.make(base[free].clip(bounds[0], bounds[1]), *bounds, rng=rng)
    return Run(
        search=search,
        base=base,
        free=free,
        stage=stage,
        seeding=tuple(seeding.history) if seeding else (),
        warning=seeding.warning if seeding else "",
    )


def go_on(
    run: Run,
    evaluator: Evaluator,
    ready: Ready,
    *,
    report: Report,
    deadline: float | None = None,
    until: float = math.inf,
) -> Outcome:
    """Ask and tell until the optimizer has finished, or something says stop.

    Parameters
    ----------
    run : Run
    evaluator : Evaluator
    ready : Ready
        What the optimizer was made from, to call it by its name.
    report : callable
    deadline : float, optional
        On the clock of :func:`time.monotonic`; looked at after each batch.
    until : float
        After how many evaluations to pause; the outcome's reason is then "paused".

    Returns
    -------
    Outcome
        Its history has the stages "seeding", where there was one, and "search" or "polish".
    """
    stage = "polish" if run.stage == "polish" else "search"
    seeding = {} if stage == "polish" else {"seeding": run.seeding}
    search = run.search
    if search is None:
        vector = evaluator.constraints.expand(run.base[None])[0]
        cost = evaluator.evaluate(vector).cost
        return Outcome(
            vector=vector,
            cost=cost,
            reason="converged",
            history={**seeding, stage: ()},
            warning=run.warning,
        )
    reason = _ask_and_tell(run, search, evaluator, ready, report, deadline, until)
    with ready.guard():
        (found, cost), records = search.best, _plain_records(search.history)
    return Outcome(
        vector=evaluator.constraints.expand(_filled(found[None], run.base, run.free))[0],
        cost=cost,
        reason=reason,
        history={**seeding, stage: records},
        warning=run.warning,
    )


def _ask_and_tell(
    run: Run,
    search: Optimizer,
    evaluator: Evaluator,
    ready: Ready,
    report: Report,
    deadline: float | None,
    until: float,
) -> str:
    """The loop; why it ended."""
    with ready.guard():
        finished = search.finished
    while not finished:
        if run.evaluations >= until:
            return "paused"
        batch = _ask(ready, search, int(run.free.sum()))
        costs = _costs(evaluator, batch, _filled(batch.vectors, run.base, run.free))
        with ready.guard():
            search.tell(costs)
            finished, best, fraction = search.finished, search.best[1], search.progress
        run.evaluations += len(batch.vectors)
        stop = report(Progress(stage=run.stage, done=run.evaluations, best=best, fraction=fraction))
        if stop and not finished:
            return "interrupted"
        if deadline is not None and time.monotonic() >= deadline and not finished:
            return "seconds"
    return finished


def _costs(evaluator: Evaluator, batch: Batch, free: FloatArray) -> list[Cost]:
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


def _free(rules: Constraints, frozen: Sequence[int]) -> BoolArray:
    """(k,) bool: the coordinates that do not decide about a frozen label."""
    free = np.ones(rules.n_free, np.bool_)
    for label in frozen:
        free[rules.coordinates(label)] = False
    return free


def _made_feasible(
    evaluator: Evaluator, vector: FloatArray, start: Centers | None, frozen: Sequence[int]
) -> FloatArray:
    """(m,) float: feasible centres near to those of a vector, frozen ones where they start."""
    rules, partition = evaluator.constraints, evaluator.parameterization
    if start is None:
        return rules.feasible(vector)
    feasible = rules.holding(vector, frozen)
    for label in frozen:
        places = partition.coordinates(label)
        if np.abs(feasible[places] - vector[places]).max() > _STILL:
            name = evaluator.problem.labels[label]
            raise UsageError(
                f"label '{name}' is frozen at a place that the constraints do not allow; leave out"
                f" the constraint or --freeze {name}, or start from a result that obeys it"
            )
    return feasible


def _towards_pins(evaluator: Evaluator, vector: FloatArray, frozen: Sequence[int]) -> FloatArray:
    """Start where fewer pins are broken: centres moved to the pinned elements of their labels.

    The search only notices a pin when an element changes its part, so it needs to start near.
    """
    partition, pins, shape = evaluator.parameterization, evaluator.pins, evaluator.shape
    rules = evaluator.constraints
    held = ~_free(rules, frozen)
    base = rules.reduce(vector)
    for label in np.unique(pins.labels):
        if label in frozen or not pins.broken(evaluator.labels(vector)):
            continue
        pinned = shape.points[pins.elements[pins.labels == label]]
        centers = partition.decode(vector)
        tried = [vector]
        for place in [pinned.mean(axis=0), *pinned[:_PLACES]]:
            positions = centers.positions.copy()
            positions[label] = place
            moved = partition.encode(replace(centers, positions=positions))
            free = rules.reduce(rules.holding(moved, [int(label)]))
            free[held] = base[held]
            tried.append(rules.expand(free[None])[0])
        costs = evaluator.costs(Batch(vectors=np.stack(tried), best_only=True))
        vector = tried[min(range(len(costs)), key=lambda k: (costs[k], k))]
    return vector


def _filled(vectors: FloatArray, base: FloatArray, free: BoolArray) -> FloatArray:
    """(B, k) vectors with the coordinates that are not free at their base."""
    whole = np.repeat(base[None], len(vectors), axis=0)
    whole[:, free] = vectors
    return whole


def _seed(ready: Ready, evaluator: Evaluator, rng: np.random.Generator, report: Report) -> Seeding:
    """Run the seeder, and check what it returns."""
    seeder = ready.make()
    with ready.guard():
        seeding: Seeding = seeder(evaluator, rng=rng, report=report)
    n = evaluator.parameterization.n_parts
    try:
        centers = np.asarray(seeding.centers, dtype=np.float64)
        fits = isinstance(seeding, Seeding) and centers.shape == (n, 3)
        fits = fits and bool(np.isfinite(centers).all())
    except (AttributeError, TypeError, ValueError):
        fits = False
    if not fits:
        raise PluginError(f"{ready.who} must return a Seeding of {n} finite centres; {REPORT}")
    with ready.guard("has a history that is not made of numbers"):
        history = _plain_records(seeding.history)
    return replace(seeding, centers=centers, history=history)


def _until(deadline: float | None, report: Report) -> Report:
    """The reporting function, which also asks to stop when the time is up."""

    def listen(progress: Progress) -> bool:
        late = deadline is not None and time.monotonic() >= deadline
        return report(progress) or late

    return listen


def _plain_records(
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


def _label(ready: Ready, evaluator: Evaluator, vector: FloatArray) -> IntArray:
    """Run the labeler, and check what it returns."""
    labeler = ready.make()
    with ready.guard():
        order = labeler(evaluator, vector)
    n = evaluator.parameterization.n_parts
    try:
        array = np.asarray(order)
    except ValueError:
        array = np.empty(0)
    if (
        array.shape != (n,)
        or not np.issubdtype(array.dtype, np.integer)
        or sorted(array.tolist()) != list(range(n))
    ):
        raise PluginError(
            f"{ready.who} must return a permutation of 0 to {n - 1}, not {order!r:.80}; {REPORT}"
        )
    return array.astype(np.int64)


def _ask(ready: Ready, search: Optimizer, size: int) -> Batch:
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
