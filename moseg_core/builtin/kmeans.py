"""K-means placement of the centres (Sec. 5.1, Algorithm 2).

Centres start at the two elements furthest apart and then, one by one, at the element furthest
from those chosen. Elements are classified by the parameterization, with weights of 1, and so
stay connected where the adjacency is known; centres move to the area-weighted centroids of their
segments; and so on until nothing changes. A segment that becomes empty starts again at the
element furthest from the centres of the others.

With connected classification the rounds can cycle: they also stop when a classification comes
back, or after a number of rounds.

The furthest element of all may be a stray triangle, a fold of a scan or a wrong return, and would
keep its centre for good. So a share of the area can be left out of account: those elements that are
furthest out, up to so much area together, are no places to start at. Where there are several
starts, those after the first draw their places at random, with chances that grow with area and
with the squared distance from the places drawn before (k-means++: Arthur and Vassilvitskii 2007,
https://dl.acm.org/doi/10.5555/1283383.1283494). The paper has neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import numpy as np

from moseg_core.builtin.diameter import farthest_pair
from moseg_core.components.labellings import Summary
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Centers, Evaluator, Progress, Report, Seeding
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, IntArray


class KMeans:
    """Compact segments of similar size.

    Parameters
    ----------
    rounds : int
        Most rounds to run.
    outliers : float
        Share of the area, of the elements furthest out, that is left out of account where a centre
        starts. 0 is the paper's way.
    drawn : bool
        Whether centres start at random elements, which differ from start to start; else at the
        furthest ones, the same whatever the random generator.
    """

    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "default": {"outliers": 0.001},
        "again": {"drawn": True},
    }

    def __init__(
        self,
        *,
        rounds: Annotated[int, Interval(1)] = 100,
        outliers: Annotated[float, Interval(0, 0.5)] = 0.0,
        drawn: bool = False,
    ) -> None:
        self.rounds = rounds
        self.outliers = outliers
        self.drawn = drawn

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """Place one centre per label."""
        shape, parameterization = evaluator.shape, evaluator.parameterization
        n = parameterization.n_parts
        spared = self.outliers * shape.area
        if self.drawn:
            centers = drawn_points(shape.points, shape.areas, n, rng)
        else:
            centers = furthest_points(shape.points, n, areas=shape.areas, spared=spared)
        seen: set[bytes] = set()
        history: list[dict[str, float]] = []
        for round_ in range(1, self.rounds + 1):
            vector = parameterization.encode(Centers(positions=centers, weights=np.ones(n)))
            summary = Summary.of(shape, parameterization.labels(vector[None])[0], n)
            key = summary.hashes.tobytes()
            if key in seen:
                break
            seen.add(key)
            moved = _update(shape, centers, summary, spared)
            step = float(np.linalg.norm(moved - centers, axis=1).max()) / shape.frame.scale
            history.append({"round": round_, "largest_step": step})
            centers = moved
            if report(Progress(stage="k-means", done=round_)):
                break
        return Seeding(centers=centers, history=tuple(history))


def furthest_points(
    points: FloatArray, n: int, *, areas: FloatArray | None = None, spared: float = 0.0
) -> FloatArray:
    """(n, 3) float: the two points furthest apart, then each time the one furthest from those.

    Parameters
    ----------
    points : (P, 3) float
    n : int
    areas : (P,) float, optional
        What each point stands for; needed where some is spared.
    spared : float
        So much area, of the points that are furthest out each time, is left out of account.

    Examples
    --------
    >>> import numpy as np
    >>> line = np.array([[0., 0, 0], [1, 0, 0], [2, 0, 0], [9, 0, 0]])
    >>> furthest_points(line, 3)[:, 0].tolist()
    [0.0, 9.0, 2.0]
    >>> furthest_points(line, 2, areas=np.array([1.0, 1, 1, 0.1]), spared=0.2)[:, 0].tolist()
    [0.0, 2.0]
    """
    areas = np.ones(len(points)) if areas is None else areas
    inner = np.arange(len(points))
    if spared > 0:
        middle = np.average(points, axis=0, weights=areas)
        order, beyond = _outermost(((points - middle) ** 2).sum(axis=1), areas)
        inner = np.sort(order[beyond > spared])
    chosen = [int(inner[k]) for k in farthest_pair(points[inner])][:n]
    while len(chosen) < n:
        chosen.append(_furthest_from(points, points[chosen], areas, spared))
    return points[chosen].copy()


def drawn_points(
    points: FloatArray, areas: FloatArray, n: int, rng: np.random.Generator
) -> FloatArray:
    """(n, 3) float: points drawn by area, and by squared distance from those drawn before.

    Parameters
    ----------
    points : (P, 3) float
    areas : (P,) float
        What each point stands for.
    n : int
    rng : numpy.random.Generator
        Draws ``choice(P)`` for each point.
    """
    chosen: list[int] = []
    chances = areas
    while len(chosen) < n:
        if not chances.sum() > 0:  # fewer different places than centres
            chances = np.ones(len(points))
        chosen.append(int(rng.choice(len(points), p=chances / chances.sum())))
        chances = areas * _nearest(points, points[chosen])
    return points[chosen].copy()


def _nearest(points: FloatArray, centers: FloatArray) -> FloatArray:
    """(P,) float: squared distance of each point from its nearest centre."""
    nearest = np.full(len(points), np.inf)
    for center in centers:
        np.minimum(nearest, ((points - center) ** 2).sum(axis=1), out=nearest)
    return nearest


def _furthest_from(
    points: FloatArray, centers: FloatArray, areas: FloatArray, spared: float
) -> int:
    """Index of the point whose nearest centre is furthest away, some area left out of account."""
    nearest = _nearest(points, centers)
    if spared <= 0:
        return int(np.argmax(nearest))
    order, beyond = _outermost(nearest, areas)
    return int(order[np.argmax(beyond > spared)])


def _outermost(distances: FloatArray, areas: FloatArray) -> tuple[IntArray, FloatArray]:
    """Points from the furthest to the nearest, and the area of each and all before it."""
    order = np.argsort(-distances, kind="stable")
    return order, np.cumsum(areas[order])


def _update(shape: Shape, centers: FloatArray, summary: Summary, spared: float) -> FloatArray:
    """Centroids of the segments; a fresh start for those without area."""
    area = summary.moments[:, 0]
    alive: BoolArray = area > 0
    moved = centers.copy()
    moved[alive] = summary.moments[alive, 1:4] / area[alive, None] + shape.frame.center
    for k in np.flatnonzero(~alive):
        moved[k] = shape.points[_furthest_from(shape.points, moved[alive], shape.areas, spared)]
        alive[k] = True
    return moved
