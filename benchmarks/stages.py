"""What each stage of a run costs, on a mesh of about 10 000 faces and on one ten times as fine.

    python benchmarks/stages.py [MESH [FINER]]

The sample horse unless another mesh is given, as it is and either with each face cut into nine
(87 000) or beside a finer mesh of the same surface, under the recipe paper_horse. A generation and
a poll, with the same centres on both, are measured on the coarse shape and on the input elements,
each in the processor time of this process, so that what else the machine does matters less. The
last column is the ratio of the larger mesh to the smaller.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import moseg_core as moseg
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Batch, Centers

Polls = list[np.ndarray]


def cut_up(shape: moseg.Shape, n: int) -> moseg.Shape:
    """The same surface, each triangle cut into n^2 equal ones that meet corner to corner."""
    vertices, faces = shape.geometry.vertices, shape.geometry.triangles
    grid = [(i, j) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {place: k for k, place in enumerate(grid)}
    small = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in grid if i + j < n]
    small += [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in grid if i + j < n - 1
    ]
    parts = np.array([(n - i - j, i, j) for i, j in grid])
    # A point is told by the corners that it lies between, and its share of each.
    corners = np.repeat(faces[:, None], len(grid), axis=1)
    order = np.where(parts > 0, corners, -1).argsort(axis=2)
    who = np.take_along_axis(np.where(parts > 0, corners, -1), order, axis=2)
    share = np.take_along_axis(np.broadcast_to(parts, corners.shape), order, axis=2)
    keys, place = np.unique(
        np.concatenate([who, share], axis=2).reshape(-1, 6), axis=0, return_inverse=True
    )
    points = np.einsum("pk,pki->pi", keys[:, 3:] / n, vertices[keys[:, :3]])
    cut = place.reshape(len(faces), -1)[:, small].reshape(-1, 3)
    return moseg.Shape.from_mesh(points, cut, name=f"{shape.name} cut up")


def seconds(function: Callable[[], object], repeat: int = 3) -> float:
    """Median processor time of a call, after one to warm up."""
    function()
    times = []
    for _ in range(repeat):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return statistics.median(times)


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


def stages(shape: moseg.Shape, people: list[Centers]) -> dict[str, float]:
    """Milliseconds by stage."""
    recipe = moseg.load_recipe("paper_horse")
    problem = moseg.Problem(recipe.labels, recipe.minimize)
    n = len(problem.labels)
    coarse = moseg.coarsen(shape)
    rows = {"coarsen": seconds(lambda: moseg.coarsen(shape))}
    for name, level in (("coarse", coarse), ("full", shape)):
        voronoi = Voronoi(level, n)
        encoded = np.stack([voronoi.encode(centers) for centers in people])
        steps = 0.05 * np.eye(4 * n)
        polls = [np.concatenate([vector + steps, vector - steps]) for vector in encoded[::4]]

        def evaluator(
            level: moseg.Shape = level, voronoi: Voronoi = voronoi
        ) -> moseg.ProblemEvaluator:
            return moseg.ProblemEvaluator(level, problem, voronoi)

        rows[f"{name}: partition"] = seconds(lambda v=voronoi, x=encoded: v.labels(x), 1) / len(
            encoded
        )
        rows[f"{name}: individual of a generation"] = seconds(
            lambda make=evaluator, x=encoded: make().labelled_costs(x), 1
        ) / len(encoded)

        def all_polls(
            make: Callable[[], moseg.ProblemEvaluator] = evaluator, polls: Polls = polls
        ) -> None:
            for poll in polls:
                make().costs(Batch(vectors=poll, best_only=True))

        rows[f"{name}: candidate of a poll"] = seconds(all_polls, 1) / sum(map(len, polls))
    return {name: 1e3 * value for name, value in rows.items()}


def main() -> None:
    """Print the table."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else moseg.sample_path("horse")
    small = moseg.load(path)
    large = moseg.load(sys.argv[2]) if len(sys.argv) > 2 else cut_up(small, 3)
    people = some_centers(small, len(moseg.load_recipe("paper_horse").labels))
    before, after = stages(small, people), stages(large, people)
    print(f"{'ms, processor time':40s}{small.n_elements:>10d}{large.n_elements:>10d}{'ratio':>9s}")
    for name, value in before.items():
        print(f"{name:40s}{value:10.2f}{after[name]:10.2f}{after[name] / value:9.2f}")


if __name__ == "__main__":
    main()
