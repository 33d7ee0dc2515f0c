"""Members that differ: every label set is searched for, and one is chosen.

A recipe whose labels have counts (``leg{2..5}``, :mod:`moseg_core.problem.label_sets`) does not say
which labels a shape has. :func:`segment_variants` solves the problem of each label set
(:class:`moseg_core.problem.variants.Variants`) and takes the one whose parts are most like what the
recipe says of parts: the mean of the parts' costs, weighted by the root of their areas, and what
all else costs for each part (:mod:`moseg_core.search.typical_cost`). Of two results the one with
fewer empty parts is better whatever they cost, since an empty part means that the label set has too
many labels.

The label sets share what one search would have: the starts that nobody gave a number for, the
seconds, the processes, which take label sets side by side; and the shape with its coarse version,
fields and neighbours, which are computed once. The better half goes on where there are many, or
where seeds say enough (:mod:`moseg_core.search.label_set_trial`). Label sets compete on the first
level, by what their searches have found; boundaries are refined of the winner
(:mod:`moseg_core.search.last_steps`), and its parts are then divided, where they are.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

import numpy.typing as npt

from moseg_core.components.protocols import Centers, Report, never_stop
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import OptionValues, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.alignment import Alignment
from moseg_core.search.alternatives import chosen_among
from moseg_core.search.beginning import until
from moseg_core.search.described_run import run_of
from moseg_core.search.label_set_options import for_task
from moseg_core.search.label_set_trial import Trial
from moseg_core.search.last_steps import LastSteps
from moseg_core.search.levels import check_hierarchy, divided, solve_hierarchy
from moseg_core.search.pieces import on_large_pieces
from moseg_core.search.request import Request
from moseg_core.search.restarts import Listener
from moseg_core.search.result import Result
from moseg_core.shape.shape import Shape

TRIED = "labels "
"""What the stages of the history begin with that have the record of a label set that was tried."""


def segment_variants(
    shape: Shape,
    recipe: str | Recipe | Statement,
    *,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
    **options: Unpack[OptionValues],
) -> Result:
    """Segment a shape by a recipe whose labels have counts, and find out which labels it has.

    Parameters
    ----------
    shape : Shape
    recipe : str, Recipe or Statement
        A recipe's name or path, a recipe, or a statement. Where no label has a count it is
        segmented as by :func:`moseg_core.segment_hierarchy`.
    start, freeze, pins
        As for :func:`moseg_core.segment`, about the first level only. Only label sets that have
        the labels which they name are tried; of a start all labels.
    report : callable, optional
        As for :func:`moseg_core.segment`; the label set stands in front of the stage.
    **options
        The fields of :class:`moseg_core.SearchOptions`. The seconds are shared among the label
        sets, and so are the starts, where neither these options nor the recipe say how many.

    Returns
    -------
    Result
        Of the label set whose parts fit best (:func:`typical_cost`). Its history has a record for
        each that was tried, under "labels torso, leg{4}": number of parts, cost, typical cost, and
        how many parts are empty, before boundaries were refined.

    Raises
    ------
    UsageError
        No term speaks of single parts, so that label sets can't be compared; else as for
        :func:`moseg_core.segment`.
    ShapeError, PluginError
        As for :func:`moseg_core.segment`, with the best that was found as the error's ``result``.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> stated = moseg.Statement(
    ...     labels=("handle", "head{1..3}"),
    ...     minimize="is(handle, area=0.6+-0.1) + is(head*, area=0.4+-0.1)",
    ... )
    >>> result = moseg.segment_variants(hammer, stated, seeder="kmeans", restarts=1)
    >>> list(result.parts)
    ['handle', 'head1']
    """
    if isinstance(recipe, str):
        recipe = load_recipe(recipe)
    statement = recipe.statement if isinstance(recipe, Recipe) else recipe
    if not isinstance(statement, Statement):
        raise UsageError(f"segment_variants takes a Recipe or a Statement, not {recipe!r:.60}")
    variants = Variants.of(statement)
    named = {*freeze, *(pins or {})}
    variants = variants.having(named, "freeze and pins") if named else variants
    if isinstance(start, Result | Alignment):
        names = start.labels if isinstance(start, Alignment) else start.problem.labels
        variants = variants.having(names, "start", exactly=True)
    return solve_variants(
        shape,
        variants,
        SearchOptions.of(options),
        start=start,
        freeze=freeze,
        pins=pins,
        report=report,
    )


def solve_variants(
    shape: Shape,
    variants: Variants,
    options: SearchOptions,
    *,
    start: Centers | Result | Alignment | None = None,
    freeze: Sequence[str] = (),
    pins: Mapping[str, npt.ArrayLike] | None = None,
    report: Report | None = None,
) -> Result:
    """The same as :func:`segment_variants`, with names looked up and options in one piece."""
    steered: Any = {"start": start, "freeze": freeze}
    asked = variants.statement.document()
    with run_of(shape, lambda: variants.tasks, options, asked=asked, pins=pins, **steered):
        return on_large_pieces(
            shape,
            options,
            lambda part, own, its: _solved(part, variants, own, pins=its, report=report, **steered),
            pins,
        )


def _solved(
    shape: Shape,
    variants: Variants,
    options: SearchOptions,
    *,
    start: Centers | Result | Alignment | None,
    freeze: Sequence[str],
    pins: Mapping[str, npt.ArrayLike] | None,
    report: Report | None,
) -> Result:
    """See :func:`solve_variants`."""
    more: dict[str, Any] = {"start": start, "freeze": freeze, "pins": pins}
    if len(variants.tasks) == 1:
        task = variants.tasks[0]
        options = for_task(options, task, variants)
        return solve_hierarchy(shape, task, options, report=report, **more)
    check_variants(variants, options)
    # More labels than elements: the smaller label sets can still be tried.
    able = [t for t in variants.tasks if len(t.problem.labels) <= shape.n_elements]
    variants = replace(variants, tasks=tuple(able) or variants.tasks[:1])
    listener = Listener(report or never_stop)
    began = time.monotonic()
    trial = Trial.of(shape, variants, options, more)
    steps = [_last_steps(shape, task, variants, options, more) for task in variants.tasks]
    trial.run(listener)
    if not trial.found:
        assert trial.failure is not None  # the first label set is always tried
        raise trial.failure
    best = trial.best()
    chosen = chosen_among(
        trial.found[best],
        [trial.found[k] for k in (trial.finalists or trial.found)],
        failed=trial.failure is not None,
        tried={TRIED + variants.texts[k]: (trial.record(k),) for k in sorted(trial.found)},
    )
    if trial.failure is not None:
        trial.failure.result = chosen
        raise trial.failure
    chosen = steps[best].taken(chosen, listener, report=until(trial.deadline, listener))
    best_task = variants.tasks[best]
    if not best_task.children:
        return chosen
    if options.max_seconds is not None:
        left = max(0.0, options.max_seconds - (time.monotonic() - began))
        options = replace(options, max_seconds=left)
    return divided(chosen, best_task, options, listener)


def _last_steps(
    shape: Shape,
    task: Hierarchy,
    variants: Variants,
    options: SearchOptions,
    more: Mapping[str, Any],
) -> LastSteps:
    """What is done with the result for a label set, if it is taken; checked before the search."""
    mine = for_task(options, task, variants)
    return LastSteps.of(Request.of(shape, task.problem, mine, defaults=task.search, **more))


def check_variants(variants: Variants, options: SearchOptions) -> None:
    """Check for every label set what can be checked before a shape is there.

    Raises
    ------
    UsageError, PluginError
        As for :func:`moseg_core.check_hierarchy`; no term speaks of single parts.
    """
    for task in variants.tasks:
        check_hierarchy(task, for_task(options, task, variants))
    if len(variants.tasks) > 1 and not any(task.problem.unary_terms for task in variants.tasks):
        raise UsageError(
            f"'{variants.statement.minimize}' says nothing of single parts, by which label sets are"
            f" compared; add a term such as is(label, area=0.2+-0.1), or name the labels, such as"
            f' --labels "{variants.texts[-1]}"'
        )


def tried_sets(history: Mapping[str, Sequence[dict[str, float]]]) -> dict[str, dict[str, float]]:
    """The record of each label set that was tried, by its text; of other results none.

    Examples
    --------
    >>> tried_sets({"labels a, b": ({"parts": 2, "typical cost": 0.5},), "restarts": ()})
    {'a, b': {'parts': 2, 'typical cost': 0.5}}
    """
    return {
        stage.removeprefix(TRIED): records[0]
        for stage, records in history.items()
        if stage.startswith(TRIED)
    }
