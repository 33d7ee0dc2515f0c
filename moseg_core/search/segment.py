"""The whole method in one call: seed, label, optimise (Sec. 4 to 7).

How often, and on how fine a version of the shape, is the business of
:mod:`moseg_core.search.restarts`. Everything that can be wrong with the request is checked before
the work begins: components and their parameters first, then whether the shape has what the
objectives need.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, Ready, prepare
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.protocols import Centers, Parameterization, Progress, Report
from moseg_core.errors import MosegError, UsageError, unknown
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import ORIGINAL, Problem
from moseg_core.problem.settings import (
    Method,
    read_finalists,
    read_resolution,
    read_restarts,
    settled,
    tuned,
)
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.restarts import (
    Listener,
    Plan,
    carry_out,
    disagreement,
    rougher,
    searched_shape,
    shared_budget,
)
from moseg_core.search.result import Result, find_warnings
from moseg_core.search.workers import read_workers
from moseg_core.shape.coarse import coarse_pins
from moseg_core.shape.pins import read_pins
from moseg_core.shape.shape import Shape

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
    restarts: int | str | None = None,
    finalists: int | str | None = None,
    resolution: int | str | None = None,
    settings: str = "default",
    seed: int = 0,
    max_seconds: float | None = None,
    workers: int = 1,
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
    finalists : int, optional
        How many of the starts, the best after a while, go on to the end; all where there is a
        limit on evaluations. By default what the method or the settings say.
    resolution : int or "full", optional
        Number of super-elements on which to seed and search, where the shape has more than 1.5
        times as many elements. By default what the method or the settings say.
    settings : str
        What decides where the rest does not: ``default``, or ``paper`` for the paper's
        parameters, one start and full resolution (see :func:`moseg_core.problem.settings.settled`).
    seed : int
        Seed of the random generator; the same seed gives the same result.
    max_seconds : float, optional
        Ends the search after about this time. The result then depends on the machine.
    workers : int
        Number of processes to share the starts among, where the system can fork them; it makes no
        difference to the result.
    report : callable, optional
        Receives a :class:`moseg_core.components.protocols.Progress` now and then; ends the run with
        the best found so far by returning True.

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
        A component is broken, or broke its contract. Whatever is raised once the search is under
        way has the best found by then as its attribute ``result``.

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
    if isinstance(problem, Hierarchy):
        raise UsageError("segment takes one Problem; give a Hierarchy to segment_hierarchy")
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
        "finalists": chosen.finalists if finalists is None else finalists,
    }
    size, starts = read_resolution(extent["resolution"]), read_restarts(extent["restarts"])
    last, processes = read_finalists(extent["finalists"]), read_workers(workers)
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
    deadline = None if max_seconds is None else time.monotonic() + max_seconds
    place = problem.embed(shape)
    whole = ProblemEvaluator(place, problem, ready["parameterization"].make(place, n), pins=pinned)
    listener = Listener(report or _silent)

    level = searched_shape(place, size, pinned)
    rough = whole
    if level is not place:
        partition: Parameterization = ready["parameterization"].make(level, n)
        rough = ProblemEvaluator(
            level, problem, partition, pins=coarse_pins(pinned, level), input=whole
        )
        ready = rougher(ready, settings)
    plan = Plan(
        rough=rough,
        whole=whole,
        ready=shared_budget(ready, starts),
        restarts=starts,
        finalists=last,
        seed=seed,
        start=begin,
        frozen=frozen,
        deadline=deadline,
        repeats=restarts is not None,
    )
    outcomes, best = carry_out(plan, processes, listener)
    reason = best.reason
    if listener.stopped and best.failure is None:
        reason = "interrupted"
    elif "seconds" in (reason, *(outcome.reason for outcome in outcomes)):
        reason = "seconds"
    stopped = reason in ("interrupted", "seconds", "failed")
    labels = whole.labels(best.vector)
    segmentation = whole.segmentation(labels).view(shape.space)
    try:
        evaluation = whole.evaluate_labels(labels)
    except MosegError as error:
        raise best.failure or error from None  # once more what had ended the run
    warnings = [outcome.warning for outcome in outcomes[:1] if outcome.warning]
    warnings += find_warnings(evaluation, segmentation, problem.labels, reason)
    warnings += disagreement(outcomes) if restarts is not None else []
    history = dict(best.history)
    if starts > 1 and outcomes and (len(outcomes) > 1 or restarts is not None):
        history["restarts"] = tuple(
            {"value": o.cost.value, "empty": o.cost.empty, "finalist": int(o.reason != "paused")}
            for o in outcomes
        )
    result = Result(
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
            **({"embedding": str(problem.embedding)} if problem.embedding else {}),
            "settings": settings,
            "resolution": str(size),
            "restarts": str(starts if stopped else len(outcomes)),
            "finalists": str(last),
        },
        seed=seed,
        versions=_versions(problem, ready),
        reason=reason,
        dimension=(whole.constraints.n_free, whole.constraints.n_all),
        warnings=tuple(warnings),
    )
    if best.failure is not None:
        best.failure.result = result
        raise best.failure
    return result


def _start_centers(start: Centers | Result | None, problem: Problem) -> Centers | None:
    """Centres in the problem's order, or a UsageError where they do not fit it."""
    if isinstance(start, Result):
        if isinstance(start.problem, Hierarchy):
            raise UsageError(
                "the start is a result of several levels, whose centres belong to different"
                " partitions; start from a result of one level, such as result.levels['']"
            )
        bent = start.problem.embedding
        start = matched_centers(start.problem.labels, start.centers, problem, embedding=bent)
    n = len(problem.labels)
    if start is not None and (
        np.shape(start.positions) != (n, 3) or np.shape(start.weights) != (n,)
    ):
        raise UsageError(f"the start needs a centre and a weight for each of {n} labels")
    return start


def matched_centers(
    names: Sequence[str],
    centers: Centers,
    problem: Problem,
    *,
    embedding: str | Choice | None = None,
) -> Centers:
    """The centres of an earlier result in the order of a problem's labels.

    Parameters
    ----------
    names : sequence of str
        The labels of the earlier result.
    centers : Centers
    problem : Problem
    embedding : str, Choice or None
        That of the earlier result.

    Raises
    ------
    UsageError
        The two do not have the same labels, or their partitions are in different spaces.
    """
    there, here = (
        ORIGINAL if choice is None else Choice.read(choice, "embedding").name.rpartition(":")[2]
        for choice in (embedding, problem.embedding)
    )
    if there != here:
        raise UsageError(
            f"the start has its centres in the space '{there}', and the partition is to be found in"
            f" '{here}'; go on in the same space (--embedding"
            f" {'none' if embedding is None else embedding}), or begin without a start"
        )
    if sorted(names) != sorted(problem.labels):
        raise UsageError(
            f"the start has the labels {', '.join(names)}; the problem has"
            f" {', '.join(problem.labels)}"
        )
    order = [list(names).index(name) for name in problem.labels]
    return Centers(positions=centers.positions[order], weights=centers.weights[order])


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
        See :func:`moseg_core.components.chosen.prepare`.
    """
    ready = {}
    for kind in _KINDS:
        chosen = (given or {}).get(kind)
        choice = getattr(method, kind) if chosen is None else Choice.read(chosen, kind)
        ready[kind] = prepare(choice, kind, problem.registry)
    return ready


def _versions(problem: Problem, ready: Mapping[Kind, Ready]) -> dict[str, str]:
    used = {term.id: term.distribution for term in problem.terms}
    used |= {rule.id: rule.distribution for rule in problem.rules}
    chosen = [*ready.values(), *([problem.bending] if problem.bending else [])]
    used |= {r.component.id: r.component.distribution for r in chosen}
    return dict(sorted(used.items()))


def _silent(progress: Progress) -> bool:
    """Report nothing, and go on."""
    return False
