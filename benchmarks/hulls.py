"""How fast hulls are by Qhull, by manifold3d and by the one of a search, alone and in a search.

    python benchmarks/hulls.py

All in the same run, turn and turn about; medians of five, times of the processor. First hulls of
vertices around a random one of the sample horse, as many as said and turned, and of as many points
on a ball, which are corners of the hull all. Then two searches whose terms are made of hulls, with
parts of super-elements measured by each. For manifold3d points are moved by up to 1e-9, since it
errs where they lie in one plane.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence

import numpy as np
from manifold3d import Manifold
from moseg_objectives_basic import convexity
from moseg_objectives_basic.hulls import exact_hull_volume, fast_hull_volume
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core.samples import sample_path

SEARCHES = (("hammer", "paper_hammer"), ("horse", "paper_horse"))


def manifold_volume(points: np.ndarray) -> float:
    """The same by manifold3d, of points moved apart."""
    moves = np.random.default_rng(1785).uniform(-1e-9, 1e-9, points.shape)
    return float(Manifold.hull_points(points + moves).volume())


HULLS = {"Qhull": exact_hull_volume, "manifold3d": manifold_volume, "own": fast_hull_volume}


def in_unit_cube(points: np.ndarray) -> np.ndarray:
    """Points along their principal axes, stretched to a cube, as parts are measured."""
    local = points - points.mean(axis=0)
    local = local @ np.linalg.svd(local, full_matrices=False)[2].T
    return local / np.ptp(local, axis=0)


def parts(vertices: np.ndarray, size: int, count: int) -> list[np.ndarray]:
    """So many sets of neighbouring vertices, turned."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(count):
        apart = np.linalg.norm(vertices - vertices[rng.integers(len(vertices))], axis=1)
        near = vertices[np.argsort(apart)[:size]]
        found.append(in_unit_cube(Rotation.random(rng=rng).apply(near)))
    return found


def balls(size: int, count: int) -> list[np.ndarray]:
    """So many sets of random points on a ball."""
    points = np.random.default_rng(0).normal(size=(count, size, 3))
    points /= np.linalg.norm(points, axis=2, keepdims=True)
    return [in_unit_cube(ball) for ball in points]


def alternating(
    calls: Sequence[Callable[[], object]], clock: Callable[[], float], repeat: int = 5
) -> list[float]:
    """Median time of each of some calls in seconds, made in turn."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(repeat):
        for mine, call in zip(times, calls, strict=True):
            start = clock()
            call()
            mine.append(clock() - start)
    return [statistics.median(mine) for mine in times]


def hull_table() -> None:
    """Milliseconds for a hull, and the greatest difference from Qhull's."""
    vertices = moseg.load(sample_path("horse")).geometry.vertices
    print(f"{'points':>16}" + "".join(f"{kind:>12}" for kind in HULLS) + "  greatest differences")
    for size in (50, 500, 1500, 4800):
        for kind, sets in (("horse", parts(vertices, size, 30)), ("ball", balls(size, 10))):

            def all_of(volume: Callable[[np.ndarray], float], sets=sets) -> list[float]:
                return [volume(points) for points in sets]

            times = alternating(
                [lambda v=v, a=all_of: a(v) for v in HULLS.values()], time.process_time
            )
            exact, *others = (np.array(all_of(volume)) for volume in HULLS.values())
            print(
                f"{kind:>9} {size:>6}"
                + "".join(f"{1e3 * t / len(sets):>12.3f}" for t in times)
                + "".join(f"{np.abs(near / exact - 1).max():>10.1e}" for near in others)
            )


def search_table() -> None:
    """Seconds of the processor for a whole search, and what it comes to."""
    print(f"\n{'search':>16}" + "".join(f"{kind:>12}" for kind in HULLS) + "  costs")
    for sample, recipe in SEARCHES:
        shape, statement = moseg.load(sample_path(sample)), moseg.load_recipe(recipe)
        costs: dict[str, float] = {}

        def search(kind: str, shape=shape, statement=statement, costs=costs) -> None:
            convexity.fast_hull_volume = HULLS[kind]
            costs[kind] = moseg.segment_hierarchy(shape, statement).cost

        search("Qhull")  # what is kept with the shape is then there for all
        times = alternating([lambda k=k, s=search: s(k) for k in HULLS], time.process_time)
        print(
            f"{recipe:>16}"
            + "".join(f"{t:>12.2f}" for t in times)
            + f"  {sorted(set(costs.values()))}"
        )


if __name__ == "__main__":
    hull_table()
    search_table()
