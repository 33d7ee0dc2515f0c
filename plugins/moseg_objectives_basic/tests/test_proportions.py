from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.proportions import compact, flat, narrow
from scipy import integrate

EXPRESSION = "narrow(a, b, c) + flat(a, b, c) + compact(a, b, c)"


def check(part, variances, *, rtol):
    """All three objectives against their formulas, for known variances along the axes."""
    s1, s2, s3 = np.sqrt(sorted(variances, reverse=True))
    assert narrow(part) == pytest.approx((s2 + s3) / (2 * s1), rel=rtol, abs=rtol)
    assert flat(part) == pytest.approx(s3 / (2 * s1) + s3 / (2 * s2), rel=rtol, abs=rtol)
    assert compact(part) == pytest.approx(1 - (s2 + s3) / (2 * s1), rel=rtol, abs=rtol)


@pytest.mark.parametrize("size", [(3, 2, 1), (1, 1, 9), (5, 0.1, 4), (1, 1, 1), (7, 3, 3)])
def test_surface_of_a_box(make, size):
    area = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
    variances = []
    for k in range(3):
        a, b, c = np.roll(size, -k)
        # Two sides of area bc at distance a/2; the others extend evenly along a.
        variances.append((2 * b * c * a**2 / 4 + 2 * a * (b + c) * a**2 / 12) / area)
    check(make.part(make.box(*size)), variances, rtol=1e-12)


@pytest.mark.parametrize(("length", "width"), [(9, 1), (2, 2), (1, 1e-3)])
def test_rectangle(make, length, width):
    part = make.part(make.rectangle(length, width))
    check(part, [length**2 / 12, width**2 / 12, 0], rtol=1e-12)
    assert narrow(part) == pytest.approx(width / (2 * length), rel=1e-12)
    assert flat(part) == 0.0


@pytest.mark.parametrize(("radius", "length"), [(1, 10), (1, 0.5), (0.2, 1)])
@pytest.mark.parametrize("caps", [True, False])
def test_cylinder(make, radius, length, caps):
    side = 2 * math.pi * radius * length
    ends = 2 * math.pi * radius**2 * caps
    along = (side * length**2 / 12 + ends * length**2 / 4) / (side + ends)
    across = (side * radius**2 / 2 + ends * radius**2 / 4) / (side + ends)
    part = make.part(make.tube(radius, length, 600, caps=caps))
    check(part, [along, across, across], rtol=1e-4)


def test_sphere_extends_alike_in_all_directions(make):
    part = make.part(make.ball(2))
    assert narrow(part) == pytest.approx(1, abs=1e-12)
    assert flat(part) == pytest.approx(1, abs=1e-12)
    assert compact(part) == pytest.approx(0, abs=1e-12)


def test_flat_disc(make):
    part = make.part(make.disc(3, 24))
    assert (narrow(part), flat(part), compact(part)) == pytest.approx((0.5, 0, 0.5), abs=1e-12)


@pytest.mark.parametrize("long", [1.5, 3.0, 6.0])
def test_ellipsoid_of_revolution(make, long):
    def over_surface(function):
        """Integral over the polar angle with the surface's area element."""
        return integrate.quad(
            lambda t: function(t) * math.sin(t) * math.hypot(long * math.sin(t), math.cos(t)),
            0,
            math.pi,
        )[0]

    area = over_surface(lambda t: 1)
    along = over_surface(lambda t: (long * math.cos(t)) ** 2) / area
    across = over_surface(lambda t: math.sin(t) ** 2 / 2) / area
    vertices, faces = make.ball(5)
    check(make.part((vertices * [1, long, 1], faces)), [along, across, across], rtol=2e-3)


def test_limits(make):
    assert narrow(make.part(make.box(1, 1e-6, 1e-6))) < 2e-6
    assert compact(make.part(make.box(1, 1e-6, 1e-6))) > 1 - 2e-6
    assert flat(make.part(make.box(1, 1, 1e-6))) < 3e-6


@given(data=st.data())
@settings(max_examples=40, deadline=None)
def test_motion_scale_mirror_and_order_change_nothing(data, make):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    # A thousand diagonals away, coordinates are rounded to 1e-13 diagonals.
    after = motion(original).values(EXPRESSION)
    np.testing.assert_allclose(after, original.values(EXPRESSION), rtol=0, atol=1e-11)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=15, deadline=None)
def test_tessellation_changes_nothing(data, make, seed):
    original = data.draw(make.shapes)
    before = original.values(EXPRESSION)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(EXPRESSION), before, rtol=0, atol=1e-12)


@pytest.mark.parametrize("objective", [narrow, flat, compact])
def test_nasty_parts_stay_in_range(nasty, objective):
    low, high = objective.traits.range
    for name, part in nasty.items():
        assert low <= objective(part) <= high, name
