"""Concavity against closed forms, the smoothing against a dense solution."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.fields import concavity as module
from moseg_objectives_basic.fields.concavity import concavity, uncreased
from scipy.spatial.transform import Rotation

from moseg_core import Shape, coarsen, field_values


def fine(vertices, faces, edge):
    triangles = Shape.from_mesh(vertices, faces).geometry.triangles
    return Shape.from_mesh(*trimesh.remesh.subdivide_to_size(np.array(vertices), triangles, edge))


def notched(angle, edge):
    """A closed prism with a notch in which its surface turns by an angle, and how far from there.

    The walls of the notch are 5 long and meet in the line x = y = 0; it is 6 deep.
    """
    c, s = 5 * np.cos(angle / 2), 5 * np.sin(angle / 2)
    outline = [(-c, s), (0, 0), (c, s), (c + 1, s), (c + 1, -2), (-c - 1, -2), (-c - 1, s)][::-1]
    n = len(outline)
    vertices = [(x, y, z) for z in (-3, 3) for x, y in outline]
    sides = [[k, (k + 1) % n, (k + 1) % n + n, k + n] for k in range(n)]
    shape = fine(vertices, [*sides, list(range(n))[::-1], list(range(n, 2 * n))], edge)
    along = np.linalg.norm(shape.points[:, :2], axis=1)
    return shape, np.where(np.abs(shape.points[:, 2]) < 2, along, np.inf)


@pytest.mark.parametrize("rounds", [3, 4])
def test_a_ball(make, rounds):
    shape = Shape.from_mesh(*make.ball(rounds))
    assert concavity(shape) == pytest.approx(-2 * 0.02 * shape.box_diagonal, rel=0.1)
    # Seen from inside it is a cavity, but the outside is found.
    vertices, faces = make.ball(rounds)
    inside_out = Shape.from_mesh(vertices, faces[:, ::-1])
    assert concavity(inside_out) == pytest.approx(concavity(shape), rel=1e-3)


def test_a_cylinder_is_not_concave_nor_are_its_rims():
    mesh = trimesh.creation.cylinder(0.5, 4, sections=48)
    shape = fine(mesh.vertices, mesh.faces, 0.25)
    inner = np.abs(shape.points[:, 2]) < 1.5
    assert np.abs(concavity(shape)[inner]).max() < 0.03
    assert concavity(shape).max() < 0.05


@pytest.mark.parametrize("degrees", [30, 60, 90, 120])
def test_a_crease_of_two_planes(degrees):
    angle = np.deg2rad(degrees)
    shape, away = notched(angle, 0.3)
    radius = 0.06
    reach = radius * shape.box_diagonal
    values = concavity(shape, radius=radius)
    expected = 2 * np.sin(angle / 2)
    assert values[away < 0.2].mean() == pytest.approx(expected, rel=0.2)
    # It falls by exp(-x / r) to both sides, and somewhat faster as the surface turns away.
    middle = (away > 0.9 * reach) & (away < 1.1 * reach)
    assert 0.5 < values[middle].mean() / (expected * np.exp(-1)) < 1.2
    assert values[away < 3].max() < 1.25 * expected


def test_two_overlapping_balls_are_concave_where_they_meet(make):
    """Where the profile of one turns into that of the other, by 2 arccos(d / 2 R)."""
    vertices, faces = make.ball(5)
    left = vertices * 1.0
    left[:, 0] = np.minimum(left[:, 0], 0.5)
    kept = faces[(left[faces][:, :, 0] < 0.5).any(axis=1)]
    right = left * [-1, 1, 1] + [1.0, 0, 0]
    shape = Shape.from_mesh(
        np.concatenate([left, right]), np.concatenate([kept, kept[:, ::-1] + len(left)])
    )
    values = concavity(shape)
    seam = np.abs(shape.points[:, 0] - 0.5) < 0.02
    assert values[seam].mean() > 0.6
    assert values[np.abs(shape.points[:, 0] - 0.5) > 0.5].max() < -0.05


def test_motion_size_and_reflection_change_nothing(make):
    vertices, faces = make.ball(3)
    vertices = vertices * [3, 2, 1] + 0.2 * np.sin(4 * vertices[:, [1, 2, 0]])
    before = concavity(Shape.from_mesh(vertices, faces))
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7])
    moved = make.moved((vertices, faces), turn=turn, scale=30, shift=[40, 50, 60])
    assert concavity(Shape.from_mesh(*moved)) == pytest.approx(before, abs=1e-9)
    mirrored = Shape.from_mesh(vertices * [1, -1, 1], faces[:, ::-1])
    assert concavity(mirrored) == pytest.approx(before, abs=1e-9)


def test_normals_are_smoothed_as_the_equation_says(make):
    """Against the dense matrices by the book."""
    shape = Shape.from_mesh(*make.moved(make.ball(1), scale=2))
    normals = np.random.default_rng(0).normal(size=(shape.n_elements, 3))
    links, reach = shape.links, 0.3
    weights = np.random.default_rng(1).random(len(links.first))
    laplacian = np.zeros((shape.n_elements, shape.n_elements))
    for i, j, w in zip(links.first, links.second, weights, strict=True):
        laplacian[i, i] += w
        laplacian[j, j] += w
        laplacian[i, j] -= w
        laplacian[j, i] -= w
    areas = np.diag(shape.areas)
    expected = np.linalg.solve(areas + reach**2 * laplacian, areas @ normals)
    found = module._smoothed(shape, normals, weights, reach)
    assert found == pytest.approx(expected)


def test_slivers_and_faces_without_area_stay_in_range(make):
    vertices, faces = make.ball(2)
    pleated = [*faces.tolist(), [0, 0, 1], [5, 6, 6]]
    rng = np.random.default_rng(2)
    needles = vertices * [1, 1e-5, 1] + 1e-7 * rng.normal(size=vertices.shape)
    for where in (vertices, needles):
        values = concavity(Shape.from_mesh(where, pleated))
        assert np.isfinite(values).all()
        assert (np.abs(values) <= 2).all()


def test_polygons_of_more_corners(make):
    vertices, faces = make.disc(8, 32)
    assert concavity(Shape.from_mesh(vertices, faces)) == pytest.approx(0, abs=1e-9)


def test_a_large_surface_is_looked_at_in_groups(monkeypatch):
    shape, away = notched(np.pi / 2, 0.25)
    exact = concavity(shape)
    monkeypatch.setattr(module, "_LARGE", 100)
    monkeypatch.setattr(module, "_MOST", shape.n_elements // 3)
    grouped = concavity(shape)
    members = coarsen(shape, shape.n_elements // 3).members
    for group in (0, 7, members.max()):
        assert len(np.unique(grouped[members == group])) == 1
    # Groups in the crease reach a little out of it.
    crease = away < 0.15
    assert 0.75 * exact[crease].mean() < grouped[crease].mean() < exact[crease].mean()
    assert np.corrcoef(exact, grouped)[0, 1] > 0.9
    assert np.abs(exact - grouped).mean() < 0.03


def test_uncreased_is_a_weight_from_0_to_1():
    shape, away = notched(np.pi / 2, 0.3)
    found, c = uncreased(shape, radius=0.06), field_values(shape, "basic:concavity", radius=0.06)
    assert found == pytest.approx((np.clip(1 - c, 0.15, 1.5) - 0.15) / 1.35)
    assert found[away < 0.2] == pytest.approx(0, abs=0.02)
    assert found.min() == 0
    assert found.max() <= 1
