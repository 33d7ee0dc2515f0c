"""Optimizers that are broken in one way each."""

from __future__ import annotations

import math

import numpy as np

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.specs import OptimizerSpec
from moseg_core.errors import UsageError

_NAMES = {
    "optimizer-start": "StartsElsewhere",
    "optimizer-ask": "AsksForNothing",
    "optimizer-tell": "TakesWhatComes",
    "optimizer-in-bounds": "LeavesTheBounds",
    "optimizer-budget": "WholePolls",
    "optimizer-ends": "WaitsForABetterOne",
    "optimizer-best": "ComparesValuesOnly",
    "optimizer-survives-nan": "TakesNaNForGood",
    "optimizer-resume": "ForgetsItsStep",
    "optimizer-promises": "LooksAtAllCosts",
    "optimizer-beats-random": "StaysAtHome",
    "optimizer-records": "CountsInPercent",
}

BROKEN = {
    id: OptimizerSpec(name="broken", target=f"tests.testing.broken.optimizers:{name}")
    for id, name in _NAMES.items()
}


class Search(PatternSearch):
    """A pattern search with one parameter; nothing is wrong with it."""

    def __init__(self, start, lower, upper, scale, /, *, rng, max_evaluations: int | None = None):
        super().__init__(start, lower, upper, scale, rng=rng, max_evaluations=max_evaluations)


class WholeCentersOnly(Search):
    """It takes every start for rows of whole centres, of four numbers each."""

    def __init__(self, start, lower, upper, scale, /, *, rng):
        start.reshape(-1, 4)
        super().__init__(start, lower, upper, scale, rng=rng)


class StartsElsewhere(Search):
    """The first candidate is beside the start."""

    def ask(self):
        if not self._started:
            self._current = np.clip(self._current + 1e-3, self._lower, self._upper)
        return super().ask()


class AsksForNothing(Search):
    """It goes on where no neighbour is feasible."""

    def tell(self, costs):
        super().tell(costs)
        if self._finished == "converged" and not len(self._neighbors()):
            self._finished = ""


class TakesWhatComes(Search):
    """It does not mind costs of nothing."""

    def tell(self, costs):
        if self._asked is not None:
            super().tell(costs)


class LeavesTheBounds(Search):
    """All neighbours, feasible or not."""

    def _neighbors(self):
        steps = np.diag(self._step * self._scale)
        return self._current + np.stack([steps, -steps], axis=1).reshape(-1, len(steps))


class WaitsForABetterOne(Search):
    """On a plateau it begins again with the first step, for ever."""

    def tell(self, costs):
        super().tell(costs)
        flat = len({record["value"] for record in self._history}) == 1
        if self._finished == "converged" and flat:
            self._step = self._first_step
            self._finished = "" if len(self._neighbors()) else "converged"


class WholePolls(Search):
    """The last poll is not cut short."""

    def ask(self):
        budget, self._budget = self._budget, None
        batch = super().ask()
        self._budget = budget
        return batch


class ComparesValuesOnly(Search):
    """Empty parts do not count."""

    empty = 0

    def tell(self, costs):
        if self._asked is None:
            raise UsageError("tell() comes after ask()")
        empty = {v.tobytes(): cost.empty for v, cost in zip(self._asked, costs, strict=True)}
        super().tell([Cost(0, cost.value) for cost in costs])
        self.empty = empty.get(self._current.tobytes(), self.empty)

    @property
    def best(self):
        vector, cost = super().best
        return vector, Cost(self.empty, cost.value)


class TakesNaNForGood(Search):
    """No cost is less than NaN, so it stays the best once it was told."""

    met = False

    def tell(self, costs):
        super().tell(costs)
        self.met = self.met or any(math.isnan(cost.value) for cost in costs)

    @property
    def best(self):
        vector, cost = super().best
        return vector, Cost(cost.empty, math.nan) if self.met else cost


class ForgetsItsStep(Search):
    """The step is not pickled."""

    def __getstate__(self):
        return {**vars(self), "_step": self._first_step}


class LooksAtAllCosts(Search):
    """It says that only the best counts, and steps by the mean."""

    def tell(self, costs):
        super().tell(costs)
        mean = float(np.mean([cost.value for cost in costs]))
        if math.isfinite(mean):
            self._step *= 1.0 + 0.01 * math.tanh(mean)


class StaysAtHome(Search):
    """The step never grows, and is soon too small to get anywhere."""

    def tell(self, costs):
        before = self._step
        super().tell(costs)
        self._step = min(self._step, 0.5 * before)


class CountsInPercent(Search):
    """Progress from 0 to 100."""

    @property
    def progress(self):
        return 100.0 * super().progress
