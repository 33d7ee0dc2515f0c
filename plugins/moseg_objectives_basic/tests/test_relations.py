from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.axes import perpendicular
from moseg_objectives_basic.similarity import similar_proportions
from scipy.spatial.transform import Rotation

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def box_variances(size):
    """Variances along the axes of a box's surface, in the order of its sides."""
    area = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
    variances = []
    for k in range(3):
        a, b, c = np.roll(size, -k)
        variances.append((2 * b * c * a**2 / 4 + 2 * a * (b + c) * a**2 / 12) / area)
    return np.array(variances)


@pytest.mark.parametrize("degrees", [0, 10, 45, 60, 90, 120, 180])
def test_bars_at_an_angle(make, degrees):
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


def test_copies_are_alike(make):
    brick = make.box(3, 2, 1)
    copies = [
        brick,
        make.moved(brick, shift=[10, 0, 0]),
        make.moved(brick, turn=GENERIC, shift=[0, 20, 0]),
        make.moved((brick[0] * [1, -1, 1], brick[1]), turn=GENERIC.inv(), shift=[0, 0, 30]),
    ]
    assert similar_proportions(make.segmented(copies).parts) < 1e-26


@pytest.mark.parametrize("factor", [0.5, 1.5, 3.0])
@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
def test_scaled_copy(make, factor, turn):
    brick = make.box(3, 2, 1)
    pair = [brick, make.moved(brick, scale=factor, shift=[20, 0, 0])]
    parts = make.segmented([make.moved(mesh, turn=turn) for mesh in pair]).parts
    # Both scale vectors are half their difference from the mean.
    spread = (1 - factor) ** 2 / 2 * box_variances((3, 2, 1)).sum()
    larger = max(1, factor)
    diagonal = math.hypot(20 + 1.5 + 1.5 * factor, 2 * larger, larger)
    assert similar_proportions(parts) == pytest.approx(spread / diagonal**2, rel=1e-12)


def test_several_bricks(make):
    sizes = [(3, 2, 1), (4, 1, 0.5), (2, 1.9, 1.8)]
    bricks = [make.moved(make.box(*size), shift=[15 * k, 0, 0]) for k, size in enumerate(sizes)]
    parts = make.segmented([make.moved(brick, turn=GENERIC) for brick in bricks]).parts
    scales = np.array([sorted(np.sqrt(box_variances(size)), reverse=True) for size in sizes])
    spread = sum(((row - scales.mean(axis=0)) ** 2).sum() for row in scales)
    squared_diagonal = (1.5 + 30 + 1) ** 2 + 2**2 + 1.8**2
    expected = spread / squared_diagonal
    for order in itertools.permutations(parts):
        assert similar_proportions(order) == pytest.approx(expected, rel=1e-12)


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    # Coordinates rounded to 1e-13 diagonals turn an axis by up to that over the eigengap, 1e-3.
    for expression, tolerance in (
        ("perpendicular(a, b) + perpendicular(b, c)", 1e-9),
        ("similar_proportions(a, b, c) + similar_proportions(a, c)", 1e-11),
    ):
        before, after = original.values(expression), moved.values(expression)
        np.testing.assert_allclose(after, before, rtol=0, atol=tolerance)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_changes_nothing(data, make, seed):
    original = data.draw(make.shapes)
    expression = "perpendicular(a, b) + similar_proportions(a, b, c)"
    before = original.values(expression)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(expression), before, rtol=0, atol=1e-11)


def test_nasty_parts_stay_in_range(nasty):
    for (one, first), (other, second) in itertools.product(nasty.items(), repeat=2):
        assert 0 <= perpendicular((first, second)) <= 1, (one, other)
        value = similar_proportions((first, second))
        assert 0 <= value < math.inf, (one, other)
