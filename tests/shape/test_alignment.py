"""One surface laid onto another: copies that were turned, scaled, moved and meshed anew."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.files import load
from moseg_core.samples import sample_path
from moseg_core.shape.alignment import align_points, surface_samples
from moseg_core.shape.shape import Shape
from tests import shapes

#: A box with a smaller one on a corner: no rotation lays it onto itself.
UNEVEN = shapes.joined(
    shapes.box(5, 3, 2), shapes.moved(shapes.box(1, 1, 1), np.eye(3), 1.0, [0, 0, 2])
)


def sampled(mesh):
    return surface_samples(Shape.from_mesh(*mesh))


def placed(mesh, seed, scale=1.0, shift=(0.0, 0.0, 0.0)):
    turn = shapes.rotation(seed)
    turn = turn * np.sign(np.linalg.det(turn))
    return shapes.moved(mesh, turn, scale, shift), turn


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("scale", [1e-3, 40.0])
def test_a_copy_is_laid_onto_exactly_from_wherever_it_lies(seed, scale):
    copy, turn = placed(UNEVEN, seed, scale, [300 * scale, -7 * scale, 2 * scale])
    found, *others = align_points(sampled(UNEVEN), sampled(copy))
    np.testing.assert_allclose(found.rotation, turn, atol=1e-6)
    assert found.scale == pytest.approx(scale)
    assert found.distance < 1e-4
    assert not any(found.rivals(other) for other in others)
    corners = np.asarray(UNEVEN[0], float)
    np.testing.assert_allclose(found.apply(corners), copy[0], atol=1e-5 * scale)


@pytest.mark.parametrize("seed", range(3))
def test_how_it_is_meshed_does_not_matter(seed):
    copy, turn = placed(shapes.subdivided(shapes.fan(UNEVEN), seed), seed, 3.0)
    found, *_ = align_points(sampled(UNEVEN), sampled(copy))
    np.testing.assert_allclose(found.rotation, turn, atol=0.03)
    assert found.scale == pytest.approx(3.0, rel=0.01)
    assert 0.0 < found.distance < 0.02


def test_a_mirror_image_is_laid_onto_only_where_that_is_asked_for():
    mirrored = UNEVEN[0] * np.array([1.0, 1.0, -1.0]), UNEVEN[1]
    plain, *_ = align_points(sampled(UNEVEN), sampled(mirrored))
    assert np.linalg.det(plain.rotation) == pytest.approx(1.0)
    assert plain.distance > 0.01
    allowed, *_ = align_points(sampled(UNEVEN), sampled(mirrored), mirrored=True)
    assert np.linalg.det(allowed.rotation) == pytest.approx(-1.0)
    assert allowed.distance < 1e-6


@pytest.mark.parametrize(
    "mesh", [shapes.box(3, 2, 1), shapes.box(2, 2, 2), shapes.sphere(2), shapes.tube(8)]
)
def test_what_looks_alike_from_several_sides_is_said(mesh):
    copy, _ = placed(mesh, 1)
    found, *others = align_points(sampled(mesh), sampled(copy))
    assert any(found.rivals(other) for other in others)
    assert found.distance < 0.03


def test_a_shape_of_equal_moments_is_found_too():
    """A cube with a small box on a corner: its moments hardly tell its axes."""
    mesh = shapes.joined(
        shapes.box(6, 6, 6), shapes.moved(shapes.box(1, 1, 1), np.eye(3), 1.5, [0, 0, 6])
    )
    copy, turn = placed(mesh, 4, 2.0)
    found, *_ = align_points(sampled(mesh), sampled(copy))
    np.testing.assert_allclose(found.rotation, turn, atol=1e-3)


@pytest.mark.parametrize("degenerate", [np.zeros((5, 3)), np.outer(np.arange(5.0), [1, 2, 3])])
def test_a_point_and_a_line_are_no_error(degenerate):
    found, *_ = align_points(degenerate, degenerate + 1.0)
    moved = found.apply(degenerate)
    apart = np.linalg.norm(moved[:, None] - (degenerate + 1.0), axis=2)
    assert apart.min(axis=0).max() < 1e-6  # a line may lie either way
    assert found.distance < 1e-6


def test_samples_are_spread_by_area_on_the_surface():
    hammer = load(sample_path("hammer"))
    samples = surface_samples(hammer, 4000)
    assert samples.shape == (4000, 3)
    middle = hammer.areas @ hammer.points / hammer.area
    np.testing.assert_allclose(samples.mean(axis=0), middle, atol=0.01 * hammer.frame.scale)
    rectangle = surface_samples(Shape.from_mesh(*shapes.rectangle(4.0, 1.0)), 1000)
    assert np.ptp(rectangle, axis=0) == pytest.approx([4.0, 1.0, 0.0], abs=0.05)
    assert (rectangle[:, 0] < 1.0).mean() == pytest.approx(0.25, abs=0.02)


def test_points_and_cells_are_sampled():
    grid = Shape.from_voxels(np.ones((4, 3, 2), bool))
    assert np.ptp(surface_samples(grid, 500), axis=0) == pytest.approx([4, 3, 2], abs=0.1)
    cloud = Shape.from_points(np.random.default_rng(0).normal(size=(50, 3)))
    assert surface_samples(cloud, 80).shape == (80, 3)
