"""One run of the search: where it starts, and the loop of asking and telling (Sec. 5 to 7).

The optimizer may see fewer coordinates than the parameterization has: those of frozen labels stay
as they are at the start. Everything else about a run, how it is seeded and labelled, is decided
by the components that it is given.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from moseg_core.cost import Cost
from moseg_core.errors import PluginError
from moseg_core.evaluation import Evaluator
from moseg_core.method import Ready
from moseg_core.protocols import Centers, Optimizer, Progress, Report, Seeding
from moseg_core.specs import Kind
from moseg_core.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome:
    """What one run found.

    Parameters
    ----------
    vector : (m,) float
    cost : Cost
    reason : str
        "converged", or the limit that ended the search.
    history : mapping of str to tuple of dict
        Records of the stages "seeding" and "search".
    warning : str
        From the seeder; empty where all is well.
    """

    vector: FloatArray
    cost: Cost
    reason: str
    history: Mapping[str, tuple[dict[str, float], ...]]
    warning: str = ""


def search_once(
    evaluator: Evaluator,
    ready: Mapping[Kind, Ready],
    *,
    rng: np.random.Generator,
    report: Report,
    start: Centers | None = None,
    frozen: Sequence[int] = (),
    deadline: float | None = None,
) -> Outcome:
    """Seed, label and optimise.

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
        seeding = _seed(ready["seeder"], evaluator, rng, report)
        vector = partition.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
        if not seeding.labelled:
            vector = partition.permute(vector, _label(ready["labeler"], evaluator, vector))
    else:
        vector = partition.encode(start)
    if not (vector >= partition.lower).all() or not (vector <= partition.upper).all():
        raise PluginError("the search starts outside the bounds of the parameterization")

    free = np.ones(len(vector), np.bool_)
    for label in frozen:
        free[partition.coordinates(label)] = False
    stage = ready["optimizer"].component.spec.name
    history = {"seeding": seeding.history if seeding else ()}
    if not free.any():
        cost = evaluator.evaluate(vector).cost
        return Outcome(
            vector=vector, cost=cost, reason="converged", history={**history, "search": ()}
        )
    search: Optimizer = ready["optimizer"].make(
        vector[free],
        partition.lower[free],
        partition.upper[free],
        partition.scale[free],
        rng=rng,
    )
    reason = run_search(search, evaluator, deadline, report, stage=stage, base=vector, free=free)
    found, cost = search.best
    return Outcome(
        vector=_expand(found[None], vector, free)[0],
        cost=cost,
        reason=reason,
        history={**history, "search": search.history},
        warning=seeding.warning if seeding else "",
    )


def run_search(
    search: Optimizer,
    evaluator: Evaluator,
    deadline: float | None,
    report: Report,
    *,
    stage: str,
    base: FloatArray,
    free: BoolArray,
) -> str:
    """Ask and tell until the optimizer has finished or the time is up; the reason it ended.

    Parameters
    ----------
    search : Optimizer
    evaluator : Evaluator
    deadline : float or None
        On the clock of :func:`time.monotonic`; looked at after each batch.
    report : callable
    stage : str
        What to call the search in reports.
    base : (m,) float
        Values of the coordinates that are not free.
    free : (m,) bool
        The coordinates that the optimizer sees.
    """
    before = evaluator.evaluations
    while not search.finished:
        batch = search.ask()
        search.tell(evaluator.costs(replace(batch, vectors=_expand(batch.vectors, base, free))))
        done = evaluator.evaluations - before
        stop = report(
            Progress(stage=stage, done=done, best=search.best[1], fraction=search.progress)
        )
        if stop and not search.finished:
            return "interrupted"
        if deadline is not None and time.monotonic() >= deadline and not search.finished:
            return "seconds"
    return search.finished


def _expand(vectors: FloatArray, base: FloatArray, free: BoolArray) -> FloatArray:
    """(B, m) whole vectors from the free coordinates."""
    whole = np.repeat(base[None], len(vectors), axis=0)
    whole[:, free] = vectors
    return whole


def _seed(ready: Ready, evaluator: Evaluator, rng: np.random.Generator, report: Report) -> Seeding:
    seeding: Seeding = ready.make()(evaluator, rng=rng, report=report)
    n = evaluator.parameterization.n_parts
    if np.shape(seeding.centers) != (n, 3) or not np.isfinite(seeding.centers).all():
        raise PluginError(
            f"seeder '{ready.component.id}' of {ready.component.distribution} must return"
            f" {n} finite centres, not an array of shape {np.shape(seeding.centers)}"
        )
    return seeding


def _label(ready: Ready, evaluator: Evaluator, vector: FloatArray) -> IntArray:
    order: IntArray = np.asarray(ready.make()(evaluator, vector))
    n = evaluator.parameterization.n_parts
    if sorted(order.tolist()) != list(range(n)):
        raise PluginError(
            f"labeler '{ready.component.id}' of {ready.component.distribution} must return a"
            f" permutation of 0 to {n - 1}, not {order.tolist()}"
        )
    return order
