"""The paper's settings against the formulas as they are printed.

One evaluation of the recipe paper_horse, at full resolution. Literally that is Algorithm 1 with a
queue in plain Python, covariances triangle by triangle, hulls by Qhull of all vertices, the
distance of each sample to the ellipsoid by bisection, and to the mirror image by a look at every
triangle, all as the tests have it (``tests/references.py``). Both sides integrate over the same
samples, and a cost that differs by more than 1e-9 is an error: what is compared is one computation.
"""

from __future__ import annotations

import math
import statistics
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

import moseg_core as moseg
from moseg_core.components.memo import Memo
from moseg_core.problem.aggregate import evaluate_segmentation
from speed_jobs.kernels import poll_around_kmeans
from speed_jobs.records import Record, Request

sys.path.insert(0, str(Path(__file__).parents[2]))
from plugins.moseg_objectives_basic.tests.conftest import squared_distances
from tests.references import connected_partition, triangle_moments

#: How often the literal implementation is run at most: it takes long, and varies little.
_MOST = 3
#: Of a search with the settings "paper", whose time is divided by their number.
_EVALUATIONS = 1000
STEPS = ("partition", "axes", "hulls", "ellipsoid", "mirror images")
"""The steps of an evaluation that are timed."""


class Literal:
    """Evaluations of paper_horse by the book, and the seconds that each step has taken.

    Parameters
    ----------
    shape : Shape
    """

    def __init__(self, shape: moseg.Shape) -> None:
        self.shape = shape
        self.seconds = dict.fromkeys(STEPS, 0.0)
        graph = shape.adjacency
        self._neighbors = [graph.neighbors(f).tolist() for f in range(shape.n_elements)]
        self._points = shape.unit_points.tolist()

    @contextmanager
    def _timed(self, step: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.seconds[step] += time.perf_counter() - start

    def cost(self, centers: np.ndarray, weights: np.ndarray) -> tuple[float, np.ndarray]:
        """The cost of head, body and four legs around these centres, and the labels."""
        with self._timed("partition"):
            found = connected_partition(
                self._points, self._neighbors, centers.tolist(), weights.tolist()
            )
        labels = np.array(found, np.int32)
        n = len(centers)
        parts = moseg.Segmentation.from_labels(self.shape, labels, n, memo=Memo(size=0)).parts
        with self._timed("axes"):
            about = [self._axes(part) for part in parts]
        scales = np.array([scale for _, scale, _ in about])
        legs = scales[2:]
        with self._timed("hulls"):
            hulls = sum(ConvexHull(part.vertices).volume for part in parts)
        volume = self.shape.volume
        total = ((hulls - volume) / volume) ** 2
        total += 10.0 * sum((s[1] + s[2]) / (2.0 * s[0]) for s in legs)
        total += ((legs - legs.mean(axis=0)) ** 2).sum() / self.shape.box_diagonal**2
        total += self._ellipsoidal(parts[1], *about[1])
        return total + sum(self._symmetric(parts[k], *about[k]) for k in (0, 1)), labels

    def _axes(self, part: moseg.Part) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Centroid, scales and axes, the longest first."""
        _, mean, covariance = triangle_moments(part.vertices[part.triangles].tolist())
        values, vectors = np.linalg.eigh(np.array(covariance))
        return np.array(mean), np.sqrt(np.maximum(values[::-1], 0.0)), vectors.T[::-1]

    def _surface_distance(
        self, part: moseg.Part, squared: np.ndarray, weights: np.ndarray, axes: np.ndarray
    ) -> float:
        box = np.ptp(part.vertices @ axes.T, axis=0)
        return float(weights @ squared / weights.sum() / (box @ box))

    def _ellipsoidal(
        self, part: moseg.Part, center: np.ndarray, scales: np.ndarray, axes: np.ndarray
    ) -> float:
        points, weights = part.measure("basic:surface_samples")
        with self._timed("ellipsoid"):
            radii = (math.sqrt(3.0) * scales).tolist()
            local = ((points - center) @ axes.T).tolist()
            squared = np.array([squared_distance_to_ellipsoid(p, radii) for p in local])
        return self._surface_distance(part, squared, weights, axes)

    def _symmetric(
        self, part: moseg.Part, center: np.ndarray, scales: np.ndarray, axes: np.ndarray
    ) -> float:
        points, weights = part.measure("basic:surface_samples")
        corners = part.vertices[part.triangles]
        values = []
        with self._timed("mirror images"):
            for axis in axes:
                image = corners - 2.0 * ((corners - center) @ axis)[..., None] * axis
                squared = squared_distances(points, image)
                values.append(self._surface_distance(part, squared, weights, axes))
        return min(values)


def squared_distance_to_ellipsoid(point: list[float], radii: list[float]) -> float:
    """The squared distance of a point to an axis-aligned ellipsoid at the origin, by bisection.

    The nearest point is ``x_i = r_i^2 p_i / (t + r_i^2)``, with the root ``t`` of
    ``sum_i (r_i p_i / (t + r_i^2))^2 = 1`` above ``-r_min^2``: the sum falls there from infinity
    to nothing. Of a point in the plane across the shortest radius, where it may not, none is here.
    """
    squares = [r * r for r in radii]
    low = -min(squares)
    high = math.hypot(*[r * p for r, p in zip(radii, point, strict=True)])
    for _ in range(100):
        t = (low + high) / 2
        if sum(s * p * p / (t + s) ** 2 for s, p in zip(squares, point, strict=True)) > 1.0:
            low = t
        else:
            high = t
    return sum((s * p / (high + s) - p) ** 2 for s, p in zip(squares, point, strict=True))


def literal(request: Request) -> Iterator[Record]:
    """An evaluation of paper_horse with the settings "paper", against a literal implementation."""
    shape = moseg.load(request.mesh)
    problem, voronoi, poll = poll_around_kmeans(shape)
    book = Literal(shape)
    runs: list[dict[str, float]] = []
    for vector in poll[: min(request.repeat, _MOST)]:
        book.seconds = dict.fromkeys(STEPS, 0.0)
        centers = voronoi.decode(vector)
        at = (centers.positions - shape.frame.center) / shape.frame.scale
        cost, labels = book.cost(at, centers.weights)
        runs.append(book.seconds)
        made = moseg.Segmentation.from_labels(shape, labels, len(problem.labels))
        expected = evaluate_segmentation(problem.terms, problem.labels, made).cost.value
        if not (labels == voronoi.labels(vector[None])[0]).all() or abs(cost - expected) > 1e-9:
            raise AssertionError(f"the literal implementation has a cost of {cost}, not {expected}")
    for step in STEPS:
        values = tuple(1e3 * found[step] for found in runs)
        yield Record(job="literal", what=f"literally: {step}", unit="ms", runs=values)
    whole = tuple(1e3 * sum(found.values()) for found in runs)
    yield Record(job="literal", what="literally, an evaluation", unit="ms", runs=whole)
    mine = searched(request.repeat, shape)
    yield Record(job="literal", what="moseg, an evaluation of a search", unit="ms", runs=mine)
    median = statistics.median(mine)
    ratio = tuple(value / median for value in whole)
    yield Record(job="literal", what="literal : moseg", unit=": 1", runs=ratio)
    near = tuple((a - 1e3 * b["mirror images"]) / median for a, b in zip(whole, runs, strict=True))
    what = "literal : moseg, the literal mirror images left out"
    yield Record(job="literal", what=what, unit=": 1", runs=near)


def searched(repeat: int, shape: moseg.Shape) -> tuple[float, ...]:
    """Milliseconds for an evaluation of a search with the settings "paper", seeding included."""
    recipe, found = moseg.load_recipe("paper_horse"), []
    for seed in range(repeat + 1):
        start = time.perf_counter()
        result = moseg.segment_hierarchy(
            shape,
            recipe,
            settings="paper",
            seeder="kmeans",
            optimizer=f"pattern_search(max_evaluations={_EVALUATIONS})",
            seed=seed,
        )
        spent = time.perf_counter() - start
        found.append(1e3 * spent / result.history["search"][-1]["evaluations"])
    return tuple(found[1:])  # the first has compiled, and computed what is kept with the shape
