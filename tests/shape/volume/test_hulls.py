"""The volume of convex pieces: exact for convex shapes, near the truth for others."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from moseg_core.io import load
from moseg_core.samples import sample_path
from moseg_core.shape.shape import Shape
from moseg_core.shape.volume.hulls import hulls_volume
from tests import shapes


@pytest.mark.parametrize("mesh", [shapes.cube(), shapes.sphere(3), shapes.prism(12)])
def test_a_convex_mesh_is_not_cut(mesh):
    volume, pieces = hulls_volume(Shape.from_mesh(*mesh).geometry)
    assert pieces == 1
    assert volume == pytest.approx(ConvexHull(mesh[0]).volume)


@pytest.mark.parametrize("n", [300, 3000, 20_000])
def test_a_convex_cloud_is_not_cut(n):
    points = np.random.default_rng(n).normal(size=(n, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    volume, pieces = hulls_volume(Shape.from_points(points).geometry)
    assert pieces == 1
    assert volume == pytest.approx(ConvexHull(points).volume, rel=1e-9)


def test_a_tee_is_cut_where_its_stem_begins():
    mesh = shapes.tee(6, 5)  # 11 cubes, in a hull of more than 20
    shape = Shape.from_mesh(*mesh)
    assert ConvexHull(mesh[0]).volume > 2 * shape.volume - 1
    volume, pieces = hulls_volume(shape.geometry)
    assert pieces > 1
    assert 0.97 * shape.volume < volume < 1.25 * shape.volume


@pytest.mark.parametrize(("name", "excess"), [("hammer", 0.1), ("horse", 0.35)])
@pytest.mark.parametrize("n", [None, 2000, 8000])
def test_the_samples_come_out_a_little_too_large(name, excess, n):
    shape = load(sample_path(name))
    geometry = shape.geometry
    if n is not None:
        mesh = trimesh.Trimesh(geometry.vertices, geometry.triangles, process=False)
        geometry = Shape.from_points(trimesh.sample.sample_surface(mesh, n, seed=3)[0]).geometry
    volume, _ = hulls_volume(geometry)
    assert 0.97 < volume / shape.volume < 1 + excess
    assert ConvexHull(geometry.vertices).volume > 2.5 * shape.volume


def test_units_and_place_do_not_matter():
    vertices, faces = shapes.tee()
    volume, pieces = hulls_volume(Shape.from_mesh(vertices, faces).geometry)
    moved, _ = shapes.moved((vertices, faces), np.eye(3), 1e-6, (7e-5, 0, 3e-5))
    found, same = hulls_volume(Shape.from_mesh(moved, faces).geometry)
    assert same == pieces
    assert found == pytest.approx(1e-18 * volume, rel=0.02)
