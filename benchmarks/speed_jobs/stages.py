"""What each step of a search costs, on the mesh and on one of nine times as many faces.

A generation and a poll under the recipe paper_horse, with the same centres on both meshes, are
measured on the coarse shape and on the input elements, in the processor time of this process.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np

import moseg_core as moseg
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Batch, Centers
from speed_jobs.records import Record, Request, quotients, repeated
from speed_jobs.subdivision import cut_up

Polls = list[np.ndarray]
Times = dict[str, tuple[float, ...]]


def stages(request: Request) -> Iterator[Record]:
    """Steps of a search on the mesh, and on one of nine times as many faces; ratios."""
    small = moseg.load(request.mesh)
    large = cut_up(small, 3)
    people = some_centers(small, len(moseg.load_recipe("paper_horse").labels))
    before, after = (steps(shape, people, request.repeat) for shape in (small, large))
    for what, runs in before.items():
        for shape, times in ((small, runs), (large, after[what])):
            title = f"{what}, {shape.n_elements} faces"
            yield Record(job="stages", what=title, unit="ms", runs=times)
        ratio = quotients(after[what], runs)
        yield Record(job="stages", what=f"{what}, nine times the faces", unit=": 1", runs=ratio)


def some_centers(shape: moseg.Shape, n: int) -> list[Centers]:
    """Random individuals."""
    rng = np.random.default_rng(0)
    return [
        Centers(
            positions=shape.points[rng.choice(shape.n_elements, n, replace=False)],
            weights=np.ones(n),
        )
        for _ in range(40)
    ]


def steps(shape: moseg.Shape, people: list[Centers], repeat: int) -> Times:
    """Milliseconds of the processor by step."""
    recipe = moseg.load_recipe("paper_horse")
    problem = moseg.Problem(recipe.labels, recipe.minimize)
    n = len(problem.labels)
    coarse = moseg.coarsen(shape)

    def spent(function: Callable[[], object], count: int = 1) -> tuple[float, ...]:
        return repeated(function, repeat, scale=1e3 / count, clock=time.process_time)

    rows = {"coarsen": spent(lambda: moseg.coarsen(shape))}
    for name, level in (("coarse", coarse), ("full", shape)):
        voronoi = Voronoi(level, n)
        encoded = np.stack([voronoi.encode(centers) for centers in people])
        moves = 0.05 * np.eye(4 * n)
        polls = [np.concatenate([vector + moves, vector - moves]) for vector in encoded[::4]]

        def evaluator(
            level: moseg.Shape = level, voronoi: Voronoi = voronoi
        ) -> moseg.ProblemEvaluator:
            return moseg.ProblemEvaluator(level, problem, voronoi)

        def all_polls(
            make: Callable[[], moseg.ProblemEvaluator] = evaluator, polls: Polls = polls
        ) -> None:
            for poll in polls:
                make().costs(Batch(vectors=poll, best_only=True))

        rows[f"{name}: partition"] = spent(lambda v=voronoi, x=encoded: v.labels(x), len(encoded))
        rows[f"{name}: individual of a generation"] = spent(
            lambda make=evaluator, x=encoded: make().labelled_costs(x), len(encoded)
        )
        rows[f"{name}: candidate of a poll"] = spent(all_polls, sum(map(len, polls)))
    return rows
