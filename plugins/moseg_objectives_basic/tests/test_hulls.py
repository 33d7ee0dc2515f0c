"""Hulls by manifold3d against Qhull, and against a certificate that knows neither."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold
from moseg_objectives_basic import convexity, hulls
from moseg_objectives_basic.hulls import exact_hull_volume, fast_hull_volume, moved_apart
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core.samples import SAMPLES, sample_path
from moseg_core.testing.fixtures.shapes import ZOO, specimen

#: What may be wrong of a hull while searching, as a share of its volume.
CLOSE = 1e-7


def in_unit_cube(points):
    """Points along their principal axes, stretched to a cube, as parts are measured."""
    local = points - points.mean(axis=0)
    local = local @ np.linalg.svd(local, full_matrices=False)[2].T
    return local / np.ptp(local, axis=0)


def missing_volume(vertices, triangles, points):
    """How much a closed surface, oriented outward, leaves out of the hull of some points, about.

    For every facet the greatest tetrahedron that it has with a point in front of it; no point is
    in front of any facet of a convex hull, while what folds over has all others in front of it.
    """
    total = 0.0
    for a, b, c in vertices[triangles]:
        normal = np.cross(b - a, c - a)
        total += max(0.0, float(((points - a) @ normal).max())) / 6
    return total


def check(points, *, certified=False):
    found = fast_hull_volume(points)
    assert found == pytest.approx(exact_hull_volume(points), rel=CLOSE)
    if certified:
        moved = moved_apart(points)
        mesh = Manifold.hull_points(moved).to_mesh64()
        vertices = mesh.vert_properties[:, :3]
        assert missing_volume(vertices, mesh.tri_verts, moved) <= CLOSE * found


def test_the_certificate_knows_a_hull_from_what_is_none():
    ball = trimesh.creation.icosphere(subdivisions=1)
    vertices, faces = np.array(ball.vertices), np.array(ball.faces)
    assert missing_volume(vertices, faces, vertices) < 1e-15
    dented = vertices.copy()
    dented[3] *= 0.7
    assert missing_volume(dented, faces, vertices) > 0.01
    assert missing_volume(dented, faces, dented) > 0.001  # no longer convex
    folded = vertices.copy()
    folded[3] = -vertices[3]
    assert missing_volume(folded, faces, folded) > 0.1
    assert missing_volume(vertices, faces[1:], 1.01 * vertices) > 0.001


@pytest.mark.parametrize("name", ZOO)
def test_parts_of_the_zoo(name):
    geometry, rng = specimen(name).geometry, np.random.default_rng(0)
    vertices = geometry.vertices[np.unique(geometry.corners)]
    for _ in range(10):
        points = vertices[rng.random(len(vertices)) < 0.7]
        points = Rotation.random(rng=rng).apply(points)
        if len(points) < 4 or np.linalg.matrix_rank(points - points.mean(axis=0), tol=1e-9) < 3:
            continue
        check(in_unit_cube(points), certified=True)


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
    # Without moving the points, many of these come out far too small.
    solid = SOLIDS[name].copy()
    for _ in range(1 + seed % 4):
        solid = solid.subdivide()
    points = Rotation.random(rng=seed).apply(solid.vertices)
    check(points / np.ptp(points, axis=0), certified=len(points) < 1000)
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
    for number, part in enumerate(random_parts(vertices, 100, np.random.default_rng(0))):
        check(in_unit_cube(part), certified=number % 10 == 0)


@pytest.mark.skipif("MOSEG_PSB" not in os.environ, reason="MOSEG_PSB names no benchmark folder")
def test_random_parts_of_the_benchmark():
    paths = sorted((Path(os.environ["MOSEG_PSB"]) / "off").glob("*.off"))
    rng = np.random.default_rng(0)
    for path in rng.permutation(np.array(paths, dtype=object))[:50]:
        for part in random_parts(moseg.load(path).geometry.vertices, 10, rng):
            check(in_unit_cube(part))


def test_qhull_answers_where_manifold3d_cannot(monkeypatch):
    points = in_unit_cube(np.random.default_rng(0).normal(size=(40, 3)))
    assert fast_hull_volume(points) != exact_hull_volume(points)
    for broken in (Manifold(), Manifold.hull_points(points * np.nan)):
        known = SimpleNamespace(hull_points=lambda points, broken=broken: broken)
        monkeypatch.setattr(hulls, "Manifold", known)
        assert fast_hull_volume(points) == exact_hull_volume(points) > 0.1


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
