"""The ramp: equal steps to the eye, in order of lightness, within what a screen can show."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.view.palette import _TO_CONES, _TO_OKLAB, _oklab, from_oklab, linear_light
from moseg_core.view.ramp import curve, ramp, shades
from tests.view.test_palette import SEEN


def test_steps_are_equal_to_the_eye():
    steps = np.linalg.norm(np.diff(curve(65), axis=0), axis=1)
    assert steps == pytest.approx(steps.mean(), rel=1e-3)
    # As drawn, in whole numbers of 0 to 255.
    drawn = np.linalg.norm(np.diff(_oklab(ramp(17)), axis=0), axis=1)
    assert drawn == pytest.approx(drawn.mean(), rel=0.1)


@pytest.mark.parametrize("vision", SEEN)
def test_lightness_grows_for_all_readers(vision):
    seen = linear_light(ramp(33)) @ np.array(SEEN[vision]).T
    lightness = np.cbrt(np.maximum(seen, 0.0) @ [0.2126, 0.7152, 0.0722])
    assert (np.diff(lightness) > 0.005).all()


def test_every_colour_can_be_shown():
    cones = (curve(256) @ np.linalg.inv(_TO_OKLAB).T) ** 3
    light = cones @ np.linalg.inv(_TO_CONES).T
    assert light.min() >= 0.0
    assert light.max() <= 1.0


def test_colours_come_back_from_oklab():
    colors = np.random.default_rng(0).integers(0, 256, (500, 3)).astype(np.uint8)
    assert (from_oklab(_oklab(colors)) == colors).all()
    assert from_oklab(np.array([[1.5, 0.0, 0.0]])).tolist() == [[255, 255, 255]]


def test_the_ramp_is_shared_and_cannot_be_changed():
    assert ramp() is ramp()
    assert not ramp().flags.writeable


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=20), st.integers(2, 300))
def test_shades_are_in_the_order_of_the_values(values, n):
    array = np.array(values)
    found = shades(array, n)
    assert found.min() >= 0
    assert found.max() < n
    order = np.argsort(array, kind="stable")
    assert (np.diff(found[order]) >= 0).all()
    if array.max() > array.min():
        assert (found[array.argmin()], found[array.argmax()]) == (0, n - 1)
    else:
        assert (found == n // 2).all()
