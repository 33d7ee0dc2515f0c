"""Jobs on the inner loop: the flood, and an evaluation of the recipe paper_horse."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import moseg_core as moseg
from moseg_core.builtin.flood import flood_labels, workspace
from moseg_core.builtin.kmeans import KMeans
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Centers
from moseg_core.problem.aggregate import evaluate_segmentation
from speed_jobs.records import Record, Request, alternating, quotients

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.references import connected_partition

#: A flood takes less than a millisecond: each run is the mean of so many.
_FLOODS = 20


def flood(request: Request) -> Iterator[Record]:
    """The connected partition of all faces, beside numpy's distances and a literal Algorithm 1."""
    shape = moseg.load(request.mesh)
    points, graph = shape.unit_points, shape.adjacency
    rng = np.random.default_rng(0)
    labels = np.empty(shape.n_elements, np.int32)
    neighbors = [graph.neighbors(f).tolist() for f in range(shape.n_elements)]
    for n in (2, 6, 9):
        centers = points[rng.choice(len(points), n, replace=False)].copy()
        weights, space = np.ones(n), workspace(n, len(points))

        def flooded(c=centers, w=weights, s=space) -> None:
            for _ in range(_FLOODS):
                flood_labels(points, c, w, graph.indptr, graph.indices, labels, *s)

        def nearest(c=centers, w=weights) -> None:
            for _ in range(_FLOODS):
                (np.linalg.norm(points[:, None] - c[None], axis=2) / w).argmin(axis=1)

        def literal(c=centers, w=weights) -> None:
            connected_partition(points.tolist(), neighbors, c.tolist(), w.tolist())

        flooded()  # compiled
        fast, dense, slow = alternating([flooded, nearest, literal], request.repeat, scale=1e3)
        fast, dense = (tuple(x / _FLOODS for x in times) for times in (fast, dense))
        for what, runs in (("flood", fast), ("numpy", dense), ("literal", slow)):
            yield Record(job="flood", what=f"{n} parts: {what}", unit="ms", runs=runs)
        ratio = quotients(fast, dense)
        yield Record(job="flood", what=f"{n} parts: flood : numpy", unit=": 1", runs=ratio)


def evaluation(request: Request) -> Iterator[Record]:
    """A candidate of a poll at full resolution with paper_horse, with and without shortcuts."""
    shape = moseg.load(request.mesh)
    problem, voronoi, poll = poll_around_kmeans(shape)
    size, n = len(poll), len(problem.labels)

    def unremembered() -> None:
        for labels in voronoi.labels(poll):
            made = moseg.Segmentation.from_labels(shape, labels, n, memo=Memo(size=0))
            evaluate_segmentation(problem.terms, problem.labels, made)

    def costs(best_only: bool) -> None:
        evaluator = moseg.ProblemEvaluator(shape, problem, voronoi)
        evaluator.costs(Batch(vectors=poll, best_only=best_only))

    rows = {
        "every term, nothing remembered": unremembered,
        "every term, a fresh memo": lambda: costs(False),
        "only the best matters, a fresh memo": lambda: costs(True),
        "partition alone, one core": lambda: [voronoi.labels(row[None]) for row in poll],
        "partition alone, all cores": lambda: voronoi.labels(poll),
    }
    costs(True)  # compiled, and what is kept with the shape computed
    measured = alternating(list(rows.values()), request.repeat, scale=1e3 / size)
    for what, runs in zip(rows, measured, strict=True):
        yield Record(job="evaluation", what=what, unit="ms", runs=runs)


def poll_around_kmeans(
    shape: moseg.Shape,
) -> tuple[moseg.Problem, Voronoi, np.ndarray]:
    """The problem paper_horse, its partitions, and a poll around what k-means finds."""
    recipe = moseg.load_recipe("paper_horse")
    problem = moseg.Problem(recipe.labels, recipe.minimize)
    n = len(problem.labels)
    voronoi = Voronoi(shape, n)
    fresh = moseg.ProblemEvaluator(shape, problem, voronoi)
    seeding = KMeans()(fresh, rng=np.random.default_rng(0), report=lambda _: None)
    start = voronoi.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
    steps = 0.05 * np.eye(len(start))
    return problem, voronoi, np.concatenate([start + steps, start - steps])
