"""The beginning of a search: seeds, labels, constraints and pins obeyed (Sec. 5, 6).

The seeder places centres, the labeler says which label gets which; both are strangers' code, and
what they return is checked here. Centres by hand skip both. :mod:`moseg_core.search.run` goes on
from there.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.profile import stage
from moseg_core.components.protocols import (
    Batch,
    Centers,
    Progress,
    Report,
    Seeding,
)
from moseg_core.errors import REPORT, PluginError, UsageError
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.run import Run, free_coordinates, plain_records, set_up
from moseg_core.types import FloatArray, IntArray

_PLACES = 16
"""Pinned elements of a label that are tried as the place of its centre."""


_STILL = 1e-9
"""How far a frozen centre may move where constraints are made to hold, in diagonals."""


@stage("seeds and labels")
def begin(
    evaluator: ProblemEvaluator,
    ready: Mapping[Kind, PreparedComponent],
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
    evaluator : ProblemEvaluator
    ready : mapping of kind to PreparedComponent
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
        seeding = _seed(ready["seeder"], evaluator, rng, until(deadline, report))
        weights = np.ones(n) if seeding.weights is None else seeding.weights
        vector = partition.encode(Centers(positions=seeding.centers, weights=weights))
        if not seeding.labelled:
            vector = partition.permute(vector, _label(ready["labeler"], evaluator, vector))
            # Labels that have pins were assigned by their pins, and keep their centres.
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


def _made_feasible(
    evaluator: ProblemEvaluator, vector: FloatArray, start: Centers | None, frozen: Sequence[int]
) -> FloatArray:
    """(m,) float: feasible centres near to those of a vector, frozen ones where they start."""
    constraints, partition = evaluator.constraints, evaluator.parameterization
    if start is None:
        return constraints.feasible(vector)
    feasible = constraints.holding(vector, frozen)
    for label in frozen:
        places = partition.coordinates(label)
        if np.abs(feasible[places] - vector[places]).max() > _STILL:
            name = evaluator.problem.labels[label]
            raise UsageError(
                f"label '{name}' is frozen at a place that the constraints do not allow; leave out"
                f" the constraint or --freeze {name}, or start from a result that obeys it"
            )
    return feasible


def _towards_pins(
    evaluator: ProblemEvaluator, vector: FloatArray, frozen: Sequence[int]
) -> FloatArray:
    """Start where fewer pins are broken: centres moved to the pinned elements of their labels.

    The search only notices a pin when an element changes its part, so it needs to start near. Of a
    label's several centres the one nearest to the place is moved there.
    """
    partition, pins, shape = evaluator.parameterization, evaluator.pins, evaluator.shape
    constraints = evaluator.constraints
    held = ~free_coordinates(constraints, frozen)
    base = constraints.reduce(vector)
    for label in np.unique(pins.labels):
        if label in frozen or not pins.broken(evaluator.labels(vector)):
            continue
        pinned = shape.points[pins.elements[pins.labels == label]]
        centers = partition.decode(vector)
        tried = [vector]
        for place in [pinned.mean(axis=0), *pinned[:_PLACES]]:
            positions = centers.positions.copy()
            own = np.arange(len(positions)) if centers.parts is None else centers.parts
            mine = np.flatnonzero(own == label)
            near = mine[np.argmin(((positions[mine] - place) ** 2).sum(axis=1))]
            positions[near] = place
            moved = partition.encode(replace(centers, positions=positions))
            free = constraints.reduce(constraints.holding(moved, [int(label)]))
            free[held] = base[held]
            tried.append(constraints.expand(free[None])[0])
        costs = evaluator.costs(Batch(vectors=np.stack(tried), best_only=True))
        vector = tried[min(range(len(costs)), key=lambda k: (costs[k], k))]
    return vector


def _seed(
    ready: PreparedComponent, evaluator: ProblemEvaluator, rng: np.random.Generator, report: Report
) -> Seeding:
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
    weights = _weights(seeding, n)
    if weights is None and seeding.weights is not None:
        raise PluginError(
            f"{ready.who} must weigh {n} centres by positive, finite numbers, or return None for"
            f" weights of 1, not {seeding.weights!r:.80}; {REPORT}"
        )
    with ready.guard("has a history that is not made of numbers"):
        history = plain_records(seeding.history)
    return replace(seeding, centers=centers, weights=weights, history=history)


def _weights(seeding: Seeding, n: int) -> FloatArray | None:
    """(n,) float: the weights that a seeder gives; None where it gives none, or impossible ones."""
    if seeding.weights is None:
        return None
    try:
        weights = np.asarray(seeding.weights, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    fits = weights.shape == (n,) and bool((np.isfinite(weights) & (weights > 0)).all())
    return weights if fits else None


def until(deadline: float | None, report: Report) -> Report:
    """The reporting function, which also asks to stop when the time is up."""

    def listen(progress: Progress) -> bool:
        late = deadline is not None and time.monotonic() >= deadline
        return report(progress) or late

    return listen


def _label(ready: PreparedComponent, evaluator: ProblemEvaluator, vector: FloatArray) -> IntArray:
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
