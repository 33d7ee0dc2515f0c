"""Moments of points and cells against sums by hand; those of polygons are in test_shape."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.segmentation import Segmentation
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.moments import element_moments
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import VoxelGrid

PAIRS = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]


def scales_of(shape):
    return Segmentation.from_labels(shape, np.zeros(shape.n_elements, int), 1).parts[0].scales


@given(seed=st.integers(0, 99))
def test_points_are_where_they_are(seed):
    rng = np.random.default_rng(seed)
    points, areas, origin = rng.normal(size=(7, 3)), rng.random(7), rng.normal(size=3)
    moments = element_moments(PointCloud.from_points(points, areas=areas), origin)
    np.testing.assert_array_equal(moments.points, points)
    np.testing.assert_array_equal(moments.areas, areas)
    for f, (x, a) in enumerate(zip(points - origin, areas, strict=True)):
        np.testing.assert_allclose(moments.first[f], a * x)
        np.testing.assert_allclose(moments.second[f], [a * x[i] * x[j] for i, j in PAIRS])


@given(seed=st.integers(0, 99))
def test_cells_are_cubes(seed):
    rng = np.random.default_rng(seed)
    occupied = rng.random((3, 2, 3)) < 0.5
    occupied[0, 0, 0] = True
    pitch, origin = 0.1 + rng.random(), rng.normal(size=3)
    grid = VoxelGrid.from_occupied(occupied, pitch=pitch, origin=rng.normal(size=3))
    moments = element_moments(grid, origin)
    # Gauss points of two per axis integrate squares exactly.
    gauss = (np.array(list(np.ndindex(2, 2, 2))) * 2 - 1) / np.sqrt(12)
    for f, center in enumerate(grid.centers - origin):
        x = center + pitch * gauss
        np.testing.assert_allclose(moments.areas[f], pitch**3)
        np.testing.assert_allclose(moments.first[f], pitch**3 * x.mean(axis=0), atol=1e-12)
        second = [pitch**3 * (x[:, i] * x[:, j]).mean() for i, j in PAIRS]
        np.testing.assert_allclose(moments.second[f], second, atol=1e-12)


@given(seed=st.integers(0, 99))
def test_cells_may_be_oblique(seed):
    rng = np.random.default_rng(seed)
    occupied = rng.random((3, 2, 3)) < 0.5
    occupied[0, 0, 0] = True
    steps, origin = np.eye(3) + 0.3 * rng.normal(size=(3, 3)), rng.normal(size=3)
    grid = VoxelGrid.from_occupied(occupied, pitch=steps, origin=rng.normal(size=3))
    moments = element_moments(grid, origin)
    gauss = (np.array(list(np.ndindex(2, 2, 2))) * 2 - 1) / np.sqrt(12)
    volume = abs(np.linalg.det(steps))
    for f, center in enumerate(grid.centers - origin):
        x = center + gauss @ steps
        np.testing.assert_allclose(moments.areas[f], volume)
        np.testing.assert_allclose(moments.first[f], volume * x.mean(axis=0), atol=1e-12)
        second = [volume * (x[:, i] * x[:, j]).mean() for i, j in PAIRS]
        np.testing.assert_allclose(moments.second[f], second, atol=1e-12)


@pytest.mark.parametrize("elements", ["solid", "surface"])
def test_a_box_of_flat_cells_measures_as_the_box(elements):
    box = Shape.from_voxels(
        np.ones((4, 6, 2), bool), pitch=(0.5, 0.25, 3.0), origin=(1, 2, 3), elements=elements
    )
    sides = np.array([2.0, 1.5, 6.0])
    assert box.volume == pytest.approx(sides.prod())
    np.testing.assert_allclose(box.centroid, [1, 2, 3] + sides / 2)
    x, y, z = sides
    if elements == "solid":
        np.testing.assert_allclose(scales_of(box), np.array([6.0, 2.0, 1.5]) / np.sqrt(12))
    else:
        assert box.area == pytest.approx(2 * (x * y + y * z + z * x))


def test_a_solid_block_has_the_scales_of_a_block():
    block = Shape.from_voxels(np.ones((6, 4, 2), bool), pitch=0.5)
    np.testing.assert_allclose(scales_of(block), np.array([3, 2, 1]) / np.sqrt(12))


def test_the_surface_of_a_block_has_those_of_its_sides(box):
    surface = Shape.from_voxels(np.ones((3, 2, 1), bool), elements="surface")
    assert surface.area == pytest.approx(box.area)
    np.testing.assert_allclose(scales_of(surface), scales_of(box))


@pytest.mark.parametrize("n", [500, 4000])
def test_scales_of_a_cloud_are_near_those_of_the_surface(n):
    rng = np.random.default_rng(n)
    points = rng.random((n, 3)) * [4, 2, 0]
    found, exact = scales_of(Shape.from_points(points)), np.array([4, 2, 0]) / np.sqrt(12)
    np.testing.assert_allclose(found, exact, rtol=0.1, atol=1e-9)
