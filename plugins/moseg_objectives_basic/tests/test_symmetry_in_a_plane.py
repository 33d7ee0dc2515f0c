from __future__ import annotations

import moseg_objectives_basic.surface_distance as surface
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.symmetry import planar_symmetric
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
    original = surface.SurfaceTree._add

    def counted(self, points, weights, runs, of_run, total, limit, squared):
        mine = np.full(len(points), np.nan)
        found = original(self, points, weights, runs, of_run, total, limit, mine)
        written = np.isfinite(mine)
        squared[written] = mine[written]
        asked.append(written.sum())
        return found

    monkeypatch.setattr(surface.SurfaceTree, "_add", counted)
    part = make.part(prism(length))
    assert planar_symmetric(part) < 1e-25
    count = len(part.measure("basic:surface_samples")[0])
    assert count <= sum(asked) < 1.5 * count


@given(data=st.data())
@settings(max_examples=20, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    before, after = (x.values("planar_symmetric(a, b, c)") for x in (original, moved))
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-10)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=8, deadline=None)
def test_tessellation_changes_next_to_nothing(data, make, seed):
    """Within what sampling misses of a square: sides of d/20 squared, thrice, over 36."""
    original = data.draw(make.shapes)
    before = original.values("planar_symmetric(a, b, c)")
    for again in (make.quartered(original), make.punctured(original, seed)):
        after = again.values("planar_symmetric(a, b, c)")
        np.testing.assert_allclose(after, before, rtol=0, atol=3 / 20**2 / 36)


def test_nasty_parts_stay_in_range(nasty):
    low, high = planar_symmetric.traits.range
    for title, part in nasty.items():
        assert low <= planar_symmetric(part) <= high, title
