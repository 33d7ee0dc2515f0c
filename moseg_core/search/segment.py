"""The whole method in one call: seed, label, optimise (Sec. 4 to 9), refine where asked.

How often, and on how fine a version of the shape, is the business of
:mod:`moseg_core.search.restarts`. Everything that can be wrong with the request is checked before
the work begins: components and their parameters first, then whether the shape has what the
objectives need.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.components.chosen import Choice, PreparedComponent, prepare
from moseg_core.components.discovery.specs import Kind
from moseg_core.components.protocols import Centers, Report, never_stop
from moseg_core.errors import MosegError, UsageError, unknown
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import ORIGINAL, Problem
from moseg_core.problem.settings import (
    CHOSEN_KINDS,
    ComponentChoice,
    Method,
    SearchOptions,
    SettledOptions,
    check_method,
)
from moseg_core.search.alignment import Alignment
from moseg_core.search.beginning import until
from moseg_core.search.checked_partition import make_partition
from moseg_core.search.described_run import run_of
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.exchange import best_order
from moseg_core.search.incumbents import END, Incumbent, kept_incumbents
from moseg_core.search.pieces import on_large_pieces
from moseg_core.search.refinement import ReadyRefiner, Refinement
from moseg_core.search.restarts import (
    FINER,
    Listener,
    Plan,
    carry_out,
    disagreement,
    on_level,
    polisher,
    shared_budget,
)
from moseg_core.search.result import REFINE, Result, find_warnings
from moseg_core.search.run import RunOutcome
from moseg_core.shape.pins import read_pins
from moseg_core.shape.shape import Shape
from moseg_core.types import IntArray


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
) -> Result:
    """The same as :func:`segment`, with the options in one piece; no pieces are left out.

    Check the request; embed the shape (Sec. 9), group its elements, and make an evaluator for
    each of the two; run the starts; partition the input's elements by the best vector found, and
    refine the boundaries where that is asked for.
    """
    if isinstance(problem, Hierarchy):
        raise UsageError("segment takes one Problem; give a Hierarchy to segment_hierarchy")
    if not isinstance(problem, Problem):
        raise UsageError(
            f"segment takes a Problem, not {problem!r:.60}; give a recipe to segment_variants"
        )
    if defaults is not None:
        check_method(defaults, "defaults")
    settled = options.settled(defaults)
    ready = prepare_components(problem, settled)
    refiner = ReadyRefiner.of(ready["refiner"]) if "refiner" in ready else None
    n = len(problem.labels)
    settled.check_resolution(n)
    frozen = check_frozen(problem, freeze)
    start_centers = _start_centers(start, problem)
    pinned = read_pins(pins or {}, problem.labels, shape.n_elements)
    seconds = settled.max_seconds
    deadline = None if seconds is None else time.monotonic() + seconds
    embedded = problem.embed(shape)
    partition = make_partition(ready["parameterization"], embedded, problem)
    whole = ProblemEvaluator(embedded, problem, partition, pins=pinned)
    if start_centers is not None:
        _check_counts(start_centers, partition.centers_per_part, problem.labels)
    lacking = "" if refiner is None else refiner.check(whole)
    listener = Listener(report or never_stop)

    coarse = fine = on_level(whole, settled.resolution, ready["parameterization"])
    if coarse is not whole:
        fine = on_level(whole, FINER * int(settled.resolution), ready["parameterization"])
        if settled.settings == "default":
            ready["optimizer"] = ready["optimizer"].tuned("coarse")
    plan = Plan(
        coarse=coarse,
        fine=fine,
        whole=whole,
        ready=shared_budget(ready, settled.restarts),
        restarts=settled.restarts,
        finalists=settled.finalists,
        polished=settled.polished,
        seed=settled.seed,
        start=start_centers,
        frozen=frozen,
        deadline=deadline,
        repeats=options.restarts is not None,
        exchanges=settled.settings != "paper",
    )
    outcomes, best = carry_out(plan, settled.workers, listener)
    found = _labelled(whole, best)
    if refiner is not None and best.failure is None:
        found = refiner.refine(
            whole,
            found,
            report=until(deadline, listener),
            interrupted=listener.stopped,
            warning=lacking,
        )
    if best.failure is None and found.failure is None and not listener.stopped:
        best, found = _exchanged(plan, best, found)
    result = _result(
        shape, plan, settled, ready, outcomes, best, found, interrupted=listener.stopped
    )
    if isinstance(start, Alignment) and start.warnings:
        result = replace(result, warnings=(*start.warnings, *result.warnings))
    failure = best.failure or found.failure
    if failure is not None:
        failure.result = result
        raise failure
    return result


def _labelled(whole: ProblemEvaluator, best: RunOutcome) -> Refinement:
    """The labels of the best vector and their cost, as the search leaves them."""
    labels = whole.labels(best.vector)
    try:
        return Refinement(labels=labels, evaluation=whole.evaluate_labels(labels))
    except MosegError as error:
        raise best.failure or error from None  # once more what had ended the run


def _exchanged(plan: Plan, best: RunOutcome, found: Refinement) -> tuple[RunOutcome, Refinement]:
    """Vector and labels after the last exchange of labels; what a refiner moved may call for it.

    Where an exchange is about labels of different numbers of centres, no vector is sure to have its
    partition, and the centres are only near.
    """
    whole, names = plan.whole, plan.whole.problem.labels
    try:
        order = best_order(whole, best.vector, found.labels, frozen=plan.frozen)
        if (order == np.arange(len(order))).all():
            return best, found
        labels = np.argsort(order).astype(np.int32)[found.labels]
        evaluation = whole.evaluate_labels(labels)
    except MosegError as error:
        return best, replace(found, failure=error)
    if not plan.exchanges:
        moved = [f"'{names[k]}'" for k in np.flatnonzero(order != np.arange(len(order)))]
        said = (
            f"exchanging the labels {', '.join(moved[:-1])} and {moved[-1]} would lower the cost"
            f" from {found.evaluation.cost.value:.4g} to {evaluation.cost.value:.4g}; --settings"
            " default does so"
        )
        return best, replace(found, warning="; ".join(filter(None, [found.warning, said])))
    vector = whole.parameterization.permute(best.vector, order)
    return replace(best, vector=vector), replace(found, labels=labels, evaluation=evaluation)


def _result(
    shape: Shape,
    plan: Plan,
    settled: SettledOptions,
    ready: Mapping[Kind, PreparedComponent],
    outcomes: Sequence[RunOutcome],
    best: RunOutcome,
    found: Refinement,
    *,
    interrupted: bool,
) -> Result:
    """The best of what was found, with all that there is to tell of how it was."""
    whole = plan.whole
    problem = whole.problem
    reason = best.reason
    if found.failure is not None:
        reason = "failed"
    elif interrupted and best.failure is None:
        reason = "interrupted"
    elif "seconds" in (reason, *(outcome.reason for outcome in outcomes)):
        reason = "seconds"
    stopped = reason in ("interrupted", "seconds", "failed")
    segmentation = whole.segmentation(found.labels).view(shape.space)
    warnings = [outcome.warning for outcome in outcomes[:1] if outcome.warning]
    warnings += find_warnings(found.evaluation, segmentation, problem.labels, reason)
    warnings += disagreement(outcomes) if plan.repeats else []
    warnings += [found.warning] if found.warning else []
    history = dict(best.history)
    if found.history:
        history[REFINE] = found.history
    if plan.restarts > 1 and outcomes and (len(outcomes) > 1 or plan.repeats):
        history["restarts"] = tuple(
            {"value": o.cost.value, "empty": o.cost.empty, "finalist": int(o.reason != "paused")}
            for o in outcomes
        )
    centers = whole.parameterization.decode(best.vector)
    last = Incumbent(
        stage=END,
        evaluations=best.evaluations,
        cost=found.evaluation.cost,
        centers=centers,
    )
    chosen: dict[str, str] = {
        kind: str(Choice(ready[kind].component.id, ready[kind].parameters)) for kind in ready
    }
    return Result(
        shape=shape,
        problem=problem,
        labels=found.labels,
        evaluation=found.evaluation,
        centers=centers,
        history=history,
        incumbents=kept_incumbents(best.incumbents, last, size=whole.shape.frame.scale),
        method={
            **chosen,
            **({"embedding": str(problem.embedding)} if problem.embedding else {}),
            "settings": settled.settings,
            "resolution": str(settled.resolution),
            "restarts": str(plan.restarts if stopped else len(outcomes)),
            "finalists": str(settled.finalists),
            "polished": str(settled.polished),
        },
        seed=settled.seed,
        versions=_versions(plan, ready),
        reason=reason,
        dimension=(whole.constraints.n_free, whole.constraints.n_all),
        warnings=tuple(warnings),
    )


def _start_centers(start: Centers | Result | Alignment | None, problem: Problem) -> Centers | None:
    """Centres in the problem's order, or a UsageError where they do not fit it."""
    if isinstance(start, Alignment):
        start = matched_centers(start.labels, start.centers, problem, embedding=start.embedding)
    if isinstance(start, Result):
        if isinstance(start.problem, Hierarchy):
            raise UsageError(
                "the start is a result of several levels, whose centres belong to different"
                " partitions; start from a result of one level, such as result.levels['']"
            )
        embedding = start.problem.embedding
        start = matched_centers(start.problem.labels, start.centers, problem, embedding=embedding)
    n = len(problem.labels)
    if start is not None and not isinstance(start, Centers):
        raise UsageError(f"the start must be Centers, a Result or an Alignment, not {start!r:.60}")
    if start is None:
        return None
    parts = np.arange(n) if start.parts is None else np.asarray(start.parts)
    count = len(parts) if parts.ndim == 1 else 0
    if np.shape(start.positions) != (count, 3) or np.shape(start.weights) != (count,):
        raise UsageError(f"the start needs a centre and a weight for each of {n} labels")
    if parts.dtype.kind not in "iu" or np.unique(parts).tolist() != [*range(n)]:
        raise UsageError(f"the start must say for each centre which of {n} labels it belongs to")
    order = np.argsort(parts, kind="stable")
    return Centers(
        positions=np.asarray(start.positions)[order],
        weights=np.asarray(start.weights)[order],
        parts=None if count == n else parts[order].astype(np.int64),
    )


def _check_counts(start: Centers, allowed: IntArray, labels: Sequence[str]) -> None:
    """Refuse a start that has another number of centres for a label than the parameterization.

    One for each label is a start for all.
    """
    given = start.per_part
    if (given == 1).all() or (given == allowed).all():
        return
    k = int(np.flatnonzero(given != allowed)[0])
    raise UsageError(
        f"the start has {given[k]} centres for label '{labels[k]}', and the parameterization"
        f" {allowed[k]}; give as many, such as --parameterization"
        f""" 'voronoi(centers="{_counted(given, labels)}")', or begin without a start"""
    )


def _counted(counts: IntArray, labels: Sequence[str]) -> str:
    """How many centres labels have, where it is not one."""
    return ",".join(f"{name}={c}" for name, c in zip(labels, counts, strict=True) if c > 1)


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
    return centers.ordered(np.array([list(names).index(name) for name in problem.labels]))


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


def prepare_components(problem: Problem, options: SettledOptions) -> dict[Kind, PreparedComponent]:
    """Find, load and check the components of a run, tuned to the settings.

    There is a refiner among them only where one was asked for.

    Parameters
    ----------
    problem : Problem
        Says where to look.
    options : SettledOptions

    Raises
    ------
    UsageError, PluginError
        See :func:`moseg_core.components.chosen.prepare`.
    """
    chosen = {kind: getattr(options, kind) for kind in CHOSEN_KINDS}
    found = {
        kind: prepare(choice, kind, problem.registry)
        for kind, choice in chosen.items()
        if choice is not None
    }
    if options.settings != "default":
        return found
    return {kind: component.tuned("default") for kind, component in found.items()}


def _versions(plan: Plan, ready: Mapping[Kind, PreparedComponent]) -> dict[str, str]:
    """The distribution that each component used comes from."""
    problem = plan.whole.problem
    chosen = [*ready.values()]
    if plan.coarse is not plan.whole:
        chosen.append(polisher(ready["optimizer"], problem.registry))
    used = {r.component.id: r.component.distribution for r in chosen}
    return dict(sorted((problem.versions | used).items()))
