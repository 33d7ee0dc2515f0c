"""K-means placement of the centres (Sec. 5.1, Algorithm 2).

Centres start at the two elements furthest apart and then, one by one, at the element furthest
from those chosen. Elements are classified by the parameterization, with weights of 1, and so
stay connected where the adjacency is known; centres move to the area-weighted centroids of their
segments; and so on until nothing changes. A segment that becomes empty starts again at the
element furthest from the centres of the others.

With connected classification the rounds can cycle: they also stop when a classification comes
back, or after a number of rounds.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from moseg_core.builtin.diameter import farthest_pair
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Centers, Evaluator, Progress, Report, Seeding
from moseg_core.components.segmentation import Summary
from moseg_core.types import BoolArray, FloatArray


class KMeans:
    """Compact segments of similar size; deterministic, whatever the random generator.

    Parameters
    ----------
    rounds : int
        Most rounds to run.
    """

    def __init__(self, *, rounds: Annotated[int, Interval(1)] = 100) -> None:
        self.rounds = rounds

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """Place one centre per label."""
        shape, parameterization = evaluator.shape, evaluator.parameterization
        n = parameterization.n_parts
        centers = furthest_points(shape.points, n)
        seen: set[bytes] = set()
        history: list[dict[str, float]] = []
        for round_ in range(1, self.rounds + 1):
            vector = parameterization.encode(Centers(positions=centers, weights=np.ones(n)))
            summary = Summary.of(shape, parameterization.labels(vector[None])[0], n)
            key = summary.hashes.tobytes()
            if key in seen:
                break
            seen.add(key)
            moved = _update(shape.points, shape.frame.center, centers, summary)
            step = float(np.linalg.norm(moved - centers, axis=1).max()) / shape.frame.scale
            history.append({"round": round_, "largest_step": step})
            centers = moved
            if report(Progress(stage="k-means", done=round_)):
                break
        return Seeding(centers=centers, history=tuple(history))


def furthest_points(points: FloatArray, n: int) -> FloatArray:
    """(n, 3) float: the two points furthest apart, then each time the one furthest from those.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.array([[0., 0, 0], [1, 0, 0], [2, 0, 0], [9, 0, 0]])
    >>> furthest_points(line, 3)[:, 0].tolist()
    [0.0, 9.0, 2.0]
    """
    chosen = list(farthest_pair(points))[:n]
    while len(chosen) < n:
        chosen.append(_furthest_from(points, points[chosen]))
    return points[chosen].copy()


def _furthest_from(points: FloatArray, centers: FloatArray) -> int:
    """Index of the point whose nearest centre is furthest away."""
    nearest = np.full(len(points), np.inf)
    for center in centers:
        np.minimum(nearest, ((points - center) ** 2).sum(axis=1), out=nearest)
    return int(np.argmax(nearest))


def _update(
    points: FloatArray, origin: FloatArray, centers: FloatArray, summary: Summary
) -> FloatArray:
    """Centroids of the segments; a fresh start for those without area."""
    area = summary.moments[:, 0]
    alive: BoolArray = area > 0
    moved = centers.copy()
    moved[alive] = summary.moments[alive, 1:4] / area[alive, None] + origin
    for k in np.flatnonzero(~alive):
        moved[k] = points[_furthest_from(points, moved[alive])]
        alive[k] = True
    return moved
