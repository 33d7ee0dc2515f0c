"""Optimizers that are broken in one way each."""

from __future__ import annotations

import math

import numpy as np

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.cost import Cost

BROKEN = {
    "optimizer-start": "StartsElsewhere",
    "optimizer-ask": "AsksForNothing",
    "optimizer-tell": "TakesWhatComes",
    "optimizer-in-bounds": "LeavesTheBounds",
    "optimizer-budget": "WholePolls",
    "optimizer-best": "ComparesValuesOnly",
    "optimizer-survives-nan": "FallsOverNaN",
    "optimizer-resume": "ForgetsItsStep",
    "optimizer-promises": "LooksAtAllCosts",
    "optimizer-beats-random": "StaysAtHome",
    "optimizer-records": "CountsInPercent",
}


class StartsElsewhere(PatternSearch):
    """The first candidate is beside the start."""

    def __init__(self, start, lower, upper, scale, /, *, rng, max_evaluations: int | None = None):
        moved = np.clip(start + 1e-3, lower, upper)
        super().__init__(moved, lower, upper, scale, rng=rng, max_evaluations=max_evaluations)


class AsksForNothing(PatternSearch):
    """It goes on where no neighbour is feasible."""

    def tell(self, costs):
        super().tell(costs)
        if self._finished == "converged" and not len(self._neighbors()):
            self._finished = ""


class TakesWhatComes(PatternSearch):
    """It does not mind costs of nothing."""

    def tell(self, costs):
        if self._asked is not None:
            super().tell(costs)


class LeavesTheBounds(PatternSearch):
    """All neighbours, feasible or not."""

    def _neighbors(self):
        steps = np.diag(self._step * self._scale)
        return self._current + np.stack([steps, -steps], axis=1).reshape(-1, len(steps))


class WholePolls(PatternSearch):
    """The last poll is not cut short."""

    def ask(self):
        budget, self._budget = self._budget, None
        batch = super().ask()
        self._budget = budget
        return batch


class ComparesValuesOnly(PatternSearch):
    """Empty parts do not count."""

    def __init__(self, start, lower, upper, scale, /, *, rng, max_evaluations: int | None = None):
        super().__init__(start, lower, upper, scale, rng=rng, max_evaluations=max_evaluations)
        self._empty = {}

    def tell(self, costs):
        asked = self._asked
        if asked is not None:
            self._empty |= {v.tobytes(): c.empty for v, c in zip(asked, costs, strict=True)}
        super().tell([Cost(0, cost.value) for cost in costs])

    @property
    def best(self):
        vector, cost = super().best
        return vector, Cost(self._empty.get(vector.tobytes(), cost.empty), cost.value)


class FallsOverNaN(PatternSearch):
    """NaN is not expected."""

    def tell(self, costs):
        if any(math.isnan(cost.value) for cost in costs):
            raise ValueError("cannot convert float NaN to integer")
        super().tell(costs)


class ForgetsItsStep(PatternSearch):
    """The step is not pickled."""

    def __getstate__(self):
        return {**vars(self), "_step": self._first_step}


class LooksAtAllCosts(PatternSearch):
    """It says that only the best counts, and steps by the mean."""

    def tell(self, costs):
        super().tell(costs)
        mean = float(np.mean([cost.value for cost in costs]))
        if math.isfinite(mean):
            self._step *= 1.0 + 0.01 * math.tanh(mean)


class StaysAtHome(PatternSearch):
    """The step never grows, and is soon too small to get anywhere."""

    def tell(self, costs):
        before = self._step
        super().tell(costs)
        self._step = min(self._step, 0.5 * before)


class CountsInPercent(PatternSearch):
    """Progress from 0 to 100."""

    @property
    def progress(self):
        return 100.0 * super().progress
