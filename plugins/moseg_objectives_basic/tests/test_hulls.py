"""The fast hull of a search against Qhull."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic import convexity
from moseg_objectives_basic.hulls import exact_hull_volume, fast_hull_volume
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core.samples import SAMPLES, sample_path
from moseg_core.testing.fixtures.shapes import ZOO, specimen

#: What may be wrong of a hull while searching, as a share of its volume.
CLOSE = 1e-12


def in_unit_cube(points):
    """Points along their principal axes, stretched to a cube, as parts are measured."""
    local = points - points.mean(axis=0)
    local = local @ np.linalg.svd(local, full_matrices=False)[2].T
    return local / np.ptp(local, axis=0)


def check(points, close=CLOSE):
    assert fast_hull_volume(points) == pytest.approx(exact_hull_volume(points), rel=close)


@pytest.mark.parametrize("name", ZOO)
def test_parts_of_the_zoo(name):
    geometry, rng = specimen(name).geometry, np.random.default_rng(0)
    vertices = geometry.vertices[np.unique(geometry.corners)]
    for _ in range(10):
        points = vertices[rng.random(len(vertices)) < 0.7]
        points = Rotation.random(rng=rng).apply(points)
        if len(points) < 4 or np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-9) < 3:
            continue
        check(in_unit_cube(points))


SOLIDS = {
    "tetrahedron": trimesh.Trimesh(
        [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
        [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    ),
    "cube": trimesh.creation.box(),
    "icosahedron": trimesh.creation.icosahedron(),
    "prism": trimesh.creation.cylinder(radius=1.0, height=3.0, sections=7),
}


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("seed", range(8))
def test_solids_with_many_vertices_in_their_planes(name, seed):
    solid = SOLIDS[name].copy()
    for _ in range(1 + seed % 4):
        solid = solid.subdivide()
    points = Rotation.random(rng=seed).apply(solid.vertices)
    check(points / np.ptp(points, axis=0))
    check(in_unit_cube(points))


@pytest.mark.parametrize("thickness", [1e-1, 1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("seed", range(6))
def test_thin_boxes(make, thickness, seed):
    rng = np.random.default_rng(seed)
    steps = [np.linspace(0, 1, k) for k in rng.integers(2, 9, 3)]
    box = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 3)
    turned = Rotation.random(rng=rng).apply(box * [1.0, thickness ** rng.random(), thickness])
    # Turning rounds the points by 1e-16, which is 1e-7 of the least thickness.
    points = in_unit_cube(turned)
    assert fast_hull_volume(points) == pytest.approx(exact_hull_volume(points), rel=1e-6)


def random_parts(vertices, count, rng):
    """What lies around some vertices, of any size, turned; as the vertices of a part."""
    for _ in range(count):
        apart = np.linalg.norm(vertices - vertices[rng.integers(len(vertices))], axis=1)
        size = int(10 ** rng.uniform(1, np.log10(min(3000, len(vertices)))))
        yield Rotation.random(rng=rng).apply(vertices[np.argsort(apart)[:size]])


@pytest.mark.parametrize("name", SAMPLES)
def test_random_parts_of_the_samples(name):
    vertices = moseg.load(sample_path(name)).geometry.vertices
    for part in random_parts(vertices, 100, np.random.default_rng(0)):
        check(in_unit_cube(part))


@pytest.mark.skipif("MOSEG_PSB" not in os.environ, reason="MOSEG_PSB names no benchmark folder")
def test_random_parts_of_the_benchmark():
    paths = sorted((Path(os.environ["MOSEG_PSB"]) / "off").glob("*.off"))
    rng = np.random.default_rng(0)
    for path in rng.permutation(np.array(paths, dtype=object))[:50]:
        for part in random_parts(moseg.load(path).geometry.vertices, 10, rng):
            # Some of their points are out of a plane by less than the grid of the hulls.
            check(in_unit_cube(part), close=1e-9)


def test_qhull_answers_where_a_hull_is_thin_along_no_axis():
    rng = np.random.default_rng(0)
    points = rng.random((40, 3))
    points[:, 2] = 0.5 * (points[:, 0] + points[:, 1]) + 1e-8 * points[:, 2]
    points = (points - points.min(axis=0)) / np.ptp(points, axis=0)
    assert 0 < fast_hull_volume(points) == exact_hull_volume(points) < 1e-7


def test_points_in_a_plane_along_no_axis_have_no_volume():
    plane = np.array([[1.0, -1, 0], [0, 1, -1], [-1, 0, 1], [1, 0, -1], [0, 0, 0]]) / 2
    assert fast_hull_volume(plane) == 0


def test_reported_hulls_are_exact_and_those_of_super_elements_fast(monkeypatch):
    calls = []
    for name in ("fast_hull_volume", "exact_hull_volume"):
        function = getattr(convexity, name)

        def noted(points, name=name, function=function):
            calls.append(name)
            return function(points)

        monkeypatch.setattr(convexity, name, noted)
    shape = moseg.load(sample_path("hammer"))
    problem = moseg.Problem(["handle", "head"], "3*narrow(handle) + convex_parts")
    result = moseg.segment(
        shape, problem, restarts=1, optimizer="pattern_search(max_evaluations=9)"
    )
    assert set(calls) == {"fast_hull_volume", "exact_hull_volume"}
    assert calls[-1] == "exact_hull_volume"
    calls.clear()
    assert problem.evaluate(shape, result.labels).cost.value == result.cost
    assert calls == ["exact_hull_volume"] * 2
