"""The whole method in one call: seed, label, optimise (Sec. 4 to 7).

Everything that can be wrong with the request is checked before the work begins: components and
their parameters first, then whether the shape has what the objectives need.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError, unknown
from moseg_core.evaluation import Evaluator
from moseg_core.method import Choice, Method, Ready, prepare
from moseg_core.pins import read_pins
from moseg_core.problem import Problem
from moseg_core.protocols import Centers, Parameterization, Progress, Report
from moseg_core.result import Result, find_warnings
from moseg_core.search import Outcome, search_once
from moseg_core.shape import Shape
from moseg_core.specs import Kind

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
    start: Centers | Result | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    restarts: int = 1,
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
    start : Centers or Result, optional
        Go on from these centres, one per label in the problem's order, instead of seeding.
    freeze : sequence of str
        Labels whose centre and weight stay where they start.
    pins : mapping of str to array_like of int, optional
        Elements that must bear a label: ``{"head": [120, 121]}``.
    restarts : int
        Number of starts, each with random numbers of its own. They share a limit on evaluations
        and seconds; the best result is returned, the costs of all are in its history.
    seed : int
        Seed of the random generator; the same seed gives the same result.
    max_seconds : float, optional
        Ends the search after about this time. The result then depends on the machine.
    report : callable, optional
        Receives a :class:`moseg_core.protocols.Progress` now and then; ends the run with the
        best found so far by returning True.

    Returns
    -------
    Result

    Raises
    ------
    UsageError
        An unknown component, parameter or label; a start that does not fit the problem.
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
    given = {
        "parameterization": parameterization,
        "seeder": seeder,
        "labeler": labeler,
        "optimizer": optimizer,
    }
    ready = prepare_method(problem, method or Method(), given)
    if seed < 0:
        raise UsageError(f"the seed must not be negative, and is {seed}")
    if restarts < 1:
        raise UsageError(f"there must be at least one start, not {restarts}")
    frozen = [_label_index(problem, name) for name in freeze]
    partition: Parameterization = ready["parameterization"].make(shape, len(problem.labels))
    evaluator = Evaluator(
        shape,
        problem,
        partition,
        pins=read_pins(pins or {}, problem.labels, shape.n_elements),
    )
    outcomes = _all_starts(
        evaluator,
        _shared_budget(ready, restarts),
        restarts,
        seed,
        report or _silent,
        start=_start_centers(start, problem),
        frozen=frozen,
        deadline=None if max_seconds is None else time.monotonic() + max_seconds,
    )
    best = min(outcomes, key=lambda outcome: outcome.cost)
    labels = evaluator.labels(best.vector)
    segmentation = evaluator.segmentation(labels)
    evaluation = evaluator.evaluate_labels(labels)
    warnings = [outcome.warning for outcome in outcomes[:1] if outcome.warning]
    warnings += find_warnings(evaluation, segmentation, problem.labels, best.reason)
    warnings += _disagreement(outcomes)
    history = dict(best.history)
    if restarts > 1:
        history["restarts"] = tuple(
            {"value": o.cost.value, "empty": o.cost.empty} for o in outcomes
        )
    return Result(
        shape=shape,
        problem=problem,
        labels=labels,
        evaluation=evaluation,
        centers=partition.decode(best.vector),
        history=history,
        method={
            kind: str(Choice(ready[kind].component.id, ready[kind].parameters)) for kind in _KINDS
        },
        seed=seed,
        versions=_versions(problem, ready),
        reason=best.reason,
        warnings=tuple(warnings),
    )


def _all_starts(
    evaluator: Evaluator,
    ready: Mapping[Kind, Ready],
    restarts: int,
    seed: int,
    report: Report,
    *,
    start: Centers | None,
    frozen: Sequence[int],
    deadline: float | None,
) -> list[Outcome]:
    """Run the search from one start after the other, until asked to stop."""
    stopped = False

    def listen(progress: Progress) -> bool:
        nonlocal stopped
        stopped = report(progress) or stopped
        return stopped

    outcomes: list[Outcome] = []
    for k in range(restarts):
        outcomes.append(
            search_once(
                evaluator,
                ready,
                rng=np.random.default_rng(seed if k == 0 else [seed, k]),
                report=listen,
                start=start,
                frozen=frozen,
                deadline=deadline,
            )
        )
        if stopped or outcomes[-1].reason == "seconds":
            break
    return outcomes


def _shared_budget(ready: dict[Kind, Ready], restarts: int) -> dict[Kind, Ready]:
    """The components with a limit on evaluations divided among the starts."""
    optimizer = ready["optimizer"]
    budget = optimizer.parameters.get("max_evaluations")
    if restarts == 1 or budget is None:
        return ready
    if budget < restarts:
        raise UsageError(f"{restarts} starts cannot share {budget} evaluations; allow more")
    shared = {**optimizer.parameters, "max_evaluations": budget // restarts}
    return {**ready, "optimizer": replace(optimizer, parameters=shared)}


def _start_centers(start: Centers | Result | None, problem: Problem) -> Centers | None:
    """Centres in the problem's order, or a UsageError where they do not fit it."""
    if isinstance(start, Result):
        if sorted(start.problem.labels) != sorted(problem.labels):
            raise UsageError(
                f"the start has the labels {', '.join(start.problem.labels)}; the problem has"
                f" {', '.join(problem.labels)}"
            )
        order = [start.problem.labels.index(name) for name in problem.labels]
        start = Centers(
            positions=start.centers.positions[order], weights=start.centers.weights[order]
        )
    n = len(problem.labels)
    if start is not None and (
        np.shape(start.positions) != (n, 3) or np.shape(start.weights) != (n,)
    ):
        raise UsageError(f"the start needs a centre and a weight for each of {n} labels")
    return start


def _label_index(problem: Problem, name: str) -> int:
    if name not in problem.labels:
        raise UsageError(f"freeze: {unknown('label', name, problem.labels)}")
    return problem.labels.index(name)


def _disagreement(outcomes: Sequence[Outcome]) -> list[str]:
    """A warning where several starts ended at clearly different costs."""
    values = [outcome.cost.value for outcome in outcomes]
    least, greatest = min(values), max(values)
    if greatest - least <= 0.05 * abs(least):
        return []
    return [
        f"{len(values)} starts ended at costs from {least:.4g} to {greatest:.4g}; the best is"
        f" reported, and more starts may find better"
    ]


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


def _versions(problem: Problem, ready: Mapping[Kind, Ready]) -> dict[str, str]:
    used = {term.id: term.distribution for term in problem.terms}
    used |= {r.component.id: r.component.distribution for r in ready.values()}
    return dict(sorted(used.items()))


def _silent(progress: Progress) -> bool:
    """Report nothing, and go on."""
    return False
