from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.similarity import similar
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
