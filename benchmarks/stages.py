"""What each stage of a run costs, on a mesh of about 10 000 faces and on one ten times as fine.

    python benchmarks/stages.py [MESH]

The sample horse unless another mesh is given, as it is and with its faces cut up (155 000), under
the recipe horse. A generation and a poll are measured on the coarse shape and on the input
elements, each in the processor time of this process, so that what else the machine does matters
less. The last column is the ratio of the larger mesh to the smaller.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh

import moseg_core as moseg
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.protocols import Batch, Centers


def cut_up(shape: moseg.Shape, wanted: int) -> moseg.Shape:
    """The same surface, each triangle cut into four until there are so many."""
    vertices, faces = shape.geometry.vertices, shape.geometry.triangles
    while len(faces) < wanted:
        vertices, faces = trimesh.remesh.subdivide(vertices, faces)
    return moseg.Shape.from_mesh(vertices, faces, name=f"{shape.name} cut up")


def seconds(function: Callable[[], object], repeat: int = 3) -> float:
    """Median processor time of a call, after one to warm up."""
    function()
    times = []
    for _ in range(repeat):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return statistics.median(times)


def stages(shape: moseg.Shape) -> dict[str, float]:
    """Milliseconds by stage."""
    recipe = moseg.load_recipe("horse")
    problem = moseg.Problem(recipe.labels, recipe.minimize)
    n = len(problem.labels)
    coarse = moseg.coarsen(shape)
    rows = {"coarsen": seconds(lambda: moseg.coarsen(shape))}
    rng = np.random.default_rng(0)
    people = [coarse.points[rng.choice(coarse.n_elements, n, replace=False)] for _ in range(12)]
    for name, level in (("coarse", coarse), ("full", shape)):
        voronoi = Voronoi(level, n)
        encoded = np.stack(
            [voronoi.encode(Centers(positions=p, weights=np.ones(n))) for p in people]
        )
        steps = 0.05 * np.eye(4 * n)
        poll = np.concatenate([encoded[0] + steps, encoded[0] - steps])

        def evaluator(level: moseg.Shape = level, voronoi: Voronoi = voronoi) -> moseg.Evaluator:
            return moseg.Evaluator(level, problem, voronoi)

        rows[f"{name}: partition"] = seconds(lambda v=voronoi, x=poll: v.labels(x), 1) / len(poll)
        rows[f"{name}: individual of a generation"] = seconds(
            lambda make=evaluator, x=encoded: make().labelled_costs(x), 1
        ) / len(encoded)
        rows[f"{name}: candidate of a poll"] = seconds(
            lambda make=evaluator, x=poll: make().costs(Batch(vectors=x, best_only=True)), 1
        ) / len(poll)
    return {name: 1e3 * value for name, value in rows.items()}


def main() -> None:
    """Print the table."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else moseg.sample_path("horse")
    small = moseg.load(path)
    large = cut_up(small, 100_000)
    before, after = stages(small), stages(large)
    print(f"{'ms, processor time':40s}{small.n_elements:>10d}{large.n_elements:>10d}{'ratio':>9s}")
    for name, value in before.items():
        print(f"{name:40s}{value:10.2f}{after[name]:10.2f}{after[name] / value:9.2f}")


if __name__ == "__main__":
    main()
