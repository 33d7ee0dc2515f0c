"""How fast the inner loop is: the flood, an evaluation of the horse, fields, words.

    python benchmarks/speed.py [MESH]

Runs on the sample horse unless another mesh is given. Times are medians over repetitions in this
one process; ratios are what to compare, since machines and days differ.
"""

from __future__ import annotations

import itertools
import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import moseg_core as moseg
from moseg_core.builtin.flood import flood_labels, workspace
from moseg_core.builtin.kmeans import KMeans
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_sums, link_values
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Centers
from moseg_core.problem.aggregate import evaluate_segmentation

sys.path.insert(0, str(Path(__file__).parent.parent))
from tests.references import connected_partition


def median(function: Callable[[], object], repeat: int = 31) -> float:
    """Median time of a call in milliseconds, after one to warm up."""
    function()
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def flood_table(shape: moseg.Shape) -> None:
    """The flood against numpy, on the same points and centres."""
    points, graph = shape.unit_points, shape.adjacency
    rng = np.random.default_rng(0)
    labels = np.empty(shape.n_elements, np.int32)
    neighbors = [graph.neighbors(f).tolist() for f in range(shape.n_elements)]
    print(f"connected partition of {shape.n_elements} elements, ms")
    print(" parts   flood   numpy distances + argmin   ratio   argmin alone   literal reference")
    for n in (2, 6, 9):
        centers = points[rng.choice(len(points), n, replace=False)].copy()
        weights = np.ones(n)

        def distances(centers=centers, weights=weights) -> np.ndarray:
            return np.linalg.norm(points[:, None] - centers[None], axis=2) / weights

        known = distances()
        space = workspace(n, len(points))
        flood = median(
            lambda c=centers, w=weights, s=space: flood_labels(
                points, c, w, graph.indptr, graph.indices, labels, *s
            )
        )
        whole = median(lambda distances=distances: distances().argmin(axis=1))
        alone = median(lambda known=known: known.argmin(axis=1))
        literal = median(
            lambda c=centers, w=weights: connected_partition(
                points.tolist(), neighbors, c.tolist(), w.tolist()
            ),
            repeat=1,
        )
        print(f"{n:6d}{flood:8.2f}{whole:27.2f}{flood / whole:8.2f}{alone:15.2f}{literal:20.0f}")


def evaluation_table(shape: moseg.Shape) -> None:
    """A poll around the k-means start under the recipe paper_horse."""
    recipe = moseg.load_recipe("paper_horse")
    problem = moseg.Problem(recipe.labels, recipe.minimize)
    n = len(problem.labels)
    voronoi = Voronoi(shape, n)
    fresh = moseg.ProblemEvaluator(shape, problem, voronoi)
    seeding = KMeans()(fresh, rng=np.random.default_rng(0), report=lambda _: None)
    start = voronoi.encode(Centers(positions=seeding.centers, weights=np.ones(n)))
    steps = 0.05 * np.eye(len(start))
    poll = np.concatenate([start + steps, start - steps])
    size = len(poll)

    def evaluate_all(memo: Memo | None) -> None:
        for labels in voronoi.labels(poll):
            segmentation = moseg.Segmentation.from_labels(
                shape, labels, n, memo=Memo(size=0) if memo is None else memo
            )
            evaluate_segmentation(problem.terms, problem.labels, segmentation)

    exact = Batch(vectors=poll)
    best = Batch(vectors=poll, best_only=True)
    rows = {
        "every term, nothing remembered": median(lambda: evaluate_all(None), 3),
        "every term, a fresh memo": median(
            lambda: moseg.ProblemEvaluator(shape, problem, voronoi).costs(exact), 3
        ),
        "only the best matters, a fresh memo": median(
            lambda: moseg.ProblemEvaluator(shape, problem, voronoi).costs(best), 5
        ),
        "partition alone, one core": median(lambda: [voronoi.labels(row[None]) for row in poll], 5),
        "partition alone, all cores": median(lambda: voronoi.labels(poll), 5),
    }
    slowest = rows["every term, nothing remembered"]
    print(f"\na poll of {size} candidates, recipe paper_horse, ms a candidate")
    for name, total in rows.items():
        print(f"  {name:40s}{total / size:8.2f}   1 : {slowest / total:.1f}")


def height(shape: moseg.Shape) -> np.ndarray:
    """A field that costs next to nothing, so that what is done with it is what takes time."""
    return shape.points[:, 2]


FIELDS = moseg.Registry(
    [
        moseg.Bundle(
            *("here", "here", "0", __name__),
            (
                moseg.Component(
                    "here", "here 0", moseg.FieldSpec(name="height", target=f"{__name__}:height")
                ),
            ),
        )
    ]
)


def field_table(shape: moseg.Shape, n: int = 11) -> None:
    """What a part pays for a field and for its boundary, on a coarse shape of 2000 elements."""
    coarse = moseg.coarsen(shape, 2000)
    lookup, rng = Lookup(FIELDS), np.random.default_rng(0)
    voronoi = Voronoi(coarse, n)
    vectors = [
        voronoi.encode(
            Centers(
                positions=coarse.points[rng.choice(coarse.n_elements, n, replace=False)],
                weights=np.ones(n),
            )
        )
        for _ in range(300)
    ]
    labels = voronoi.labels(np.array(vectors))

    def ask(question: Callable[[moseg.Part], object]) -> float:
        """Microseconds per part for what is asked first of a new segmentation."""
        times = []
        for row in labels:
            made = moseg.Segmentation.from_labels(coarse, row, n, lookup=lookup)
            parts = [made.parts[k] for k in range(n) if made.summary.moments[k, 0] > 0]
            start = time.perf_counter()
            for part in parts:
                question(part)
            times.append((time.perf_counter() - start) / len(parts))
        return 1e6 * statistics.median(times)

    def once(level: moseg.Shape, compute: Callable[[moseg.Shape], object]) -> float:
        """Milliseconds for what is computed once per shape, on a new one each time."""
        times = []
        for _ in range(5):
            fresh = replace(level)
            start = time.perf_counter()
            compute(fresh)
            times.append(time.perf_counter() - start)
        return 1e3 * statistics.median(times)

    rows = {
        "part.field(name).mean": ask(lambda part: part.field("here:height").mean),
        "part.boundary.length": ask(lambda part: part.boundary.length),
        "part.boundary.mean(name)": ask(lambda part: part.boundary.mean("here:height")),
    }
    print(f"\n{n} parts on {coarse.n_elements} super-elements, microseconds a part, all asked")
    for name, each in rows.items():
        print(f"  {name:40s}{each:8.2f}")
    found = lookup.field("here:height")
    fine = once(shape, lambda fresh: fresh.links)
    once_only = {
        f"links of {shape.n_elements} elements": fine,
        "links of the super-elements, from those": once(coarse, lambda fresh: fresh.links),
        "sums of a field over super-elements": once(
            coarse, lambda fresh: field_sums(fresh, found, {})
        ),
        "a field along the links": once(coarse, lambda fresh: link_values(fresh, found, {})),
    }
    print("\nonce per shape, ms")
    for name, each in once_only.items():
        print(f"  {name:40s}{each:8.2f}")


def word_table(shape: moseg.Shape, n: int = 11) -> None:
    """What each cheap word costs a part, asked alone of new partitions of a coarse shape."""
    coarse, lookup = moseg.coarsen(shape, 2000), Lookup()
    rng, voronoi = np.random.default_rng(0), Voronoi(coarse, n)
    labels = [
        voronoi.labels(voronoi.encode(Centers(positions=at, weights=np.ones(n)))[None])[0]
        for at in (coarse.points[rng.choice(coarse.n_elements, n, False)] for _ in range(100))
    ]
    words: dict[str, dict[str, moseg.Target]] = {}
    for component in moseg.registry().components("objective"):
        traits = component.load().traits
        if component.bundle == "basic" and traits.cost == "cheap":
            words[component.spec.name] = {}
    everything = {p.name: moseg.Target(0.5, 0.2) for p in word("is").parameters}
    words = {**words, "is": {"area": moseg.Target(0.1, 0.1)}, "is, 13 measures": everything}
    print(f"\n{n} parts on {coarse.n_elements} super-elements, microseconds a part, each alone")
    for title, parameters in words.items():
        objective = word(title.partition(",")[0])
        times = []
        for row in [labels[0], *labels]:
            made = moseg.Segmentation.from_labels(coarse, row, n, lookup=lookup)
            parts = [part for part in made.parts if part.area > 0]
            of_one = objective.traits.arity == "unary"
            asked: list[object] = [*parts] if of_one else [made]
            if objective.traits.arity == "nary":
                asked = list(itertools.pairwise(parts))
            start = time.perf_counter()
            for each in asked:
                objective(each, **parameters)
            times.append((time.perf_counter() - start) / len(parts))
        print(f"  {title:40s}{1e6 * statistics.median(times[1:]):8.2f}")


def word(name: str) -> Any:
    """A basic objective."""
    return moseg.registry().find("objective", f"basic:{name}").load()


def main() -> None:
    """Print all tables."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else moseg.sample_path("horse")
    shape = moseg.load(path)
    flood_table(shape)
    evaluation_table(shape)
    field_table(shape)
    word_table(shape)


if __name__ == "__main__":
    main()
