"""The whole method in one call: seed, label, optimise (Sec. 4 to 7).

Everything that can be wrong with the request is checked before the work begins: components and
their parameters first, then whether the shape has what the objectives need.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from typing import Any

import numpy as np

from moseg_core.errors import PluginError, UsageError
from moseg_core.evaluation import Evaluator
from moseg_core.method import Choice, Method, Ready, prepare
from moseg_core.problem import Problem
from moseg_core.protocols import Centers, Optimizer, Parameterization, Progress, Report, Seeding
from moseg_core.result import Result, find_warnings
from moseg_core.shape import Shape
from moseg_core.specs import Kind
from moseg_core.types import FloatArray, IntArray

_KINDS: tuple[Kind, ...] = ("parameterization", "seeder", "labeler", "optimizer")


def segment(
    shape: Shape,
    problem: Problem,
    *,
    method: Method | None = None,
    seeder: str | Mapping[str, Any] | Choice | None = None,
    labeler: str | Mapping[str, Any] | Choice | None = None,
    optimizer: str | Mapping[str, Any] | Choice | None = None,
    parameterization: str | Mapping[str, Any] | Choice | None = None,
    seed: int = 0,
    max_seconds: float | None = None,
    report: Report | None = None,
) -> Result:
    """Find the labelled segmentation of a shape that satisfies a problem best.

    Parameters
    ----------
    shape : Shape
    problem : Problem
    method : Method, optional
        All components at once, as a recipe holds them; the paper's by default.
    seeder, labeler, optimizer, parameterization : str, mapping or Choice, optional
        Single components, instead of those of `method`: ``"pattern_search(expansion=2)"``.
    seed : int
        Seed of the random generator; the same seed gives the same result.
    max_seconds : float, optional
        Ends the search after about this time. The result then depends on the machine.
    report : callable, optional
        Receives a :class:`moseg_core.protocols.Progress` now and then.

    Returns
    -------
    Result

    Raises
    ------
    UsageError
        An unknown component or parameter.
    ShapeError
        The shape lacks what an objective needs.
    PluginError
        A component is broken, or broke its contract.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> result = moseg.segment(shape, problem, optimizer="pattern_search(max_evaluations=20)")
    >>> result.labels.shape == (shape.n_elements,)
    True
    """
    method = method or Method()
    given = {
        "parameterization": parameterization,
        "seeder": seeder,
        "labeler": labeler,
        "optimizer": optimizer,
    }
    ready = prepare_method(problem, method, given)
    if seed < 0:
        raise UsageError(f"the seed must not be negative, and is {seed}")
    report = report or _silent
    rng = np.random.default_rng(seed)
    partition: Parameterization = ready["parameterization"].make(shape, len(problem.labels))
    evaluator = Evaluator(shape, problem, partition)

    seeding = _seed(ready["seeder"], evaluator, rng, report)
    n = len(problem.labels)
    vector = partition.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
    vector = partition.permute(vector, _label(ready["labeler"], evaluator, vector))
    search: Optimizer = ready["optimizer"].make(
        vector, partition.lower, partition.upper, partition.scale, rng=rng
    )
    deadline = None if max_seconds is None else time.monotonic() + max_seconds
    reason = run_search(
        search, evaluator, deadline, report, stage=ready["optimizer"].component.spec.name
    )

    vector, _ = search.best
    labels = evaluator.labels(vector)
    evaluation = problem.evaluate(shape, labels, memo=evaluator.memo)
    segmentation = evaluator.segmentation(labels)
    warnings = find_warnings(evaluation, segmentation, problem.labels, reason)
    return Result(
        shape=shape,
        problem=problem,
        labels=labels,
        evaluation=evaluation,
        centers=partition.decode(vector),
        history={"seeding": seeding.history, "search": search.history},
        method={
            kind: str(Choice(ready[kind].component.id, ready[kind].parameters)) for kind in _KINDS
        },
        seed=seed,
        versions=_versions(problem, ready),
        reason=reason,
        warnings=((seeding.warning,) if seeding.warning else ()) + warnings,
    )


def prepare_method(
    problem: Problem,
    method: Method,
    given: Mapping[str, str | Mapping[str, Any] | Choice | None] | None = None,
) -> dict[Kind, Ready]:
    """Find, load and check the components of a run.

    Parameters
    ----------
    problem : Problem
        Says where to look.
    method : Method
    given : mapping of kind to choice or None, optional
        Choices that replace those of the method.

    Raises
    ------
    UsageError, PluginError
        See :func:`moseg_core.method.prepare`.
    """
    ready = {}
    for kind in _KINDS:
        chosen = (given or {}).get(kind)
        choice = getattr(method, kind) if chosen is None else Choice.read(chosen, kind)
        ready[kind] = prepare(choice, kind, problem.registry)
    return ready


def run_search(
    search: Optimizer,
    evaluator: Evaluator,
    deadline: float | None,
    report: Report,
    *,
    stage: str,
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
    """
    before = evaluator.evaluations
    while not search.finished:
        search.tell(evaluator.costs(search.ask()))
        done = evaluator.evaluations - before
        report(Progress(stage=stage, done=done, best=search.best[1], fraction=search.progress))
        if deadline is not None and time.monotonic() >= deadline and not search.finished:
            return "seconds"
    return search.finished


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


def _versions(problem: Problem, ready: Mapping[Kind, Ready]) -> dict[str, str]:
    used = {term.id: term.distribution for term in problem.terms}
    used |= {r.component.id: r.component.distribution for r in ready.values()}
    return dict(sorted(used.items()))


def _silent(progress: Progress) -> None:
    """Report nothing."""
