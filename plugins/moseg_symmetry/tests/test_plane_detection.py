from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_symmetry.motions import Reflection
from moseg_symmetry.plane_detection import (
    NEAR,
    PlaneSymmetry,
    detect_planes,
    half_sphere,
    preferred,
    reflections,
    require_plane,
)
from moseg_symmetry.planes import Plane
from moseg_symmetry.refine import residual
from moseg_symmetry.surface import surface_of
from scipy.spatial.transform import Rotation

from moseg_core import ShapeError


def holding(shape):
    return [found for found in detect_planes(shape) if found.holds]


def normals(found):
    return [symmetry.plane.normal for symmetry in found]


def assert_directions(make, found, expected, tolerance=1e-3):
    """Each expected direction once, and no other."""
    assert len(found) == len(expected)
    for direction in expected:
        assert min(make.angle_between(direction, other) for other in found) < tolerance


@pytest.mark.parametrize("turn", [Rotation.identity(), Rotation.from_rotvec([0.4, -0.9, 0.55])])
@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_box_and_ellipsoid(make, turn, scale):
    for mesh in (trimesh.creation.box(extents=(4, 2, 1)), make.ellipsoid(3, 2, 1)):
        shape = make.shape(make.moved(mesh, turn=turn, scale=scale))
        found = holding(shape)
        assert_directions(make, normals(found), turn.as_matrix().T)
        for symmetry in found:
            middle = symmetry.plane.heights(make.SHIFT)
            assert abs(middle) < 1e-3 * shape.frame.scale
            assert symmetry.residual < 1e-4
            assert symmetry.share == 1.0
        # The halves of the first are furthest apart.
        assert make.angle_between(found[0].plane.normal, turn.as_matrix()[:, 0]) < 1e-3


def test_planes_of_a_cube(make):
    found = holding(make.shape(trimesh.creation.box()))
    faces = np.eye(3)
    edges = [np.roll([0, 1, sign], k) for k in range(3) for sign in (1, -1)]
    assert_directions(make, normals(found), [*faces, *edges], 1e-6)
    # Alike in all, so that the axes of the file decide.
    assert found[0].plane.normal.tolist() == pytest.approx([1, 0, 0], abs=1e-9)


@pytest.mark.parametrize("sides", [3, 5, 6])
def test_planes_of_a_prism(make, sides):
    found = holding(make.shape(make.moved(make.prism(sides))))
    corners = 2 * np.pi * np.arange(sides) / sides + (np.pi / 2 if sides % 2 else 0.0)
    upright = [[np.cos(a), np.sin(a), 0] for a in corners]
    if sides == 6:
        upright = [[np.cos(a), np.sin(a), 0] for a in np.pi * np.arange(6) / 6]
    expected = make.GENERIC.apply([[0, 0, 1], *upright])
    assert_directions(make, normals(found), expected)


def test_every_plane_through_an_axis_of_revolution(make):
    can = make.shape(make.moved(make.prism(64)))
    axis = make.GENERIC.apply([0, 0, 1])
    found = holding(can)
    across = [p for p in found if make.angle_between(p.plane.normal, axis) < 1e-3]
    assert len(across) == 1
    others = [p for p in found if p not in across]
    assert len(others) >= 4
    for symmetry in others:
        assert abs(symmetry.plane.normal @ axis) < 1e-3
        assert abs(symmetry.plane.heights(make.SHIFT)) < 1e-3


def test_ball(make):
    found = holding(make.shape(make.moved(make.ellipsoid(1, 1, 1))))
    assert len(found) >= 5
    for symmetry in found:
        assert abs(symmetry.plane.heights(make.SHIFT)) < 3e-3


@pytest.mark.parametrize("kick", [0.3, 0.7, -0.5])
def test_one_leg_moved(make, kick):
    shape = make.shape(make.moved(make.stool(kick=kick)))
    found = require_plane(shape)
    assert make.angle_between(found.plane.normal, make.GENERIC.apply([1, 0, 0])) < 3e-3
    assert abs(found.plane.heights(make.SHIFT)) < 3e-3 * shape.frame.scale
    assert 0.75 < found.share < 1.0
    # The centroid is off the plane, so that planes through it would not do.
    still = require_plane(make.shape(make.stool()))
    assert still.share == 1.0
    assert still.residual < 1e-6 < found.residual


@pytest.mark.parametrize("seed", [0, 1])
def test_without_symmetry(make, seed):
    shape = make.shape(make.blob(seed), name="potato")
    assert not holding(shape)
    with pytest.raises(ShapeError, match="'potato' has no plane of symmetry") as error:
        require_plane(shape)
    best = max(detect_planes(shape), key=lambda found: found.share)
    message = str(error.value)
    assert f"maps only {100 * best.share:.0f} % of the surface" in message
    assert str(best.plane) in message


def test_moves_with_the_shape(make):
    mesh = make.stool(kick=0.5)
    still = require_plane(make.shape(mesh))
    for turn in (make.GENERIC, Rotation.from_rotvec([2.0, 1.0, -0.3])):
        moved = require_plane(make.shape(make.moved(mesh, turn=turn, scale=50.0)))
        assert make.angle_between(moved.plane.normal, turn.apply(still.plane.normal)) < 3e-4
        point = turn.apply(still.plane.point) * 50.0 + make.SHIFT
        assert abs(moved.plane.heights(point)) < 3e-4 * 50.0
        assert moved.residual == pytest.approx(still.residual, rel=1e-3)
        assert moved.share == pytest.approx(still.share, abs=1e-3)


def test_the_same_each_time(make):
    shape = make.shape(make.stool(kick=0.5))
    first, again = detect_planes(shape), detect_planes(shape)
    assert [str(p.plane) for p in first] == [str(p.plane) for p in again]
    assert [p.residual for p in first] == [p.residual for p in again]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["stool", "blob", "box"])
def test_no_plane_of_a_fine_grid_is_better(make, name):
    """Against every plane of a dense grid of directions and offsets, distances by brute force."""
    mesh = {
        "stool": make.stool(kick=0.6),
        "blob": make.blob(),
        "box": trimesh.creation.box(extents=(4, 2, 1)),
    }[name]
    surface = surface_of(make.shape(make.moved(mesh)))
    points = surface.samples(120)
    best = reflections(surface)[0]
    least = min(
        residual(surface, Reflection(normal, offset), points)
        for normal in half_sphere(900)
        for offset in np.linspace(-0.1, 0.1, 9)
    )
    assert residual(surface, best, points) <= least


def test_share_and_residual_by_hand(make):
    """A plate of 8 x 8 with a wing of 1 x 8 on one side of the plane, far from the other side."""
    rectangles = [(-4, 4), (6, 7)]
    corners = [[[x, y, 0] for x, y in ((a, 0), (b, 0), (b, 8), (a, 8))] for a, b in rectangles]
    mesh = trimesh.Trimesh(
        np.concatenate(corners), [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]], process=False
    )
    shape = make.shape(mesh)
    found = next(
        p for p in detect_planes(shape) if make.angle_between(p.plane.normal, [1, 0, 0]) < 0.02
    )
    size = surface_of(shape).size
    assert abs(found.plane.point[0]) < NEAR * size
    assert found.share == pytest.approx(8 / 9, abs=0.03)
    # The wing's images are 2 to 3 units off: each counts as nearly 2 %.
    assert found.residual == pytest.approx(0.02 * np.sqrt(1 / 9), rel=0.05)


def test_preference():
    def candidate(normal, residual=0.0001, spread=0.2):
        plane = Plane.through([0, 0, 0], normal)
        return PlaneSymmetry(plane=plane, residual=residual, share=1.0, spread=spread)

    x, y, z = (candidate(axis) for axis in np.eye(3))
    assert preferred([z, y, x]) is x
    assert preferred([z, y]) is y
    wide = candidate([0, 0, 1], spread=0.21)
    assert preferred([x, wide, y]) is wide
    good = candidate([0, 1, 1], residual=0.0, spread=0.1)
    assert preferred([x, good]) is x  # hardly better
    poor = candidate([1, 0, 0], residual=0.003, spread=0.4)
    assert preferred([poor, good, y]) is y


def test_half_sphere_is_covered_evenly():
    directions = half_sphere(500)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, atol=1e-15)
    assert (directions[:, 2] > 0).all()
    away = np.random.default_rng(0).normal(size=(2000, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    nearest = np.abs(away @ directions.T).max(axis=1)
    # Discs of this radius cover 1.6 times the half sphere's area: no hole is much larger.
    assert np.degrees(np.arccos(nearest.min())) < 5.8
