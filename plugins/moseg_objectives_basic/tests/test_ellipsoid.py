from __future__ import annotations

import math
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.ellipsoid import ellipsoidal, squared_distances_to_ellipsoid
from scipy import integrate, optimize
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def distances(points, radii):
    points = np.atleast_2d(np.asarray(points, float))
    return np.sqrt(squared_distances_to_ellipsoid(points, np.asarray(radii, float)))


def exact_distance(point, radii):
    """The distance with 120 digits, by bisection.

    Zeros are replaced by 1e-40 of the size, which changes the distance by as little. So no case
    is special: the multiplier is where the terms' squares add up to 1.
    """
    with localcontext() as context:
        context.prec = 120
        size = max(*(Decimal(float(r)) for r in radii), *(abs(Decimal(float(x))) for x in point))
        tiny = size * Decimal(10) ** -40
        pairs = sorted(
            (max(Decimal(float(r)), tiny), max(abs(Decimal(float(x))), tiny))
            for r, x in zip(radii, point, strict=True)
        )
        shortest = pairs[0][0]
        gaps = [r * r - shortest * shortest for r, _ in pairs]
        pulls = [r * x for r, x in pairs]
        low, high = Decimal(0), sum(p * p for p in pulls).sqrt()
        for _ in range(360):
            middle = (low + high) / 2
            if sum((p / (middle + g)) ** 2 for p, g in zip(pulls, gaps, strict=True)) > 1:
                low = middle
            else:
                high = middle
        foot = [r * p / (high + g) for (r, _), p, g in zip(pairs, pulls, gaps, strict=True)]
        return float(sum((f - x) ** 2 for f, (_, x) in zip(foot, pairs, strict=True)).sqrt())


def searched_distance(point, radii):
    """The distance by looking: the nearest of many points of the surface, then downhill."""

    def squared(angles):
        u, v = angles
        foot = radii * [math.cos(u) * math.cos(v), math.sin(u) * math.cos(v), math.sin(v)]
        return float(((foot - point) ** 2).sum())

    u, v = np.meshgrid(np.linspace(-np.pi, np.pi, 61), np.linspace(-np.pi / 2, np.pi / 2, 31))
    grid = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1) * radii
    order = np.argsort(((grid - point) ** 2).sum(axis=-1), axis=None)
    starts = [(u.flat[k], v.flat[k]) for k in order[[0, 1, 2, 40]]]
    options = {"xatol": 1e-10, "fatol": 1e-20, "maxiter": 2000, "maxfev": 4000}
    return math.sqrt(
        min(
            optimize.minimize(squared, start, method="Nelder-Mead", options=options).fun
            for start in starts
        )
    )


def check(point, radii):
    size = max(*radii, *np.abs(point))
    assert distances(point, radii)[0] == pytest.approx(
        exact_distance(point, radii), rel=0, abs=1e-13 * size
    )


@pytest.mark.parametrize("radius", [0.3, 1.0, 7.0])
def test_sphere(radius):
    points = np.random.default_rng(1).normal(size=(200, 3)) * 3
    expected = np.abs(np.linalg.norm(points, axis=1) - radius)
    np.testing.assert_allclose(distances(points, [radius] * 3), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 0, 2)])
def test_known_distances(order):
    radii = np.array([3.0, 2.0, 1.0])
    at = np.array([[5.0, 0, 0], [0, 5, 0], [0, 0, -5], [3, 0, 0], [0, 0, 0], [0, 0, 0.25]])
    expected = [2, 3, 4, 0, 1, 0.75]
    np.testing.assert_allclose(
        distances(at[:, order], radii[list(order)]), expected, rtol=0, atol=1e-15
    )


def test_on_the_middle_plane_the_nearest_point_leaves_it():
    # In the plane across the shortest radius: x_i = e_i^2 y_i / (e_i^2 - e_min^2), literally.
    radii, at = np.array([3.0, 2.0, 1.0]), np.array([1.0, -0.5, 0.0])
    x, y = 9 * at[0] / (9 - 1), 4 * at[1] / (4 - 1)
    z = math.sqrt(1 - (x / 3) ** 2 - (y / 2) ** 2)
    expected = math.dist((x, y, z), at)
    for height in (0.0, 1e-300, 1e-30, 1e-20, 1e-17, 1e-15):
        found = distances(at + np.array([0, 0, height]), radii)[0]
        assert found == pytest.approx(expected, rel=1e-14)


def test_flat_ellipsoid_is_a_filled_ellipse():
    radii = [2.0, 1.0, 0.0]
    inside = [[0.5, 0.3, 0.7], [0, 0, -2], [1, 0.5, 0], [2, 0, 0], [0, -1, 1e-9]]
    assert distances(inside, radii).tolist() == pytest.approx([0.7, 2, 0, 0, 1e-9], abs=1e-15)
    assert distances([3, 0, 1], radii)[0] == pytest.approx(math.sqrt(2), rel=1e-15)


def test_two_radii_of_zero_leave_a_segment_and_three_a_point():
    points = np.random.default_rng(2).normal(size=(300, 3)) * 2
    beyond = np.maximum(np.abs(points[:, 1]) - 1.5, 0)
    expected = np.sqrt(points[:, 0] ** 2 + beyond**2 + points[:, 2] ** 2)
    np.testing.assert_allclose(distances(points, [0, 1.5, 0]), expected, rtol=0, atol=1e-14)
    expected = np.linalg.norm(points, axis=1)
    np.testing.assert_allclose(distances(points, [0, 0, 0]), expected, rtol=0, atol=1e-14)
    assert distances([0, 0, 0], [0, 0, 0]).tolist() == [0]
    assert squared_distances_to_ellipsoid(np.empty((0, 3)), np.ones(3)).shape == (0,)


lengths = st.one_of(
    st.floats(0, 3),
    st.sampled_from(
        [0.0, 1e-300, 1e-160, 1e-149, 1e-80, 1e-20, 1e-17, 1e-12, 1e-6, 1e-3, 0.5, 1.0, 1.0 - 1e-12]
    ),
    st.sampled_from([1.0 + 2**-52, 2.0, 1e3, 1e6]),
)


@given(radii=st.tuples(lengths, lengths, lengths), point=st.tuples(lengths, lengths, lengths))
@settings(max_examples=250, deadline=None)
def test_against_120_digits(radii, point):
    assume(max(*radii, *point) > 1e-150)  # whose square is a number
    check(point, radii)


@given(
    base=st.floats(0.1, 10),
    factors=st.lists(st.sampled_from([0.0, 1e-12, -1e-12, 1e-9, 2**-52]), min_size=3, max_size=3),
    point=st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(-2, 2)),
)
@example(base=1.0, factors=[0.0, 0.0, 0.0], point=(0.0, 0.0, 4e-161))
@settings(max_examples=80, deadline=None)
def test_nearly_equal_radii(base, factors, point):
    check(np.array(point) * base, base * (1 + np.array(factors)))


@given(
    radii=st.lists(st.floats(0.05, 3), min_size=3, max_size=3),
    fraction=st.floats(0, 2),
    angle=st.floats(0, 2 * math.pi),
    height=st.sampled_from([0.0, 1e-18, 1e-16, 1e-14, 1e-10, 1e-6]),
)
@settings(max_examples=120, deadline=None)
def test_on_and_beside_the_medial_surface(radii, fraction, angle, height):
    """The medial disc lies across the shortest radius, with semi-axes (e_i^2 - e_min^2) / e_i."""
    e = np.sort(radii)
    disc = (e[1:] ** 2 - e[0] ** 2) / e[1:] * fraction
    check([height * e[2], disc[0] * math.cos(angle), disc[1] * math.sin(angle)], e)


@given(
    radii=st.lists(st.floats(0.05, 3), min_size=3, max_size=3),
    seed=st.integers(0, 2**32 - 1),
    offset=st.sampled_from([0.0, 1e-12, -1e-12, 1e-6, -1e-6, 0.01, -0.01, 1.0, 1e3, 1e9]),
)
@settings(max_examples=150, deadline=None)
def test_along_the_normal(radii, seed, offset):
    """A point at a small or outward offset along the normal is at just that distance."""
    e = np.array(radii)
    direction = np.random.default_rng(seed).normal(size=3)
    foot = e * direction / np.linalg.norm(direction)
    normal = foot / e**2
    normal /= np.linalg.norm(normal)
    # Inwards, no further than the least radius of curvature.
    inwards = -(e.min() ** 2) / e.max() / 2
    offset = max(offset, inwards)
    found = distances(foot + offset * normal, e)[0]
    assert found == pytest.approx(abs(offset), rel=1e-14, abs=1e-14 * (e.max() + abs(offset)))


@given(
    radii=st.lists(st.floats(0.2, 3), min_size=3, max_size=3),
    point=st.tuples(st.floats(-4, 4), st.floats(-4, 4), st.floats(-4, 4)),
)
@settings(max_examples=25, deadline=None)
def test_against_a_search_of_the_surface(radii, point):
    searched = searched_distance(np.array(point), np.array(radii))
    assert distances(point, radii)[0] == pytest.approx(searched, abs=1e-6)


@given(seed=st.integers(0, 2**32 - 1), exponent=st.floats(-8, 8))
@settings(max_examples=30, deadline=None)
def test_many_points_at_once_as_one_by_one(seed, exponent):
    rng = np.random.default_rng(seed)
    radii = rng.choice([0.0, 0.3, 1.0, 1.0, 2.5], size=3)
    points = rng.choice([0.0, 1e-15, 0.1, 0.5, 1.0, 3.0], size=(50, 3))
    points *= rng.choice([-1, 1], size=points.shape)
    together = distances(points, radii)
    alone = np.concatenate([distances(point, radii) for point in points])
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-14)
    # Signs, order of the axes and units mean nothing.
    np.testing.assert_array_equal(distances(-points, radii), together)
    np.testing.assert_allclose(
        distances(points[:, [2, 0, 1]], radii[[2, 0, 1]]), together, rtol=0, atol=1e-14
    )
    scale = 10.0**exponent
    np.testing.assert_allclose(
        distances(points * scale, radii * scale), together * scale, rtol=1e-9, atol=1e-14 * scale
    )


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
    before, after = (x.values("ellipsoidal(a, b, c)") for x in (original, moved))
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-10)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=8, deadline=None)
def test_tessellation_changes_next_to_nothing(data, make, seed):
    """Within what sampling misses of a square: sides of d/20 squared, thrice, over 36."""
    original = data.draw(make.shapes)
    before = original.values("ellipsoidal(a, b, c)")
    for again in (make.quartered(original), make.punctured(original, seed)):
        after = again.values("ellipsoidal(a, b, c)")
        np.testing.assert_allclose(after, before, rtol=0, atol=3 / 20**2 / 36)


def test_nasty_parts_stay_in_range(nasty):
    low, high = ellipsoidal.traits.range
    for title, part in nasty.items():
        assert low <= ellipsoidal(part) <= high, title
