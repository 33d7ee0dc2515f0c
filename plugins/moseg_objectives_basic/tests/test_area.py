from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.area import area_fraction

from moseg_core import ExpressionError, Problem, Shape, UsageError


@pytest.fixture(scope="module")
def eighth(make):
    """One face in eight of a strip of squares."""
    vertices = [[x, y, 0] for x in range(9) for y in (0, 1)]
    faces = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(8)]
    return Shape.from_mesh(vertices, faces), [0] + [1] * 7


@pytest.mark.parametrize(
    ("bounds", "expected"),
    [
        ("", 0),
        ("min=0.125", 0),
        ("max=0.125", 0),
        ("min=0.1, max=0.2", 0),
        ("min=0.2", 0.075),
        ("min=1", 0.875),
        ("min=0.5, max=0.5", 0.375),
        ("max=0.1", 0.025),
        ("max=0", 0.125),
        ("min=0, max=0", 0.125),
    ],
)
def test_distance_from_the_bounds(eighth, bounds, expected):
    term = f"area_fraction(a, {bounds})" if bounds else "area_fraction(a)"
    value = Problem(["a", "b"], term).evaluate(*eighth).cost.value
    assert value == pytest.approx(expected, abs=1e-15)


def test_sums_over_labels(eighth):
    found = Problem(["a", "b"], "2*area_fraction(*, min=0.2, max=0.5)").evaluate(*eighth)
    assert found.cost.value == pytest.approx(2 * (0.075 + 0.375), rel=1e-14)


@pytest.mark.parametrize(
    ("bounds", "share"),
    [
        ("", None),
        ("min=0.2", None),
        ("min=0.2, max=1", None),
        ("min=0.1, max=0.3", 0.2),
        ("max=0.3", 0.15),
        ("min=0, max=0.3", 0.15),
        ("min=0.5, max=0.5", 0.5),
        ("max=0", None),
        ("min=0, max=0", None),
    ],
)
def test_the_share_that_the_bounds_let_expect(bounds, share):
    term = f"area_fraction(a, {bounds})" if bounds else "area_fraction(a)"
    expected = Problem(["a", "b"], f"{term} + narrow(b)").expected_shares
    np.testing.assert_allclose(expected, np.array([share, None], float), rtol=1e-15)


def test_bounds_the_wrong_way_round(make, eighth):
    whole = make.part(make.box(1, 1, 1))
    with pytest.raises(UsageError, match=r"min=0\.6 and max=0\.5"):
        area_fraction(whole, min=0.6, max=0.5)
    # Defaults count: nothing is above 1 or below 0.
    with pytest.raises(UsageError, match=r"area_fraction.*: .*min=0\.6 and max=0\.5"):
        Problem(["a", "b"], "area_fraction(a, min=0.6, max=0.5)").evaluate(*eighth)


@pytest.mark.parametrize("wrong", ["min=-0.1", "max=1.1", "most=0.5"])
def test_parameters_are_checked_where_they_are_written(wrong):
    with pytest.raises(ExpressionError, match="area_fraction"):
        Problem(["a"], f"area_fraction(a, {wrong})")


@given(data=st.data(), bounds=st.tuples(st.floats(0, 1), st.floats(0, 1)).map(sorted))
@settings(max_examples=40, deadline=None)
def test_any_bounds(data, make, bounds):
    low, high = bounds
    parts = data.draw(make.shapes).segmentation().parts
    whole = sum(part.area for part in parts)
    for part in parts:
        value = area_fraction(part, min=low, max=high)
        nearest = np.clip(part.area / whole, low, high)
        assert value == pytest.approx(abs(part.area / whole - nearest), abs=1e-12)
        assert 0 <= value <= 1


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_invariances(data, make, seed):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    expression = "area_fraction(a, b, c, min=0.9) + area_fraction(a, b, c, max=0.05)"
    before = original.values(expression)
    np.testing.assert_allclose(motion(original).values(expression), before, rtol=0, atol=1e-11)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values(expression), before, rtol=0, atol=1e-13)


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        for bounds in ((0, 0), (0, 1), (1, 1), (0.3, 0.4)):
            assert 0 <= area_fraction(part, min=bounds[0], max=bounds[1]) <= 1, name
