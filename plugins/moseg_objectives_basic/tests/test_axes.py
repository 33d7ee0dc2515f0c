from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.axes import coaxial, parallel, perpendicular
from scipy.spatial.transform import Rotation

from moseg_core import ExpressionError, Problem

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def pair(make, turn=None, shift=(0, 0, 0), whole=GENERIC):
    """A bar around the origin along x, another turned and shifted; then both turned."""
    bars = [make.box(6, 1, 0.5), make.moved(make.box(3, 0.4, 0.7), turn=turn, shift=shift)]
    return make.segmented([make.moved(bar, turn=whole, shift=2.0) for bar in bars]).parts


@pytest.mark.parametrize("degrees", [0, 1e-7, 10, 45, 60, 90, 120, 180])
def test_bars_at_an_angle(make, degrees):
    turn = Rotation.from_euler("z", degrees, degrees=True)
    parts = pair(make, turn, [9, 2, 1])
    # A small angle too, to more digits than its cosine has.
    assert parallel(parts) == pytest.approx(abs(math.sin(math.radians(degrees))), abs=1e-14)
    assert parallel(parts[::-1]) == parallel(parts)
    assert parallel(parts) ** 2 + perpendicular(parts) ** 2 == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("offset", [[9, 0, 0], [-5, 0, 0]])
def test_bars_in_a_row_are_coaxial(make, offset):
    assert coaxial(pair(make, shift=offset)) < 1e-14
    assert coaxial(pair(make, Rotation.from_euler("x", 40, degrees=True), offset)) < 1e-14


@pytest.mark.parametrize("offset", [[0, 3, 0], [0, 0, -3], [50, 3, 0], [-4, 0, 3]])
def test_parallel_bars_side_by_side(make, offset):
    """The distance between the lines over the diagonal, wherever along them the bars are."""
    parts = pair(make, shift=offset)
    distance = math.hypot(*offset[1:])
    assert coaxial(parts) == pytest.approx(distance / parts[0].shape.box_diagonal, rel=1e-12)
    assert coaxial(parts[::-1]) == pytest.approx(coaxial(parts), rel=1e-12)


@pytest.mark.parametrize("degrees", [1, 30, 90])
def test_bars_through_one_centroid_differ_by_the_angle(make, degrees):
    parts = pair(make, Rotation.from_euler("z", degrees, degrees=True))
    assert coaxial(parts) == pytest.approx(math.sin(math.radians(degrees)), abs=1e-12)


def test_lines_that_cross_far_from_the_parts_are_not_coaxial(make):
    turn = Rotation.from_euler("z", 30, degrees=True)
    parts = pair(make, turn, [10, 1, 0])
    across_first, across_second = 1.0, abs(10 * math.sin(math.pi / 6) - math.cos(math.pi / 6))
    offset = (across_first + across_second) / 2 / parts[0].shape.box_diagonal
    assert coaxial(parts) == pytest.approx(1 - 0.5 * (1 - offset), rel=1e-12)


def test_coaxial_changes_gently_near_parallel(make):
    """No jump where the lines become parallel and their shortest distance does."""
    values = [
        coaxial(pair(make, Rotation.from_euler("z", angle), [10, 3, 0]))
        for angle in (-1e-6, 0, 1e-6)
    ]
    assert np.ptp(values) < 1e-5


def test_exactly_two_labels():
    for name in ("parallel", "coaxial"):
        with pytest.raises(ExpressionError, match="exactly 2 labels"):
            Problem(["a", "b", "c"], f"{name}(a, b, c)")


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    for expression in (
        "parallel(a, b) + parallel(b, c) + parallel(a, c)",
        "coaxial(a, b) + coaxial(b, c) + coaxial(a, c)",
    ):
        before, after = original.values(expression), moved.values(expression)
        np.testing.assert_allclose(after, before, rtol=0, atol=1e-9)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_changes_nothing(data, make, seed):
    original = data.draw(make.shapes)
    expression = "parallel(a, b) + coaxial(a, b) + coaxial(c, b)"
    before = original.values(expression)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(expression), before, rtol=0, atol=1e-11)


@given(data=st.data())
@settings(max_examples=15, deadline=None)
def test_order_of_labels_changes_nothing(data, make):
    first, second, _ = data.draw(make.shapes).segmentation().parts
    for objective in (parallel, coaxial):
        there, back = objective((first, second)), objective((second, first))
        assert there == pytest.approx(back, abs=1e-15)


def test_nasty_parts_stay_in_range(nasty):
    for (one, first), (other, second) in itertools.product(nasty.items(), repeat=2):
        assert 0 <= parallel((first, second)) <= 1, (one, other)
        # Also for parts of different shapes, whose centroids no box holds.
        assert 0 <= coaxial((first, second)) <= 1, (one, other)


@pytest.mark.parametrize("degrees", [0, 10, 45, 60, 90, 120, 180])
def test_bars_are_perpendicular_by_the_cosine(make, degrees):
    turn = Rotation.from_euler("z", degrees, degrees=True)
    bars = [make.box(6, 1, 0.5), make.moved(make.box(3, 0.4, 0.7), turn=turn, shift=[9, 2, 1])]
    for whole in (Rotation.identity(), GENERIC):
        parts = make.segmented([make.moved(bar, turn=whole) for bar in bars]).parts
        expected = abs(math.cos(math.radians(degrees)))
        assert perpendicular(parts) == pytest.approx(expected, abs=1e-12)
        assert perpendicular(parts[::-1]) == perpendicular(parts)


def test_parallel_bars_are_never_more_than_parallel(make):
    for seed in range(100):
        bar = make.moved(make.box(6, 1, 0.5), turn=Rotation.random(rng=seed))
        part = make.part(bar)
        assert 1 - 1e-12 < perpendicular((part, part)) <= 1


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_motion_scale_mirror_and_order_leave_perpendicular_as_it_is(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    expression = "perpendicular(a, b) + perpendicular(b, c)"
    before, after = original.values(expression), moved.values(expression)
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-9)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_leaves_perpendicular_as_it_is(data, make, seed):
    original = data.draw(make.shapes)
    expression = "perpendicular(a, b) + perpendicular(b, c)"
    before = original.values(expression)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(expression), before, rtol=0, atol=1e-11)


def test_perpendicular_of_nasty_parts_stays_in_range(nasty):
    for (one, first), (other, second) in itertools.product(nasty.items(), repeat=2):
        assert 0 <= perpendicular((first, second)) <= 1, (one, other)
