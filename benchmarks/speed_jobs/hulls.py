"""Hulls by Qhull and by manifold3d, alone and in a search, in turn.

First hulls of vertices around a random one of the mesh, as many as said and turned, and of as many
points on a ball, which are corners of the hull all. Then a search whose terms are made of hulls,
with parts of super-elements measured by each.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np
from moseg_objectives_basic import convexity
from moseg_objectives_basic.hulls import exact_hull_volume, fast_hull_volume
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from speed_jobs.records import Record, Request, alternating, quotients

HULLS = {"Qhull": exact_hull_volume, "manifold3d": fast_hull_volume}


def hulls(request: Request) -> Iterator[Record]:
    """Hulls by Qhull and manifold3d, of 50 to 4800 points and in a search; ratios."""
    vertices = moseg.load(request.mesh).geometry.vertices
    for size in (50, 500, 1500, 4800):
        for kind, sets in (("the mesh", parts(vertices, size, 30)), ("a ball", balls(size, 10))):

            def all_of(volume: Callable[[np.ndarray], float], sets=sets) -> list[float]:
                return [volume(points) for points in sets]

            exact, *others = (np.array(all_of(volume)) for volume in HULLS.values())
            if not all(np.allclose(found, exact, rtol=1e-8, atol=0.0) for found in others):
                raise AssertionError(f"hulls of {size} points of {kind} differ by more than 1e-8")
            calls = [lambda v=v, a=all_of: a(v) for v in HULLS.values()]
            times = alternating(calls, request.repeat, scale=1e3 / len(sets))
            yield from _compared(f"{size} points of {kind}", "ms", times)
    yield from _compared("search, paper_hammer: processor seconds", "s", searches(request))


def _compared(title: str, unit: str, times: list[tuple[float, ...]]) -> Iterator[Record]:
    for name, runs in zip(HULLS, times, strict=True):
        yield Record(job="hulls", what=f"{title}, {name}", unit=unit, runs=runs)
    for name, runs in zip(HULLS, times, strict=True):
        if runs is not times[0]:
            ratio = quotients(times[0], runs)
            yield Record(job="hulls", what=f"{title}, Qhull : {name}", unit=": 1", runs=ratio)


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


def searches(request: Request) -> list[tuple[float, ...]]:
    """Processor seconds of whole searches by each."""
    shape, recipe = moseg.load(moseg.sample_path("hammer")), moseg.load_recipe("paper_hammer")

    def search(kind: str) -> None:
        convexity.fast_hull_volume = HULLS[kind]
        moseg.segment_hierarchy(shape, recipe)

    try:
        search("Qhull")  # what is kept with the shape is then there for all
        calls = [lambda kind=kind: search(kind) for kind in HULLS]
        return alternating(calls, request.repeat, clock=time.process_time)
    finally:
        convexity.fast_hull_volume = fast_hull_volume
