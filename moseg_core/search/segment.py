"""The whole method in one call: seed, label, optimise (Sec. 4 to 9), refine where asked.

How often, and on how fine a version of the shape, is the business of
:mod:`moseg_core.search.restarts`. Everything that can be wrong with the request is checked before
the work begins: components and their parameters first, then whether the shape has what the
objectives need.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy.typing as npt

from moseg_core.components.chosen import Choice, PreparedComponent
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.protocols import Centers, Report, never_stop
from moseg_core.errors import MosegError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import (
    ComponentChoice,
    Method,
    SearchOptions,
)
from moseg_core.search.alignment import Alignment
from moseg_core.search.beginning import until
from moseg_core.search.described_run import run_of
from moseg_core.search.incumbents import END, Incumbent, kept_incumbents
from moseg_core.search.last_steps import LastSteps
from moseg_core.search.pieces import on_large_pieces
from moseg_core.search.request import Request
from moseg_core.search.restarts import (
    Listener,
    Plan,
    carry_out,
    disagreement,
    on_level,
    polisher,
    shared_budget,
)
from moseg_core.search.result import Result, find_warnings
from moseg_core.search.run import RunOutcome
from moseg_core.shape.shape import Shape


def segment(
    shape: Shape,
    problem: Problem,
    *,
    seeder: ComponentChoice = None,
    labeler: ComponentChoice = None,
    optimizer: ComponentChoice = None,
    parameterization: ComponentChoice = None,
    refiner: ComponentChoice = None,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    restarts: int | str | None = None,
    finalists: int | str | None = None,
    polished: int | str | None = None,
    resolution: int | str | None = None,
    settings: str = "default",
    seed: int = 0,
    max_seconds: float | None = None,
    workers: int = 1,
    ignore_pieces_below: float | str = 0.0,
    defaults: Method | None = None,
    report: Report | None = None,
) -> Result:
    """Find the labelled segmentation of a shape that satisfies a problem best.

    Parameters
    ----------
    shape : Shape
    problem : Problem
    seeder, labeler, optimizer, parameterization : str, mapping, Choice or class, optional
        Components: ``"pattern_search(expansion=2)"``, or a class or factory that no bundle brings
        (parameters by :func:`functools.partial`). By default the paper's.
    refiner : str, mapping, Choice or class, optional
        A component that moves boundaries once the search is over: ``"graph_cut(band=0.08)"``. By
        default the recipe's, or none; ``"none"`` leaves the recipe's out. Labels and cost are then
        those of the refined labelling, centres those of the partition that the search has found.
    start : Centers, Result or Alignment, optional
        Go on from these centres, one per label in the problem's order, or as many as the
        parameterization has, instead of seeding. A result is one of this shape; that of another is
        laid onto it by :func:`moseg_core.align`.
    freeze : sequence of str
        Labels whose centre and weight stay where they start.
    pins : mapping of str to array_like of int, optional
        Elements that must bear a label: ``{"head": [120, 121]}``.
    restarts : int, optional
        Number of starts, each with random numbers of its own. They share a limit on evaluations
        and seconds; the best result is returned, the costs of all are in its history. By default
        what the settings say, and one where it would be the same every time.
    finalists : int, optional
        How many of the starts, the best after a while, go on to the end; all where there is a
        limit on evaluations. By default what the settings say.
    polished : int, optional
        How many of the results on super-elements, the best of them, are searched for a little
        longer on finer ones; 0 for none. By default what the settings say.
    resolution : int or "full", optional
        Number of super-elements on which to seed and search, where the shape has more than 1.5
        times as many elements. By default what the settings say.
    settings : str
        What decides where the rest does not: ``default``, or ``paper`` for the paper's parameters,
        one start and full resolution.
    seed : int
        Seed of the random generator; the same seed gives the same result.
    max_seconds : float, optional
        Ends the search after about this time. The result then depends on the machine.
    workers : int
        Number of processes to share the starts among, where the system can fork them; it makes no
        difference to the result.
    ignore_pieces_below : float or str
        Share of the area, from 0 to 1 or as ``"0.1%"``: loose pieces with less are left out of the
        search and of the cost, and get the label of the nearest part.
    defaults : Method, optional
        What to use where none of these options says anything: ``recipe.statement.search``.
    report : callable, optional
        Receives a :class:`moseg_core.Progress` now and then; ends the run with the best found so
        far by returning True.

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
        A component is broken, or untrue to its kind. Whatever is raised once the search is under
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
    options = SearchOptions(
        parameterization=parameterization,
        seeder=seeder,
        labeler=labeler,
        optimizer=optimizer,
        refiner=refiner,
        resolution=resolution,
        restarts=restarts,
        finalists=finalists,
        polished=polished,
        settings=settings,
        seed=seed,
        max_seconds=max_seconds,
        workers=workers,
        ignore_pieces_below=ignore_pieces_below,
    )
    more: Any = {"defaults": defaults, "start": start, "freeze": freeze, "report": report}

    def tasks() -> list[Hierarchy]:
        return [Hierarchy(problem, search=Method() if defaults is None else defaults)]

    with run_of(shape, tasks, options, start=start, freeze=freeze, pins=pins):
        return on_large_pieces(
            shape,
            options,
            lambda part, rest, its: solve(part, problem, rest, pins=its, **more),
            pins,
        )


def solve(
    shape: Shape,
    problem: Problem,
    options: SearchOptions,
    *,
    defaults: Method | None = None,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
    finished: bool = True,
) -> Result:
    """The same as :func:`segment`, with the options in one piece; no pieces are left out.

    Check the request; group the shape's elements; run the starts; partition the input's elements by
    the best vector found; and take the last steps, unless they are taken later.
    """
    began = time.monotonic()
    request = Request.of(
        shape, problem, options, defaults=defaults, start=start, freeze=freeze, pins=pins
    )
    steps = LastSteps.of(request) if finished else None
    listener = Listener(report or never_stop)
    seconds = request.settled.max_seconds
    deadline = None if seconds is None else began + seconds
    repeats = options.restarts is not None
    result = search(shape, request, listener, deadline=deadline, repeats=repeats)
    if steps is None:
        return result
    return steps.taken(result, listener, report=until(deadline, listener))


def search(
    shape: Shape,
    request: Request,
    listener: Listener,
    *,
    deadline: float | None,
    repeats: bool,
) -> Result:
    """What the starts of a run find, on input elements; the last steps are not taken.

    Parameters
    ----------
    shape : Shape
        As the user gave it.
    request : Request
    listener : Listener
    deadline : float or None
        On the clock of :func:`time.monotonic`.
    repeats : bool
        Whether somebody has said how many starts there are to be.

    Raises
    ------
    MosegError
        A component has failed. What had been found by then is the error's ``result``.
    """
    settled, whole = request.settled, request.whole
    ready = dict(request.ready)
    coarse = on_level(whole, settled.resolution, ready["parameterization"])
    if coarse is not whole and settled.settings == "default":
        ready["optimizer"] = ready["optimizer"].tuned("coarse")
    plan = Plan(
        coarse=coarse,
        whole=whole,
        resolution=settled.resolution,
        ready=shared_budget(ready, settled.restarts),
        restarts=settled.restarts,
        finalists=settled.finalists,
        polished=settled.polished,
        seed=settled.seed,
        start=request.start,
        frozen=request.frozen,
        deadline=deadline,
        repeats=repeats,
        exchanges=request.exchanges,
    )
    outcomes, best = carry_out(plan, settled.workers, listener)
    labels = whole.labels(best.vector)
    try:
        evaluation = whole.evaluate_labels(labels)
    except MosegError as error:
        raise best.failure or error from None  # once more what had ended the run
    reason = best.reason
    if listener.stopped and best.failure is None:
        reason = "interrupted"
    elif "seconds" in (reason, *(outcome.reason for outcome in outcomes)):
        reason = "seconds"
    segmentation = whole.segmentation(labels).view(shape.space)
    centers = whole.parameterization.decode(best.vector)
    last = Incumbent(stage=END, evaluations=best.evaluations, cost=evaluation.cost, centers=centers)
    result = Result(
        shape=shape,
        problem=whole.problem,
        labels=labels,
        evaluation=evaluation,
        centers=centers,
        history=_history(plan, outcomes, best),
        incumbents=kept_incumbents(best.incumbents, last, size=whole.shape.frame.scale),
        method=_method(plan, request, ready, reason, outcomes),
        seed=settled.seed,
        versions=_versions(plan, ready),
        reason=reason,
        dimension=(whole.constraints.n_free, whole.constraints.n_all),
        warnings=(
            *request.warnings,
            *[outcome.warning for outcome in outcomes[:1] if outcome.warning],
            *find_warnings(evaluation, segmentation, whole.problem.labels, reason),
            *(disagreement(outcomes) if plan.repeats else []),
        ),
    )
    if best.failure is not None:
        best.failure.result = result
        raise best.failure
    return result


def _history(
    plan: Plan, outcomes: Sequence[RunOutcome], best: RunOutcome
) -> dict[str, tuple[dict[str, float], ...]]:
    """The records of the start that won, and one of each start where there were several."""
    history = dict(best.history)
    if plan.restarts > 1 and outcomes and (len(outcomes) > 1 or plan.repeats):
        history["restarts"] = tuple(
            {"value": o.cost.value, "empty": o.cost.empty, "finalist": int(o.reason != "paused")}
            for o in outcomes
        )
    return history


def _method(
    plan: Plan,
    request: Request,
    ready: Mapping[Kind, PreparedComponent],
    reason: str,
    outcomes: Sequence[RunOutcome],
) -> dict[str, str]:
    """Components and settings as they were used."""
    settled, embedding = request.settled, plan.whole.problem.embedding
    stopped = reason in ("interrupted", "seconds", "failed")
    return {
        **{kind: str(Choice(ready[kind].component.id, ready[kind].parameters)) for kind in ready},
        **({"embedding": str(embedding)} if embedding else {}),
        "settings": settled.settings,
        "resolution": str(settled.resolution),
        "restarts": str(plan.restarts if stopped else len(outcomes)),
        "finalists": str(settled.finalists),
        "polished": str(settled.polished),
    }


def _versions(plan: Plan, ready: Mapping[Kind, PreparedComponent]) -> dict[str, str]:
    """The distribution that each component used comes from."""
    problem = plan.whole.problem
    chosen = [*ready.values()]
    if plan.coarse is not plan.whole:
        chosen.append(polisher(ready["optimizer"], problem.registry))
    used = {r.component.id: r.component.distribution for r in chosen}
    return dict(sorted((problem.versions | used).items()))
