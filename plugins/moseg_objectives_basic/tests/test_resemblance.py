from __future__ import annotations

import math

import moseg_objectives_basic.surface_distance as surface
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.ellipsoid import ellipsoidal
from moseg_objectives_basic.symmetry import planar_symmetric
from scipy import integrate
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])
SCALENE = np.array([[0.0, 0.0], [6.0, 0.0], [1.0, 2.0]])


def prism(length):
    """A prism over a triangle without symmetry; its one plane of symmetry is z = 0."""
    low, high = (np.c_[SCALENE, np.full(3, z)] for z in (-length / 2, length / 2))
    sides = [[0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
    return np.concatenate([low, high]), [[2, 1, 0], [3, 4, 5], *sides]


def reflections(part, points, weights, squared_distances):
    """The surface distance to each of the three reflected parts, from all triangles."""
    corners = part.vertices[part.triangles]
    values = []
    for axis in part.axes:
        mirror = np.eye(3) - 2 * np.outer(axis, axis)
        # The reflected surface itself, and not the reflected samples.
        image = (corners - part.centroid) @ mirror + part.centroid
        squared = squared_distances(points, image)
        values.append(weights @ squared / weights.sum() / part.box_diagonal**2)
    return values


@pytest.mark.parametrize(("length", "axis"), [(20.0, 0), (3.5, 1), (0.3, 2)])
@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
def test_symmetric_across_each_axis(make, length, axis, turn):
    part = make.part(make.moved(prism(length), turn=turn, shift=[3, 4, 5]))
    across = turn.apply([0, 0, 1])
    assert abs(part.axes @ across).argmax() == axis
    assert planar_symmetric(part) < 1e-25
    samples = make.dense_samples(part.vertices[part.triangles], 3)
    values = reflections(part, *samples, make.squared_distances)
    assert values[axis] < 1e-25
    # Across no other axis: the test would fail if that axis were left out.
    assert sorted(values)[1] > 1e-5


@pytest.mark.parametrize("seed", range(4))
def test_asymmetric_part_against_all_triangles(make, seed):
    rng = np.random.default_rng(seed)
    # A tetrahedron, and a zigzag of a few open triangles.
    for mesh in (
        (rng.random((4, 3)) * [3, 2, 1], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
        (rng.normal(size=(8, 3)) + np.arange(8)[:, None], [[k, k + 1, k + 2] for k in range(6)]),
    ):
        part = make.part(mesh)
        found = planar_symmetric(part)
        own = reflections(part, *surface.surface_samples(part), make.squared_distances)
        assert found == pytest.approx(min(own), rel=1e-9, abs=1e-18)
        dense = make.dense_samples(part.vertices[part.triangles], 4)
        expected = min(reflections(part, *dense, make.squared_distances))
        assert found == pytest.approx(expected, rel=0.05, abs=2e-5)
        assert found > 1e-5


@given(data=st.data())
@settings(max_examples=12, deadline=None)
def test_what_is_left_out_does_not_matter(data, make):
    """The least of three full sums, to the last bit."""
    for part in data.draw(make.shapes).segmentation().parts:
        points, weights = surface.surface_samples(part)
        tree = surface.surface_tree(part)
        full = []
        for axis in part.axes:
            across = (points - part.centroid) @ axis
            squared = tree.squared_distances(points - 2 * across[:, None] * axis)
            full.append(surface.normalized_mean(part, squared, weights))
        assert planar_symmetric(part) == pytest.approx(min(full), rel=1e-12)


@pytest.mark.parametrize("length", [20.0, 0.3])
def test_symmetric_part_takes_hardly_more_than_one_axis(make, monkeypatch, length):
    asked = []
    original = surface.SurfaceTree.squared_distances

    def counted(self, points):
        asked.append(len(points))
        return original(self, points)

    monkeypatch.setattr(surface.SurfaceTree, "squared_distances", counted)
    part = make.part(prism(length))
    assert planar_symmetric(part) < 1e-25
    count = len(part.measure("basic:surface_samples")[0])
    assert count <= sum(asked) < 1.5 * count


@pytest.mark.parametrize("rounds", [1, 2, 3, 4])
def test_refined_sphere_is_ellipsoidal(make, rounds):
    coarse, fine = (ellipsoidal(make.part(make.ball(rounds + k))) for k in (0, 1))
    # The sag of a facet falls with the square of its size, the square of that with its fourth
    # power; a little less where the coarser facets are sampled more than once.
    assert 0 < fine < coarse / 4
    if rounds == 4:
        assert fine < 1e-8


def test_radii_of_a_three_to_one_ellipsoid(make):
    vertices, faces = make.ball(5)
    part = make.part((vertices * [3, 1, 1], faces))
    along, across, other = np.sqrt(3) * part.scales
    assert along / 3 == pytest.approx(0.8976, abs=1e-3)  # 10 % short
    assert across == pytest.approx(1.0475, abs=1e-3)  # 5 % long
    assert other == pytest.approx(across, rel=1e-5)
    assert 1e-5 < ellipsoidal(part) < 1e-3


@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
def test_disc_against_its_ellipse(make, turn):
    part = make.part(make.moved(make.disc(40, 90), turn=turn, shift=7.0))
    # Both scales are half the radius; beyond the smaller disc the distance is radial.
    radius = math.sqrt(3) / 2
    beyond = integrate.quad(lambda r: (r - radius) ** 2 * 2 * r, radius, 1)[0]
    assert ellipsoidal(part) == pytest.approx(beyond / 8, rel=0.02)


@given(data=st.data())
@settings(max_examples=8, deadline=None)
def test_ellipsoidal_against_points_all_over_the_ellipsoid(data, make):
    part = data.draw(make.shapes).segmentation().parts[0]
    vertices, _ = make.ball(6)
    surface_points = vertices * (np.sqrt(3) * part.scales) @ part.axes + part.centroid
    points, weights = make.dense_samples(part.vertices[part.triangles], 1)
    nearest, _ = cKDTree(surface_points).query(points)
    expected = weights @ nearest**2 / weights.sum() / part.box_diagonal**2
    assert ellipsoidal(part) == pytest.approx(expected, rel=0.05, abs=5e-5)


@given(data=st.data())
@settings(max_examples=20, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    for name in ("planar_symmetric", "ellipsoidal"):
        before, after = (x.values(f"{name}(a, b, c)") for x in (original, moved))
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-10)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=8, deadline=None)
def test_tessellation_changes_next_to_nothing(data, make, seed):
    """Within what sampling misses of a square: sides of d/20 squared, thrice, over 36."""
    original = data.draw(make.shapes)
    for name in ("planar_symmetric", "ellipsoidal"):
        before = original.values(f"{name}(a, b, c)")
        for again in (make.quartered(original), make.punctured(original, seed)):
            after = again.values(f"{name}(a, b, c)")
            np.testing.assert_allclose(after, before, rtol=0, atol=3 / 20**2 / 36)


@pytest.mark.parametrize("objective", [planar_symmetric, ellipsoidal])
def test_nasty_parts_stay_in_range(nasty, objective):
    low, high = objective.traits.range
    for name, part in nasty.items():
        assert low <= objective(part) <= high, name
