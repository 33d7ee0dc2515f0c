from __future__ import annotations

import itertools

import moseg_objectives_basic.surface_distance as surface
import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.symmetry import axial_symmetric, rotational_symmetric
from scipy.spatial.transform import Rotation

from moseg_core import ExpressionError, Problem

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])
ROUND = np.radians([25, 55, 105, -25, -55, -105])


def all_multiples(n):
    return 2 * np.pi * np.arange(1, n) / n


def turned(part, points, weights, squared_distances, angles):
    """The mean surface distance to the turned surfaces about each axis, from all triangles."""
    corners = part.vertices[part.triangles] - part.centroid
    values = []
    for axis in part.axes:
        means = []
        for angle in angles:
            # The turned surface itself, and not the turned samples.
            image = corners @ Rotation.from_rotvec(angle * axis).as_matrix().T + part.centroid
            means.append(weights @ squared_distances(points, image) / weights.sum())
        values.append(np.mean(means) / diameter(part) ** 2)
    return values


def diameter(part):
    return 2 * np.linalg.norm(part.vertices - part.centroid, axis=1).max()


def revolved(profile, sections):
    """The surface that a curve in the half-plane (r, z) sweeps about the z axis."""
    mesh = trimesh.creation.revolve(np.array(profile, float), sections=sections)
    return np.array(mesh.vertices), np.array(mesh.faces)


VASE = [[0, -2], [1, -2], [0.4, 0], [0.8, 1.5], [0.6, 2.5]]
CONE = [[0, 0], [1, 0], [0, 3]]
ARC = np.linspace(0, 2 * np.pi, 25)
RING = np.stack([3 + np.cos(ARC), np.sin(ARC)], axis=1)
PLATE = [[0, 0], [2, 0], [2, 0.2], [0, 0.2]]


@pytest.mark.parametrize(
    "profile", [VASE, CONE, RING, PLATE], ids=["vase", "cone", "ring", "plate"]
)
def test_surfaces_of_revolution(make, profile):
    coarse, fine = (
        axial_symmetric(make.part(make.moved(revolved(profile, m), turn=GENERIC, shift=4.0)))
        for m in (24, 96)
    )
    # The sag falls with the square of the facets' width, its square with the fourth power.
    assert coarse < 3e-6
    assert fine < coarse / 50


def test_sphere_whatever_its_axes(make):
    for seed in range(3):
        part = make.part(make.moved(make.ball(3), turn=Rotation.random(rng=seed)))
        assert axial_symmetric(part) < 1e-6


def test_a_gutter_is_half_a_tube(make):
    vertices, faces = make.tube(1, 4, 48, caps=False)
    whole = make.part((vertices, faces))
    half = make.part((vertices, faces[:24]))
    assert axial_symmetric(whole) < 1e-6
    assert axial_symmetric(half) > 1e-3


@pytest.mark.parametrize("sides", range(3, 13))
def test_prisms_of_few_sides_are_not_round(make, sides):
    part = make.part(make.tube(1, 4, sides, caps=True))
    # In units of the polygon's own deviation from a circle, squared.
    sag = (1 - np.cos(np.pi / sides)) ** 2 / diameter(part) ** 2
    assert axial_symmetric(part) > sag / 20


@pytest.mark.parametrize("length", [0.0, 0.3, 6.0])
@pytest.mark.parametrize("sides", [3, 4, 5, 6, 8])
def test_regular_prisms(make, sides, length):
    mesh = make.tube(1, length, sides, caps=True)
    if length == 0:
        mesh = mesh[0], mesh[1][-sides:]
    part = make.part(make.moved(mesh, turn=GENERIC, shift=[3, 4, 5]))
    for n in (2, 3, 4, 5, 6, 7, 8, 12):
        value = rotational_symmetric(part, n=n)
        if sides % n == 0:
            assert value < 1e-25, n
        elif not (n == 2 and length):
            assert value > 1e-7, n


def test_half_turn_about_one_of_two_arbitrary_axes_is_missed_for_good(make):
    """A prism of three sides has them across its length, through each corner."""
    values = []
    for seed in range(8):
        turn = Rotation.random(rng=seed)
        part = make.part(make.moved(make.tube(1, 6, 3, caps=True), turn=turn))
        values.append(rotational_symmetric(part, n=2))
    np.testing.assert_allclose(values, values[0], rtol=0.05)
    assert values[0] > 1e-4


@pytest.mark.parametrize("size", [(5, 2, 2), (4, 4, 1)])
@pytest.mark.parametrize("n", [2, 3, 4, 7, 30])
def test_coincident_scales_do_not_make_the_value_arbitrary(make, size, n):
    brick = make.box(*size)
    values, round_values = [], []
    for seed in range(5):
        part = make.part(make.moved(brick, turn=Rotation.random(rng=seed), shift=seed))
        values.append(rotational_symmetric(part, n=n))
        round_values.append(axial_symmetric(part))
    # How finely it is sampled depends on its bounding box, and that on arbitrary axes.
    np.testing.assert_allclose(values, values[0], rtol=0.05, atol=1e-25)
    np.testing.assert_allclose(round_values, round_values[0], rtol=0.05)
    assert (values[0] < 1e-25) == (n in (2, 4))


def test_brick_has_half_turns_only(make):
    part = make.part(make.moved(make.box(3, 2, 1), turn=GENERIC))
    assert rotational_symmetric(part) == rotational_symmetric(part, n=2) < 1e-25
    assert rotational_symmetric(part, n=4) > 1e-3


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_symmetric_about_each_axis(make, axis):
    """A prism over a parallelogram has one half turn, about its length."""
    length = {0: 20.0, 1: 3.0, 2: 0.3}[axis]
    base = np.array([[3.0, 0.5], [1.0, 0.9], [-3.0, -0.5], [-1.0, -0.9]]) * [1, 1]
    low, high = (np.c_[base, np.full(4, z)] for z in (-length / 2, length / 2))
    # Lower at one corner, so that the two half turns across the length are lost.
    tip = np.array([[0.0, 0.0, length / 2 + 0.4 * length]])
    faces = [[3, 2, 1, 0], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    faces += [[4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]]
    mesh = np.concatenate([low, high, tip]), faces
    part = make.part(make.moved(mesh, turn=GENERIC, shift=2.0))
    along = GENERIC.apply([0, 0, 1])
    assert abs(part.axes @ along).argmax() == axis
    assert rotational_symmetric(part) < 1e-25
    samples = make.dense_samples(part.vertices[part.triangles], 2)
    values = turned(part, *samples, make.squared_distances, [np.pi])
    # About no other axis: the test would fail if that axis were left out.
    assert sorted(values)[1] > 1e-5


def test_rectangle_by_hand(make):
    """Turned by a quarter, its ends stick out of its image, each by up to (a - b) / 2."""
    a, b = 2.0, 1.5
    part = make.part(make.moved(make.rectangle(a, b), turn=GENERIC))
    quarter = 2 / a * ((a - b) / 2) ** 3 / 3 / (a**2 + b**2)
    # One of the three turns is a half, about which it is symmetric.
    assert rotational_symmetric(part, n=4) == pytest.approx(2 / 3 * quarter, rel=0.05)


def test_from_ten_on_eight_turns_stand_for_all(make):
    part = make.part(make.box(3, 2, 1))
    samples = surface.surface_samples(part)
    for n in (9, 10, 11, 24):
        every = min(turned(part, *samples, make.squared_distances, all_multiples(n)))
        assert rotational_symmetric(part, n=n) == pytest.approx(every, rel=1e-9 if n < 10 else 0.3)
    # And they do not go to nothing with the least of the angles.
    assert rotational_symmetric(part, n=10**6) > 0.5 * axial_symmetric(part)


@pytest.mark.parametrize("n", [13, 16, 30])
def test_symmetry_of_high_order_is_told_from_its_neighbours(make, n):
    part = make.part(make.tube(1, 4, n, caps=True))
    assert rotational_symmetric(part, n=n) < 1e-25
    for other in (n - 1, n + 1):
        assert rotational_symmetric(part, n=other) > 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_asymmetric_part_against_all_triangles(make, seed):
    rng = np.random.default_rng(seed)
    # A tetrahedron, and a zigzag of a few open triangles.
    for mesh in (
        (rng.random((4, 3)) * [3, 2, 1], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
        (rng.normal(size=(8, 3)) + np.arange(8)[:, None], [[k, k + 1, k + 2] for k in range(6)]),
    ):
        part = make.part(mesh)
        samples = surface.surface_samples(part)
        dense = make.dense_samples(part.vertices[part.triangles], 3)
        for found, angles in (
            (axial_symmetric(part), ROUND),
            (rotational_symmetric(part, n=3), all_multiples(3)),
            (rotational_symmetric(part, n=4), all_multiples(4)),
        ):
            own = min(turned(part, *samples, make.squared_distances, angles))
            assert found == pytest.approx(own, rel=1e-9, abs=1e-18)
            expected = min(turned(part, *dense, make.squared_distances, angles))
            assert found == pytest.approx(expected, rel=0.05, abs=5e-5)
            assert found > 1e-5


def test_symmetric_part_takes_hardly_more_than_one_axis(make, monkeypatch):
    asked = []
    original = surface.SurfaceTree._add

    def counted(self, points, weights, runs, of_run, total, limit, squared):
        mine = np.full(len(points), np.nan)
        found = original(self, points, weights, runs, of_run, total, limit, mine)
        written = np.isfinite(mine)
        squared[written] = mine[written]
        asked.append(written.sum())
        return found

    monkeypatch.setattr(surface.SurfaceTree, "_add", counted)
    part = make.part(make.tube(1, 6, 6, caps=True))
    assert rotational_symmetric(part, n=3) < 1e-25
    count = 2 * len(part.measure("basic:surface_samples")[0])
    assert count <= sum(asked) < 1.5 * count


def test_parameter_is_checked_where_it_is_written():
    for wrong in ("n=1", "n=2.5", "m=3"):
        with pytest.raises(ExpressionError, match="rotational_symmetric"):
            Problem(["a"], f"rotational_symmetric(a, {wrong})")


TERMS = ["axial_symmetric(a, b, c)"] + [f"rotational_symmetric(a, b, c, n={n})" for n in (2, 3, 12)]


@given(data=st.data())
@settings(max_examples=8, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    for term in TERMS:
        before, after = (x.values(term) for x in (original, moved))
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-10)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=4, deadline=None)
def test_tessellation_changes_next_to_nothing(data, make, seed):
    """Within what sampling misses of a square: sides of d/20 squared, thrice, over 36."""
    original = data.draw(make.shapes)
    for term in TERMS:
        before = original.values(term)
        for again in (make.quartered(original), make.punctured(original, seed)):
            np.testing.assert_allclose(again.values(term), before, rtol=0, atol=3 / 20**2 / 36)


def test_nasty_parts_stay_in_range(nasty):
    for (name, part), n in itertools.product(nasty.items(), (2, 3, 12)):
        assert 0 <= rotational_symmetric(part, n=n) <= 1, name
    for name, part in nasty.items():
        assert 0 <= axial_symmetric(part) <= 1, name
