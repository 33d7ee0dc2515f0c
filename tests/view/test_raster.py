"""The z-buffer against exact rational arithmetic over every pixel, one triangle at a time."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial import Delaunay

from moseg_core.view.raster import interpolate, rasterize


def exact_weights(triangle, x, y):
    """Barycentric weights of a point, or None where the triangle does not cover it."""
    (ax, ay), (bx, by), (cx, cy) = [[Fraction(float(v)) for v in corner[:2]] for corner in triangle]
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area == 0:
        return None
    v = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
    w = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
    weights = (1 - v - w, v, w)
    return weights if min(weights) >= 0 else None


def reference(corners, width, height):
    """What rasterize promises, literally; corners lie on its grid of 1/256 pixel."""
    triangle = np.full((height, width), -1)
    depth = np.full((height, width), -np.inf)
    for row in range(height):
        for column in range(width):
            best = None
            for t, corner in enumerate(corners):
                weights = exact_weights(corner, column + Fraction(1, 2), row + Fraction(1, 2))
                if weights is None:
                    continue
                z = sum(w * Fraction(float(c[2])) for w, c in zip(weights, corner, strict=True))
                if best is None or z > best:
                    best, triangle[row, column], depth[row, column] = z, t, float(z)
    return triangle, depth


def on_grid(elements, count):
    return hnp.arrays(np.float64, st.tuples(count, st.just(3), st.just(3)), elements=elements)


# Half pixels put many samples on edges and corners; few depths make many of them equal. Arrays
# drawn from so few numbers also hold needles, points and repeated triangles.
halves = on_grid(st.integers(-6, 22).map(lambda i: i / 2), st.integers(0, 6))
fine = on_grid(st.integers(-2000, 4000).map(lambda i: i / 256), st.integers(0, 6))


@settings(max_examples=60, deadline=None)
@given(corners=st.one_of(halves, fine), width=st.integers(1, 9), height=st.integers(1, 7))
def test_agrees_with_exact_arithmetic(corners, width, height):
    triangle, depth = rasterize(corners, width, height)
    expected_triangle, expected_depth = reference(corners, width, height)
    np.testing.assert_array_equal(triangle, expected_triangle)
    np.testing.assert_allclose(depth, expected_depth, rtol=1e-12, atol=1e-12)


def test_agrees_on_long_thin_triangles():
    # Across the whole picture, where the interval of a row is found by division.
    rng = np.random.default_rng(3)
    base = rng.uniform(-30, 60, (40, 1, 3))
    far = base + rng.uniform(-80, 80, (40, 1, 3))
    corners = np.concatenate([base, far, far + rng.uniform(-4, 4, (40, 1, 3))], axis=1)
    corners[:, :, :2] = np.rint(corners[:, :, :2] * 256) / 256
    triangle, depth = rasterize(corners, 24, 18)
    expected_triangle, expected_depth = reference(corners, 24, 18)
    np.testing.assert_array_equal(triangle, expected_triangle)
    np.testing.assert_allclose(depth, expected_depth, rtol=1e-9)
    assert (triangle >= 0).sum() > 50


def test_neighbouring_triangles_leave_no_gap():
    rng = np.random.default_rng(8)
    inner = rng.uniform(-4, 54, (400, 2))
    points = np.concatenate([inner, [[-5, -5], [55, -5], [55, 55], [-5, 55]]])
    triangles = points[Delaunay(points).simplices]
    corners = np.concatenate([triangles, np.zeros((*triangles.shape[:2], 1))], axis=2)
    triangle, _ = rasterize(corners, 50, 50)
    assert triangle.min() >= 0


def test_corners_are_rounded_to_the_grid():
    def covered(left):
        corners = np.array([[[left, -9.0, 0], [left, 9.0, 0], [9.0, 0.0, 0]]])
        return rasterize(corners, 1, 1)[0][0, 0] == 0

    assert covered(0.5)
    assert covered(0.5 + 0.4 / 256)
    assert not covered(0.5 + 0.6 / 256)


def test_either_winding_covers_the_same():
    corners = np.random.default_rng(1).uniform(-5, 35, (30, 3, 3))
    there = rasterize(corners, 30, 30)
    back = rasterize(np.ascontiguousarray(corners[:, ::-1]), 30, 30)
    np.testing.assert_array_equal(there[0], back[0])
    np.testing.assert_allclose(there[1], back[1], rtol=1e-12)


def test_the_nearer_triangle_is_seen_in_any_order():
    near = np.array([[0.0, 0, 2], [9, 0, 2], [0, 9, 2]])
    far = near - [0, 0, 1]
    assert (rasterize(np.array([near, far]), 4, 4)[0] == 0).all()
    assert (rasterize(np.array([far, near]), 4, 4)[0] == 1).all()


def test_of_equal_depth_the_first_is_seen():
    one = np.array([[0.0, 0, 2], [9, 0, 2], [0, 9, 2]])
    assert (rasterize(np.array([one, one]), 4, 4)[0] == 0).all()


@pytest.mark.parametrize(
    "corners",
    [
        pytest.param([[1, 1, 0], [1, 1, 0], [1, 1, 0]], id="point"),
        pytest.param([[0, 0, 0], [4, 4, 0], [8, 8, 0]], id="line"),
        pytest.param([[2, 2, 0], [2.001, 2, 0], [2, 2.001, 0]], id="below the grid"),
        pytest.param([[50, 0, 0], [60, 0, 0], [50, 9, 0]], id="right of it"),
        pytest.param([[0, -9, 0], [8, -9, 0], [0, -1, 0]], id="above it"),
        pytest.param([[-9, 0, 0], [-1, 0, 0], [-9, 8, 0]], id="left of it"),
        pytest.param([[1e300, 0, 0], [0, 1e300, 0], [1e300, 1e300, 0]], id="beyond counting"),
        pytest.param([[np.inf, 0, 0], [0, np.inf, 0], [0, 0, 0]], id="infinite"),
        pytest.param([[np.nan, 0, 0], [8, 0, 0], [0, 8, 0]], id="not a number"),
    ],
)
def test_covers_nothing(corners):
    triangle, depth = rasterize(np.array([corners], np.float64), 8, 8)
    assert (triangle == -1).all()
    assert (depth == -np.inf).all()


def test_a_triangle_far_larger_than_the_picture_covers_it():
    corners = np.array([[[-1e9, -1e9, 1], [3e9, -1e9, 1], [-1e9, 3e9, 1]]])
    triangle, depth = rasterize(corners, 5, 3)
    assert (triangle == 0).all()
    np.testing.assert_allclose(depth, 1.0)


def test_no_triangles_no_cover():
    triangle, _ = rasterize(np.empty((0, 3, 3)), 3, 2)
    assert triangle.tolist() == [[-1, -1, -1], [-1, -1, -1]]


@settings(max_examples=40, deadline=None)
@given(corners=halves)
def test_interpolates_with_exact_weights(corners):
    values = np.random.default_rng(0).uniform(-1, 1, (len(corners), 3, 2))
    triangle, _ = rasterize(corners, 8, 6)
    result = interpolate(triangle, corners, values)
    for row, column in np.ndindex(*triangle.shape):
        t = triangle[row, column]
        expected = np.zeros(2)
        if t >= 0:
            weights = exact_weights(corners[t], column + Fraction(1, 2), row + Fraction(1, 2))
            expected = sum(float(w) * v for w, v in zip(weights, values[t], strict=True))
        np.testing.assert_allclose(result[row, column], expected, atol=1e-12)


def test_interpolated_depth_is_the_depth():
    corners = np.random.default_rng(5).uniform(0, 40, (25, 3, 3))
    triangle, depth = rasterize(corners, 40, 40)
    result = interpolate(triangle, corners, corners[:, :, 2:])[:, :, 0]
    shown = triangle >= 0
    assert shown.any()
    assert not shown.all()
    np.testing.assert_allclose(result[shown], depth[shown], rtol=1e-9)
    assert (result[~shown] == 0).all()


def test_a_band_of_triangles_shows_each_in_its_place():
    # Three upright strips of two triangles each, four pixels wide.
    strips = []
    for left, right in pairwise([0.0, 4.0, 8.0, 12.0]):
        strips += [[[left, 0, 0], [right, 0, 0], [left, 5, 0]]]
        strips += [[[right, 0, 0], [right, 5, 0], [left, 5, 0]]]
    triangle, _ = rasterize(np.array(strips), 12, 5)
    expected = np.broadcast_to(np.repeat([0, 1, 2], 4), (5, 12))
    np.testing.assert_array_equal(triangle // 2, expected)
