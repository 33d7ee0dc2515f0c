"""The whole method in one call: seed, label, optimise (Sec. 4 to 7).

A shape of many elements is searched on a coarse version of it (:mod:`moseg_core.coarse`). What
was found there is then partitioned element by element and polished: a short pattern search with
small steps. The cost in the result is always that of the input elements.

Everything that can be wrong with the request is checked before the work begins: components and
their parameters first, then whether the shape has what the objectives need.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.coarse import coarse_pins, coarsen
from moseg_core.errors import UsageError, unknown
from moseg_core.evaluation import Evaluator
from moseg_core.method import (
    Choice,
    Method,
    Ready,
    prepare,
    read_resolution,
    read_restarts,
    settled,
    tuned,
)
from moseg_core.pins import Pins, read_pins
from moseg_core.problem import Problem
from moseg_core.protocols import Centers, Parameterization, Progress, Report
from moseg_core.result import Result, find_warnings
from moseg_core.search import Outcome, polish, search_once
from moseg_core.shape import Shape
from moseg_core.specs import Kind

_KINDS: tuple[Kind, ...] = ("parameterization", "seeder", "labeler", "optimizer")

#: A coarse shape is used where it has fewer elements by this factor.
_WORTH = 1.5
#: Where a pattern search on a coarse shape ends by default, in diagonals.
_ROUGH = 1e-3
#: How many of the coarse results are polished, and how.
_POLISHED = 2
_POLISH = Choice(
    "core:pattern_search", {"pattern_size": 0.01, "threshold": 1e-4, "max_evaluations": 300}
)


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
    restarts: int | str | None = None,
    resolution: int | str | None = None,
    settings: str = "default",
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
    restarts : int, optional
        Number of starts, each with random numbers of its own. They share a limit on evaluations
        and seconds; the best result is returned, the costs of all are in its history. By default
        what the method or the settings say, and one where it would be the same every time.
    resolution : int or "full", optional
        Number of super-elements on which to seed and search, where the shape has more than 1.5
        times as many elements. By default what the method or the settings say.
    settings : str
        What decides where the rest does not: ``default``, or ``paper`` for the paper's
        parameters, one start and full resolution (see :func:`moseg_core.method.settled`).
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
    if not isinstance(shape, Shape):
        raise UsageError(f"segment takes a Shape, from moseg.load(path), not {shape!r:.60}")
    if not isinstance(problem, Problem):
        raise UsageError(f"segment takes a Problem, not {problem!r:.60}")
    given: dict[str, str | Mapping[str, Any] | Choice | None] = {
        "parameterization": parameterization,
        "seeder": seeder,
        "labeler": labeler,
        "optimizer": optimizer,
    }
    chosen = settled(method or Method(), settings)
    extent = {
        "resolution": chosen.resolution if resolution is None else resolution,
        "restarts": chosen.restarts if restarts is None else restarts,
    }
    size, starts = read_resolution(extent["resolution"]), read_restarts(extent["restarts"])
    given["seeder"] = tuned(
        chosen.seeder if seeder is None else Choice.read(seeder, "seeder"), settings
    )
    ready = prepare_method(problem, chosen, given)
    limited = ready["optimizer"].parameters.get("max_evaluations") is not None
    if restarts is None and limited and (method is None or method.restarts is None):
        starts = 1
    check_limits(seed, max_seconds)
    if size != "full" and int(size) < len(problem.labels):
        raise UsageError(f"a resolution of {size} is too low for {len(problem.labels)} labels")
    frozen = check_frozen(problem, freeze)
    begin = _start_centers(start, problem)
    pinned = read_pins(pins or {}, problem.labels, shape.n_elements)
    n = len(problem.labels)
    whole = Evaluator(shape, problem, ready["parameterization"].make(shape, n), pins=pinned)
    listener = _Listener(report or _silent)
    deadline = None if max_seconds is None else time.monotonic() + max_seconds

    level = _searched(shape, size, pinned)
    rough = whole
    if level is not shape:
        partition: Parameterization = ready["parameterization"].make(level, n)
        rough = Evaluator(level, problem, partition, pins=coarse_pins(pinned, level), input=whole)
    outcomes = _all_starts(
        rough,
        _shared_budget(ready if rough is whole else _rougher(ready, settings), starts),
        starts,
        seed,
        listener,
        start=begin,
        frozen=frozen,
        deadline=deadline,
        repeats=restarts is not None,
    )
    best = min(outcomes, key=lambda outcome: outcome.cost)
    if rough is not whole:
        best = _finish(rough, whole, outcomes, listener, frozen=frozen, deadline=deadline)
    reason = best.reason
    if listener.stopped:
        reason = "interrupted"
    elif "seconds" in (reason, outcomes[-1].reason):
        reason = "seconds"
    labels = whole.labels(best.vector)
    segmentation = whole.segmentation(labels)
    evaluation = whole.evaluate_labels(labels)
    warnings = [outcome.warning for outcome in outcomes[:1] if outcome.warning]
    warnings += find_warnings(evaluation, segmentation, problem.labels, reason)
    warnings += _disagreement(outcomes) if restarts is not None else []
    history = dict(best.history)
    if starts > 1 and (len(outcomes) > 1 or restarts is not None):
        history["restarts"] = tuple(
            {"value": o.cost.value, "empty": o.cost.empty} for o in outcomes
        )
    return Result(
        shape=shape,
        problem=problem,
        labels=labels,
        evaluation=evaluation,
        centers=whole.parameterization.decode(best.vector),
        history=history,
        method={
            **{
                kind: str(Choice(ready[kind].component.id, ready[kind].parameters))
                for kind in _KINDS
            },
            "settings": settings,
            "resolution": str(size),
            "restarts": str(starts),
        },
        seed=seed,
        versions=_versions(problem, ready),
        reason=reason,
        warnings=tuple(warnings),
    )


class _Listener:
    """Passes reports on, and remembers that it was once asked to stop."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self.stopped = False

    def __call__(self, progress: Progress) -> bool:
        self.stopped = bool(self._report(progress)) or self.stopped
        return self.stopped


def _searched(shape: Shape, resolution: int | str, pins: Pins) -> Shape:
    """The shape to search on: a coarse one where that is clearly smaller."""
    if resolution == "full" or shape.n_elements <= _WORTH * int(resolution):
        return shape
    coarse = coarsen(shape, int(resolution), pins=pins)
    return coarse if shape.n_elements > _WORTH * coarse.n_elements else shape


def _rougher(ready: dict[Kind, Ready], settings: str) -> dict[Kind, Ready]:
    """The components with the default search ending at steps that super-elements can feel."""
    optimizer = ready["optimizer"]
    plain = optimizer.component.id == "core:pattern_search" and not optimizer.parameters
    if settings != "default" or not plain:
        return ready
    return {**ready, "optimizer": replace(optimizer, parameters={"threshold": _ROUGH})}


def _all_starts(
    evaluator: Evaluator,
    ready: Mapping[Kind, Ready],
    restarts: int,
    seed: int,
    listener: _Listener,
    *,
    start: Centers | None,
    frozen: Sequence[int],
    deadline: float | None,
    repeats: bool,
) -> list[Outcome]:
    """Run the search from one start after the other, until asked to stop.

    A run that draws no random numbers is the same each time; it is repeated only on request.
    """
    outcomes: list[Outcome] = []
    for k in range(restarts):
        rng = np.random.default_rng(seed if k == 0 else [seed, k])
        fresh = rng.bit_generator.state
        outcomes.append(
            search_once(
                evaluator,
                ready,
                rng=rng,
                report=listener,
                start=start,
                frozen=frozen,
                deadline=deadline,
            )
        )
        if listener.stopped or outcomes[-1].reason == "seconds":
            break
        if not repeats and rng.bit_generator.state == fresh:
            break
    return outcomes


def _finish(
    rough: Evaluator,
    whole: Evaluator,
    outcomes: Sequence[Outcome],
    listener: _Listener,
    *,
    frozen: Sequence[int],
    deadline: float | None,
) -> Outcome:
    """The best of what was found on the coarse shape, by its cost on the whole one.

    All distinct outcomes are partitioned anew. The best on super-elements and the best by what they
    cost now are polished, and the least exact cost wins: one with an empty part comes after all
    without.
    """
    ready = prepare(_POLISH, "optimizer", whole.problem.registry)
    found: dict[bytes, Outcome] = {}
    for outcome in sorted(outcomes, key=lambda outcome: outcome.cost):
        key = rough.labels(outcome.vector).tobytes()
        if key not in found:
            vector = whole.parameterization.encode(rough.parameterization.decode(outcome.vector))
            cost = whole.evaluate(vector).cost
            found[key] = replace(outcome, vector=vector, cost=cost)
    ranked = sorted(found.values(), key=lambda outcome: outcome.cost)
    # The best on super-elements first: a part that it loses between levels a few steps may mend.
    favourite = next(iter(found.values()))
    ranked = [favourite, *(outcome for outcome in ranked if outcome is not favourite)]
    polished: list[Outcome] = []
    for outcome in ranked:
        over = deadline is not None and time.monotonic() >= deadline
        if len(polished) == _POLISHED or listener.stopped or over:
            break
        better = polish(
            whole,
            ready,
            outcome.vector,
            rng=np.random.default_rng(0),
            report=listener,
            frozen=frozen,
            deadline=deadline,
        )
        reason = "seconds" if better.reason == "seconds" else outcome.reason
        history = {**outcome.history, **better.history}
        polished.append(replace(better, reason=reason, history=history, warning=outcome.warning))
    return min([*polished, *ranked], key=lambda outcome: outcome.cost)


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


def check_limits(seed: int, max_seconds: float | None) -> None:
    """Refuse a seed or a time limit that makes no sense.

    Raises
    ------
    UsageError
        The seed is negative or not whole, or the limit is not a positive number.
    """
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)):
        raise UsageError(f"the seed must be a whole number, not {seed!r}")
    if seed < 0:
        raise UsageError(f"the seed must not be negative, and is {seed}")
    if max_seconds is not None and not 0 <= max_seconds < math.inf:
        raise UsageError(f"the limit on seconds must not be negative, and is {max_seconds}")


def check_frozen(problem: Problem, freeze: Sequence[str]) -> list[int]:
    """Indices of the labels to freeze.

    Raises
    ------
    UsageError
        An unknown label, or a text instead of a list.
    """
    if isinstance(freeze, str):
        raise UsageError(f"freeze must be a list of labels, not the text '{freeze}'")
    for name in freeze:
        if name not in problem.labels:
            raise UsageError(f"freeze: {unknown('label', name, problem.labels)}")
    return [problem.labels.index(name) for name in freeze]


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
