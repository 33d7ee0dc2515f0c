"""Several starts, on a coarse shape first: how the searches of one run are put together.

A shape of many elements is searched on a coarse version of it (:mod:`moseg_core.coarse`), from one
start after the other; :mod:`moseg_core.search` does a single one. What was found is then
partitioned element by element, ranked by what it costs now, and the first few are polished: a
short pattern search with small steps. The cost that is reported is always that of the input
elements.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from moseg_core.coarse import coarsen
from moseg_core.errors import UsageError
from moseg_core.evaluation import Evaluator
from moseg_core.method import Choice, Ready, prepare
from moseg_core.pins import Pins
from moseg_core.protocols import Centers, Progress, Report
from moseg_core.search import Outcome, polish, search_once
from moseg_core.shape import Shape
from moseg_core.specs import Kind

#: A coarse shape is used where it has fewer elements by this factor.
_WORTH = 1.5
#: Where a pattern search on a coarse shape ends by default, in diagonals.
_ROUGH = 1e-3
#: How many of the coarse results are polished, and how.
_POLISHED = 2
_POLISH = Choice(
    "core:pattern_search", {"pattern_size": 0.01, "threshold": 1e-4, "max_evaluations": 300}
)


class Listener:
    """Passes reports on, and remembers that it was once asked to stop."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self.stopped = False

    def __call__(self, progress: Progress) -> bool:
        """Pass a report on; whether anybody has asked to stop so far."""
        self.stopped = bool(self._report(progress)) or self.stopped
        return self.stopped


def searched_shape(shape: Shape, resolution: int | str, pins: Pins) -> Shape:
    """The shape to search on: a coarse one where that is clearly smaller."""
    if resolution == "full" or shape.n_elements <= _WORTH * int(resolution):
        return shape
    coarse = coarsen(shape, int(resolution), pins=pins)
    return coarse if shape.n_elements > _WORTH * coarse.n_elements else shape


def rougher(ready: dict[Kind, Ready], settings: str) -> dict[Kind, Ready]:
    """The components with the default search ending at steps that super-elements can feel."""
    optimizer = ready["optimizer"]
    plain = optimizer.component.id == "core:pattern_search" and not optimizer.parameters
    if settings != "default" or not plain:
        return ready
    return {**ready, "optimizer": replace(optimizer, parameters={"threshold": _ROUGH})}


def all_starts(
    evaluator: Evaluator,
    ready: Mapping[Kind, Ready],
    restarts: int,
    seed: int,
    listener: Listener,
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


def finish(
    rough: Evaluator,
    whole: Evaluator,
    outcomes: Sequence[Outcome],
    listener: Listener,
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


def shared_budget(ready: dict[Kind, Ready], restarts: int) -> dict[Kind, Ready]:
    """The components with a limit on evaluations divided among the starts."""
    optimizer = ready["optimizer"]
    budget = optimizer.parameters.get("max_evaluations")
    if restarts == 1 or budget is None:
        return ready
    if budget < restarts:
        raise UsageError(f"{restarts} starts cannot share {budget} evaluations; allow more")
    shared = {**optimizer.parameters, "max_evaluations": budget // restarts}
    return {**ready, "optimizer": replace(optimizer, parameters=shared)}


def disagreement(outcomes: Sequence[Outcome]) -> list[str]:
    """A warning where several starts ended at clearly different costs."""
    values = [outcome.cost.value for outcome in outcomes]
    least, greatest = min(values), max(values)
    if greatest - least <= 0.05 * abs(least):
        return []
    return [
        f"{len(values)} starts ended at costs from {least:.4g} to {greatest:.4g}; the best is"
        f" reported, and more starts may find better"
    ]
