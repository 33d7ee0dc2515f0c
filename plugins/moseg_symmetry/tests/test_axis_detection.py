from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_symmetry.axis_detection import detect_axes
from moseg_symmetry.plane_detection import detect_planes, require_plane
from scipy.spatial.transform import Rotation


def along(make, axes, direction):
    return [axis for axis in axes if make.angle_between(axis.direction, direction) < 1e-3]


@pytest.mark.parametrize("sides", [3, 5, 6])
def test_prisms(make, sides):
    shape = make.shape(make.moved(make.prism(sides), scale=20.0))
    axes = detect_axes(shape)
    upright = make.GENERIC.apply([0, 0, 1])
    (first,) = along(make, axes, upright)
    assert first is axes[0]
    assert first.fold == sides
    assert first.residual < 1e-6
    assert first.share == 1.0
    off = first.point - make.SHIFT
    assert np.linalg.norm(off - (off @ upright) * upright) < 1e-6 * shape.frame.scale
    # And half a turn about each of the axes across it.
    others = [axis for axis in axes if axis is not first]
    assert [axis.fold for axis in others] == [2] * sides
    for axis in others:
        assert abs(axis.direction @ upright) < 1e-6


def test_pyramid_has_one_axis(make):
    cone = trimesh.creation.cone(radius=1, height=2, sections=7)
    (axis,) = detect_axes(make.shape(make.moved(cone)))
    assert axis.fold == 7
    assert make.angle_between(axis.direction, make.GENERIC.apply([0, 0, 1])) < 1e-6


def test_propeller_turns_but_has_no_mirror(make):
    """Three tilted blades: no plane of symmetry, but an axis of 3."""
    blades = []
    for k in range(3):
        blade = trimesh.creation.box(extents=(0.05, 0.6, 2.0))
        blade = make.moved(blade, turn=Rotation.from_rotvec([0, 0, 0.6]), shift=[0, 0, 1.3])
        blades.append(
            make.moved(blade, turn=Rotation.from_rotvec([0, 2 * np.pi * k / 3, 0]), shift=0)
        )
    shape = make.shape(make.moved(trimesh.util.concatenate(blades)))
    assert not any(plane.holds for plane in detect_planes(shape))
    best = detect_axes(shape)[0]
    assert best.fold == 3
    assert make.angle_between(best.direction, make.GENERIC.apply([0, 1, 0])) < 1e-5


@pytest.mark.parametrize("kind", ["can", "cone", "ring"])
def test_surfaces_of_revolution(make, kind):
    mesh = {
        "can": make.prism(64),
        "cone": trimesh.creation.cone(radius=1, height=2, sections=64),
        "ring": trimesh.creation.torus(1.0, 0.3, major_sections=64, minor_sections=32),
    }[kind]
    axes = detect_axes(make.shape(make.moved(mesh)))
    round_ones = [axis for axis in axes if axis.fold is None]
    assert round_ones == along(make, axes, make.GENERIC.apply([0, 0, 1])) == axes[:1]
    assert axes[0].residual < 1e-3


def test_twelve_sides_are_not_round(make):
    assert detect_axes(make.shape(make.prism(12)))[0].fold == 12


def test_ball(make):
    axes = detect_axes(make.shape(make.ellipsoid(1, 1, 1)))
    assert len(axes) > 1
    assert {axis.fold for axis in axes} == {None}


def test_cube(make):
    folds = [axis.fold for axis in detect_axes(make.shape(make.moved(trimesh.creation.box())))]
    assert folds == [4] * 3 + [3] * 4 + [2] * 6


def test_none(make):
    assert detect_axes(make.shape(make.blob())) == []
    # A plane, but no axis: a pyramid over a triangle with two equal sides.
    wedge = trimesh.creation.cone(radius=1, height=2, sections=3)
    vertices = wedge.vertices * [1.0, 0.5, 1.5] + np.outer(wedge.vertices[:, 2], [0.5, 0, 0])
    shape = make.shape(trimesh.Trimesh(vertices, wedge.faces, process=False))
    assert detect_axes(shape) == []
    assert require_plane(shape).residual < 1e-9
