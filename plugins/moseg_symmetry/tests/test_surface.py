from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_symmetry.surface import DistanceGrid, surface_of

from moseg_core import Shape, coarsen


@pytest.fixture(scope="module")
def shape(make):
    return make.shape(make.moved(make.stool(), scale=40.0))


@pytest.fixture(scope="module")
def surface(shape):
    return surface_of(shape)


def test_centroid_and_size(shape, surface):
    np.testing.assert_allclose(
        surface.center, shape.areas @ shape.points / shape.area, rtol=1e-12, atol=1e-12
    )
    reach = np.linalg.norm(shape.geometry.vertices - surface.center, axis=1).max()
    assert surface.size == pytest.approx(2 * reach, rel=1e-12)
    assert np.linalg.norm(surface.vertices, axis=1).max() == pytest.approx(0.5, rel=1e-12)


def test_a_coarse_shape_is_that_of_the_input(shape, surface):
    again = surface_of(coarsen(shape, 100))
    assert (again.vertices == surface.vertices).all()
    assert again.size == surface.size


def test_samples_lie_on_the_surface_evenly(surface):
    points = surface.samples(4000)
    np.testing.assert_allclose(surface.distances(points), 0, atol=1e-12)
    # The mean over them approaches that over the area, which is 0 for the coordinates.
    np.testing.assert_allclose(points.mean(axis=0), 0, atol=2e-3)
    assert (points == surface.samples(4000)).all()


def test_samples_of_a_square_are_uniform():
    square = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    surface = surface_of(square)
    points = surface.samples(2000) * surface.size + surface.center
    x, y, z = points.T
    np.testing.assert_allclose(z, 0, atol=1e-15)
    for values, exact in ((x, 1 / 2), (y, 1 / 2), (x**2, 1 / 3), (x * y, 1 / 4), (y**3, 1 / 4)):
        assert values.mean() == pytest.approx(exact, abs=3e-3)


def test_samples_move_with_the_shape(make):
    mesh = make.blob()
    still, gone = surface_of(make.shape(mesh)), surface_of(make.shape(make.moved(mesh, scale=7.0)))
    np.testing.assert_allclose(
        gone.samples(500), make.GENERIC.apply(still.samples(500)), atol=1e-12
    )


def test_nearest(make):
    ball = surface_of(make.shape(make.ellipsoid(1, 1, 1, rounds=4)))
    distances, triangles, feet = ball.nearest(np.array([[0.0, 0, 0], [0.9, 0, 0]]))
    np.testing.assert_allclose(distances, [0.5, 0.4], atol=2e-3)
    assert np.linalg.norm(feet[1] - [0.5, 0, 0]) < 2e-3
    assert ball.normals[triangles[1]] @ [1, 0, 0] > 0.99


def test_faces_of_no_area_are_left_out():
    box = trimesh.creation.box()
    faces = np.concatenate([box.faces, [[0, 0, 1], [2, 2, 2]]])
    surface = surface_of(Shape.from_mesh(box.vertices, faces))
    assert len(surface.triangles) == 12
    assert np.isfinite(surface.normals).all()


def test_grid_is_exact_to_half_a_diagonal_of_a_cell(surface):
    grid = DistanceGrid.of(surface)
    points = np.random.default_rng(0).uniform(-0.6, 0.6, (3000, 3))
    apart = np.abs(grid.distances(points) - surface.distances(points))
    cell = 2 * grid.reach / len(grid.values)
    assert apart.max() < 1.8 * cell
    assert apart.mean() < 0.5 * cell


def test_beyond_the_grid_is_its_edge(surface):
    grid = DistanceGrid.of(surface)
    edge = np.array([[grid.reach, 0, 0]])
    assert grid.distances(edge * 0.999) == grid.distances(edge * 5)
