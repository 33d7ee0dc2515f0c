"""Generalized pattern search (Sec. 7): look around in all directions, step or narrow down.

The cost is constant while no element changes its part, so there is no gradient to follow.
Instead, all 2m neighbours at a distance ``Delta`` along the coordinates are polled. If the best
of them is better, the search moves there and ``Delta`` doubles; if none is, ``Delta`` halves;
below a threshold the search has converged. Torczon 1997, doi:10.1137/S1052623493250780; Audet
and Dennis 2003, doi:10.1137/S1052623400378742.

A poll takes 2m evaluations and moves along one coordinate, while centres that are far apart hardly
feel each other. With ``combine`` a successful poll is followed by the sums of its best moves: two
of them, three, four, six, and so on to all that were better. The best of these is taken where it
is better than the best move alone. Candidates besides the poll are the *search step* of Audet and
Dennis: the poll still decides when to narrow down, so that what is known of convergence holds.

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
    """Complete polls, best neighbour taken, or several moves at once.

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
    combine : bool
        Whether sums of a poll's best moves are tried, one move along each coordinate.

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
        combine: bool = False,
    ) -> None:
        self._current = np.array(start, dtype=np.float64)
        self._lower, self._upper, self._scale = lower, upper, scale
        self._cost: Cost = WORST
        self._started = False
        self._first_step = self._step = pattern_size
        self._expansion, self._contraction = expansion, contraction
        self._threshold = threshold
        self._budget = max_evaluations
        self._combine = combine
        self._sums: FloatArray | None = None  # of moves of the last poll, if they are to be tried
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
        """The start; then the feasible neighbours of the current point, or sums of its moves."""
        if not self._started:
            self._asked = self._current[None]
            return Batch(vectors=self._asked)
        polled = self._sums is None
        candidates = self._neighbors() if self._sums is None else self._sums
        if self._budget is not None:
            candidates = candidates[: self._budget - self._evaluations]
        self._asked = candidates
        # Which moves are worth combining is known only where all that are better are evaluated.
        only_best = not (self._combine and polled)
        return Batch(vectors=candidates, cutoff=self._cost, best_only=only_best)

    def tell(self, costs: Sequence[Cost]) -> None:
        """Move, combine moves, or narrow down."""
        if self._asked is None:
            raise UsageError("pattern_search: tell() comes after ask()")
        asked, self._asked = self._asked, None
        self._evaluations += len(asked)
        step = self._step
        if not self._started:
            self._cost, self._started = _rank(costs[0]), True
        else:
            polled, self._sums = self._sums is None, None
            ranks = [_rank(cost) for cost in costs]
            better = sorted(
                (k for k, rank in enumerate(ranks) if rank < self._cost),
                key=lambda k: (ranks[k], k),
            )
            if polled and better and self._combine:
                self._sums = self._sums_of(asked[better])
            if better:
                # NaN must not be kept: no cost compares as less than it.
                self._current, self._cost = asked[better[0]].copy(), ranks[better[0]]
            if polled:
                self._step *= self._expansion if better else self._contraction
        self._history.append(
            {
                "evaluations": self._evaluations,
                "value": self._cost.value,
                "empty": self._cost.empty,
                "step": step,
            }
        )
        if self._sums is None:
            # Where no neighbour is feasible there is nothing to evaluate, only to narrow down.
            while self._step >= self._threshold and not len(self._neighbors()):
                self._step *= self._contraction
            if self._step < self._threshold:
                self._finished = "converged"
                return
        if self._budget is not None and self._evaluations >= self._budget:
            self._finished = "evaluations"

    def _neighbors(self) -> FloatArray:
        """(k, m) float: the feasible ones of the 2m neighbours."""
        steps = np.diag(self._step * self._scale)
        both = self._current + np.stack([steps, -steps], axis=1).reshape(-1, len(steps))
        feasible = ((both >= self._lower) & (both <= self._upper)).all(axis=1)
        return both[feasible]

    def _sums_of(self, better: FloatArray) -> FloatArray | None:
        """(k, m) float: the current point moved by the best two moves, three, four, six, ...

        Parameters
        ----------
        better : (b, m) float
            Neighbours that are better than the current point, the best first. Of two along the
            same coordinate the worse is left out.

        Returns
        -------
        (k, m) float or None
            None where all are along one coordinate.
        """
        along = (better != self._current).argmax(axis=1)
        coordinates, first = np.unique(along, return_index=True)
        order = np.argsort(first)
        point, summed = self._current.copy(), []
        for coordinate, k in zip(coordinates[order], first[order], strict=True):
            point[coordinate] = better[k, coordinate]
            summed.append(point.copy())
        counts = {c for k in range(64) for c in (2 << k, 3 << k) if c < len(summed)}
        counts |= {len(summed)} - {1}
        return np.array([summed[count - 1] for count in sorted(counts)]) if counts else None


def _rank(cost: Cost) -> Cost:
    """The cost, with NaN as bad as can be."""
    return cost if cost.value == cost.value else Cost(cost.empty, np.inf)
