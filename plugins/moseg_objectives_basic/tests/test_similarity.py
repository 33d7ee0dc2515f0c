from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.similarity import similar, similar_proportions
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


@pytest.mark.parametrize("factor", [1e-3, 0.5, 1.0, 7.0])
def test_copies_of_any_size_are_similar(make, factor):
    brick = make.box(3, 2, 1)
    small = make.moved(brick, scale=factor)
    copies = [
        brick,
        make.moved(small, shift=[10, 0, 0]),
        make.moved(small, turn=GENERIC, shift=[0, 20, 0]),
        make.moved((small[0] * [1, -1, 1], small[1]), turn=GENERIC.inv(), shift=[0, 0, 30]),
    ]
    # What is left is the rounding of second moments around 30^2, over those of the copy.
    assert similar(make.segmented(copies).parts) < (1e-15 * (30 / factor) ** 2) ** 2


def test_several_bricks(make):
    sizes = [(3, 2, 1), (4, 1, 0.5), (20, 19, 18)]
    bricks = [make.moved(make.box(*size), shift=[15 * k, 0, 0]) for k, size in enumerate(sizes)]
    parts = make.segmented([make.moved(brick, turn=GENERIC) for brick in bricks]).parts
    unit = np.sqrt([box_variances(size) / box_variances(size).sum() for size in sizes])
    expected = 1 - (unit.mean(axis=0) ** 2).sum()
    for order in itertools.permutations(parts):
        assert similar(order) == pytest.approx(expected, rel=1e-12)


def test_other_proportions_of_the_same_size_are_not_similar(make):
    meshes = make.box(6, 1, 1), make.moved(make.box(1, 6, 6), shift=10)
    assert similar(make.segmented(meshes).parts) > 0.05


def test_extremes_stay_below_a_quarter(make):
    """A line, a disc and a ball, in all mixtures of up to eight."""
    line, plate, ball = make.box(1, 1e-5, 1e-5), make.disc(3, 40), make.ball(2)
    parts = [make.part(mesh) for mesh in (line, plate, ball)]
    largest = 0.0
    for counts in itertools.product(range(9), repeat=3):
        if 2 <= sum(counts) <= 8:
            chosen = [p for p, count in zip(parts, counts, strict=True) for _ in range(count)]
            largest = max(largest, similar(chosen))
    assert 0.21 < largest < 0.463**2 < similar.traits.range[1]


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    expression = "similar(a, b, c) + similar(a, c)"
    before, after = original.values(expression), motion(original).values(expression)
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-10)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_changes_nothing(data, make, seed):
    original = data.draw(make.shapes)
    before = original.values("similar(a, b, c)")
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values("similar(a, b, c)"), before, rtol=0, atol=1e-11)


def test_nasty_parts_stay_in_range(nasty):
    for pair in itertools.product(nasty.values(), repeat=2):
        assert 0 <= similar(pair) <= 0.25
    assert 0 <= similar(list(nasty.values())) <= 0.25


def test_copies_of_the_same_size_have_similar_proportions(make):
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


def test_similar_proportions_of_several_bricks(make):
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
def test_motion_scale_mirror_and_order_leave_similar_proportions_as_they_are(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    moved = motion(original)
    expression = "similar_proportions(a, b, c) + similar_proportions(a, c)"
    before, after = original.values(expression), moved.values(expression)
    np.testing.assert_allclose(after, before, rtol=0, atol=1e-11)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_leaves_similar_proportions_as_they_are(data, make, seed):
    original = data.draw(make.shapes)
    expression = "similar_proportions(a, b, c)"
    before = original.values(expression)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(expression), before, rtol=0, atol=1e-11)


def test_similar_proportions_of_nasty_parts_stay_in_range(nasty):
    for (one, first), (other, second) in itertools.product(nasty.items(), repeat=2):
        value = similar_proportions((first, second))
        assert 0 <= value < math.inf, (one, other)
