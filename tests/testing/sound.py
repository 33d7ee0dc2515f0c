"""Components unlike moseg's own, and with nothing wrong: the kit must not ask too much."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Batch, Centers
from moseg_core.errors import UsageError


class Unweighted:
    """Voronoi partitions without weights: three numbers for each part."""

    def __init__(self, shape, n_parts):
        self._weighted = Voronoi(shape, n_parts, connected=False)

    @property
    def n_parts(self):
        return self._weighted.n_parts

    @property
    def lower(self):
        return np.full(3 * self.n_parts, -np.inf)

    @property
    def upper(self):
        return np.full(3 * self.n_parts, np.inf)

    @property
    def scale(self):
        return np.ones(3 * self.n_parts)

    def _rows(self, vectors):
        rows = np.reshape(vectors, (-1, self.n_parts, 3))
        return np.concatenate([rows, np.ones((*rows.shape[:2], 1))], axis=2).reshape(len(rows), -1)

    def labels(self, vectors):
        return self._weighted.labels(self._rows(vectors))

    def encode(self, centers):
        ones = Centers(positions=centers.positions, weights=np.ones(self.n_parts))
        return self._weighted.encode(ones).reshape(-1, 4)[:, :3].reshape(-1)

    def decode(self, vector):
        return self._weighted.decode(self._rows(vector)[0])

    def distances(self, vector, points):
        return self._weighted.distances(self._rows(vector)[0], points)

    def coordinates(self, part):
        return np.arange(3 * part, 3 * part + 3)

    def permute(self, vector, order):
        return np.reshape(vector, (-1, 3))[order].reshape(-1)


class Bodies(Voronoi):
    """Voronoi partitions whose first part has three centres; it must be told the labels."""

    def __init__(self, shape, n_parts, *, labels):
        super().__init__(shape, n_parts, centers=f"{labels[0]}=3", labels=labels)


class Spread:
    """A search by chance: ten children of the best so far, nearer where few of them are better.

    It knows no end of its own, and draws from its generator at every step.
    """

    def __init__(
        self,
        start,
        lower,
        upper,
        scale,
        /,
        *,
        rng,
        max_evaluations: Annotated[int | None, Interval(1)] = 300,
    ):
        self._best, self._cost = np.array(start), None
        self._lower, self._upper, self._scale, self._rng = lower, upper, scale, rng
        self._left = max_evaluations
        self._size = 0.5
        self._asked = None
        self._history = []
        self.finished = ""
        self.progress = 0.0

    @property
    def best(self):
        return self._best, Cost(0, np.inf) if self._cost is None else self._cost

    @property
    def history(self):
        return tuple(self._history)

    def ask(self):
        children = self._best[None]
        if self._cost is not None:
            count = 10 if self._left is None else min(10, self._left)
            steps = self._rng.normal(size=(count, len(self._best))) * self._size * self._scale
            children = (self._best + steps).clip(self._lower, self._upper)
        self._asked = children
        return Batch(vectors=children)

    def tell(self, costs):
        if self._asked is None:
            raise UsageError("tell() comes after ask()")
        asked, self._asked = self._asked, None
        ranked = [c if c.value == c.value else Cost(c.empty, np.inf) for c in costs]
        better = [k for k, c in enumerate(ranked) if self._cost is None or c < self._cost]
        if better:
            k = min(better, key=lambda k: ranked[k])
            self._best, self._cost = asked[k].copy(), ranked[k]
        self._size *= 1.2 if len(better) > len(asked) / 5 else 0.85
        self._history.append({"size": self._size})
        if self._left is not None:
            self._left -= len(asked)
            self.finished = "evaluations" if self._left == 0 else ""
