"""Generalized pattern search (Sec. 7): look around in all directions, step or narrow down.

The cost is constant while no element changes its part, so there is no gradient to follow.
Instead, all 2m neighbours at a distance ``Delta`` along the coordinates are polled. If the best
of them is better, the search moves there and ``Delta`` doubles; if none is, ``Delta`` halves;
below a threshold the search has converged. Torczon 1997, doi:10.1137/S1052623493250780; Audet
and Dennis 2003, doi:10.1137/S1052623400378742.

Neighbours outside the bounds, that is weights of 0 or less, are left out and not counted.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, ClassVar

import numpy as np

from moseg_core.components.cost import WORST, Cost
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Batch
from moseg_core.errors import UsageError
from moseg_core.types import FloatArray


class PatternSearch:
    """Complete polls, best neighbour taken.

    Parameters
    ----------
    start : (m,) float
        Where the search begins.
    lower, upper : (m,) float
        Feasible values.
    scale : (m,) float
        Size of a step of 1 along each coordinate.
    rng : numpy.random.Generator
        Not used: the search is deterministic.
    pattern_size : float
        First ``Delta``.
    expansion, contraction : float
        Factors after a successful and an unsuccessful poll.
    threshold : float
        The search has converged when ``Delta`` is below it.
    max_evaluations : int or None
        Most candidates to evaluate; the last poll is cut short.

    Examples
    --------
    >>> import numpy as np
    >>> search = PatternSearch(np.zeros(1), np.full(1, -9.), np.full(1, 9.), np.ones(1),
    ...                        rng=np.random.default_rng(0))
    >>> while not search.finished:
    ...     search.tell([Cost(0, float(abs(x - 0.3))) for x, in search.ask().vectors])
    >>> search.finished, round(float(search.best[0][0]), 5)
    ('converged', 0.3)
    """

    #: On a coarse shape it ends at steps that super-elements can feel, in diagonals.
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "coarse": {"threshold": 5e-3},
        "polish": {"pattern_size": 0.01, "threshold": 1e-4, "max_evaluations": 300},
    }

    def __init__(
        self,
        start: FloatArray,
        lower: FloatArray,
        upper: FloatArray,
        scale: FloatArray,
        /,
        *,
        rng: np.random.Generator,
        pattern_size: Annotated[float, Interval(1e-12)] = 0.2,
        expansion: Annotated[float, Interval(1.0)] = 2.0,
        contraction: Annotated[float, Interval(0.01, 0.99)] = 0.5,
        threshold: Annotated[float, Interval(1e-12)] = 1e-6,
        max_evaluations: Annotated[int | None, Interval(1)] = None,
    ) -> None:
        self._current = np.array(start, dtype=np.float64)
        self._lower, self._upper, self._scale = lower, upper, scale
        self._cost: Cost = WORST
        self._started = False
        self._first_step = self._step = pattern_size
        self._expansion, self._contraction = expansion, contraction
        self._threshold = threshold
        self._budget = max_evaluations
        self._evaluations = 0
        self._asked: FloatArray | None = None
        self._history: list[dict[str, float]] = []
        self._finished = ""

    @property
    def finished(self) -> str:
        """Why it ended: "converged", or "evaluations" for the limit on them; else empty."""
        return self._finished

    @property
    def best(self) -> tuple[FloatArray, Cost]:
        """The current point and its cost."""
        return self._current, self._cost

    @property
    def history(self) -> tuple[dict[str, float], ...]:
        """Per iteration: evaluations so far, cost, empty parts, and ``Delta`` as polled."""
        return tuple(self._history)

    @property
    def progress(self) -> float:
        """How far ``Delta`` has come down, on a logarithmic scale."""
        if self._finished:
            return 1.0
        whole = math.log(self._first_step / self._threshold)
        done = math.log(self._first_step / self._step) / whole if whole > 0 else 1.0
        return min(max(done, 0.0), 1.0)

    def ask(self) -> Batch:
        """The start at first; then the feasible neighbours of the current point."""
        if not self._started:
            self._asked = self._current[None]
            return Batch(vectors=self._asked)
        neighbors = self._neighbors()
        if self._budget is not None:
            neighbors = neighbors[: self._budget - self._evaluations]
        self._asked = neighbors
        return Batch(vectors=neighbors, cutoff=self._cost, best_only=True)

    def tell(self, costs: Sequence[Cost]) -> None:
        """Move or narrow down."""
        if self._asked is None:
            raise UsageError("pattern_search: tell() comes after ask()")
        asked, self._asked = self._asked, None
        self._evaluations += len(asked)
        step = self._step
        if not self._started:
            self._cost, self._started = _rank(costs[0]), True
        else:
            best = min(range(len(costs)), key=lambda k: (_rank(costs[k]), k))
            if _rank(costs[best]) < self._cost:
                # NaN must not be kept: no cost compares as less than it.
                self._current, self._cost = asked[best].copy(), _rank(costs[best])
                self._step *= self._expansion
            else:
                self._step *= self._contraction
        self._history.append(
            {
                "evaluations": self._evaluations,
                "value": self._cost.value,
                "empty": self._cost.empty,
                "step": step,
            }
        )
        # Where no neighbour is feasible there is nothing to evaluate, only to narrow down.
        while self._step >= self._threshold and not len(self._neighbors()):
            self._step *= self._contraction
        if self._step < self._threshold:
            self._finished = "converged"
        elif self._budget is not None and self._evaluations >= self._budget:
            self._finished = "evaluations"

    def _neighbors(self) -> FloatArray:
        """(k, m) float: the feasible ones of the 2m neighbours."""
        steps = np.diag(self._step * self._scale)
        both = self._current + np.stack([steps, -steps], axis=1).reshape(-1, len(steps))
        feasible = ((both >= self._lower) & (both <= self._upper)).all(axis=1)
        return both[feasible]


def _rank(cost: Cost) -> Cost:
    """The cost, with NaN as bad as can be."""
    return cost if cost.value == cost.value else Cost(cost.empty, np.inf)
