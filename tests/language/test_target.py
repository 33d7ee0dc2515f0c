"""Targets as values, and how far off a value is, against the formulas written out."""

from __future__ import annotations

import dataclasses
import math
import pickle

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import moseg_core
from moseg_core.errors import UsageError
from moseg_core.language import Target

NUMBERS = st.floats(-1e6, 1e6)
POSITIVE = st.floats(1e-6, 1e6)
ANY = st.floats(allow_nan=False, allow_infinity=False)
ANY_POSITIVE = st.floats(0, exclude_min=True, allow_infinity=False)


def h(z: float) -> float:
    return z**2 if abs(z) <= 2 else 4 * abs(z) - 4


@pytest.mark.parametrize(
    ("target", "text"),
    [
        (Target(0.06, 0.02), "0.06+-0.02"),
        (Target(6, 2), "6+-2"),
        (Target(-0.5, 1e-9), "-0.5+-1e-09"),
        (Target(value=1e22, spread=2.5), "1e+22+-2.5"),
    ],
)
def test_a_target_as_text(target, text):
    assert str(target) == text


def test_targets_are_values():
    target = Target(0.06, 0.02)
    assert target == Target(0.06, 0.02)
    assert target != Target(0.06, 0.03)
    assert target != Target(0.05, 0.02)
    assert len({target, Target(0.06, 0.02), Target(6, 2), Target(6.0, 2.0)}) == 2
    assert pickle.loads(pickle.dumps(target)) == target
    assert type(Target(6, 2).value) is type(Target(6, 2).spread) is float
    assert moseg_core.Target is Target
    with pytest.raises(dataclasses.FrozenInstanceError):
        target.value = 1.0


@pytest.mark.parametrize(
    ("value", "spread", "complaint"),
    [
        (math.nan, 1, "the value of a target must be a finite number, not nan"),
        (math.inf, 1, "the value of a target must be a finite number, not inf"),
        (1, math.inf, "the spread of a target must be a finite number, not inf"),
        ("1", 1, "the value of a target must be a finite number, not '1'"),
        (True, 1, "the value of a target must be a finite number, not True"),
        (1, None, "the spread of a target must be a finite number, not None"),
        (10**400, 1, "the value of a target must be a finite number, not 1000"),
        (0.5, 0, "the spread of a target must be positive, not 0; it says how far from 0.5 is"),
        (0.5, -1, "the spread of a target must be positive, not -1; it says how far"),
    ],
)
def test_what_is_no_target(value, spread, complaint):
    with pytest.raises(UsageError) as caught:
        Target(value, spread)
    assert str(caught.value).startswith(complaint)


@given(NUMBERS, POSITIVE, NUMBERS)
@example(0.0, 1.0, 2.0)
@example(0.0, 1.0, -2.0)
def test_cost_against_the_formula(value, spread, measured):
    expected = h((measured - value) / spread)
    assert Target(value, spread).cost(measured) == pytest.approx(expected, rel=1e-12)


@given(POSITIVE, POSITIVE, POSITIVE)
def test_ratio_cost_against_the_formula(value, spread, measured):
    measured = max(measured, 1e-6 * value)
    z = math.log(measured / value) / math.log(1 + spread / value)
    # Where the spread is small beside the value, 1 + spread / value has few digits left.
    assert Target(value, spread).ratio_cost(measured) == pytest.approx(
        h(z), rel=1e-12 + 1e-15 * value / spread, abs=1e-12
    )


@given(st.floats(1e-2, 1e2), st.floats(1e-2, 1e2))
def test_one_spread_off_costs_1(value, spread):
    target = Target(value, spread)
    off = pytest.approx(1, rel=1e-9)
    assert target.cost(value + spread) == off
    assert target.cost(value - spread) == off
    assert target.ratio_cost(value + spread) == off
    assert target.ratio_cost(value / (1 + spread / value)) == off
    assert target.cost(value) == target.ratio_cost(value) == 0


@pytest.mark.parametrize("method", ["cost", "ratio_cost"])
def test_the_cost_bends_without_a_step_or_an_edge(method):
    cost = getattr(Target(1.0, 1.0), method)
    bend, step = (3.0, 1e-6) if method == "cost" else (4.0, 1e-6)
    assert cost(bend) == pytest.approx(4.0)
    before, after = cost(bend) - cost(bend - step), cost(bend + step) - cost(bend)
    assert before == pytest.approx(after, rel=1e-5)


def test_what_is_not_positive_is_far_off_by_ratio_and_no_further():
    target = Target(0.06, 0.02)
    z = math.log(1e-6) / math.log(0.08 / 0.06)
    for value in (-1.0, 0.0, 1e-300, 0.06e-6):
        assert target.ratio_cost(value) == pytest.approx(4 * abs(z) - 4, rel=1e-12)
    assert target.ratio_cost(1e-5) < target.ratio_cost(0.0)


@pytest.mark.parametrize("value", [0.0, -0.5])
def test_ratios_to_what_is_not_positive_mean_nothing(value):
    with pytest.raises(UsageError, match=r"the target -?0(\.5)?\+-1 must have a positive value"):
        Target(value, 1).ratio_cost(1.0)


@given(ANY, ANY_POSITIVE, ANY)
@example(1e300, 5e-324, 1.0)
@example(5e-324, 1e300, -1.0)
@example(-1.7e308, 1.0, 1.7e308)
def test_costs_are_finite_whatever_the_numbers(value, spread, measured):
    target = Target(value, spread)
    assert 0 <= target.cost(measured) < math.inf
    if target.value > 0:
        assert 0 <= target.ratio_cost(measured) < math.inf


def test_not_a_number_stays_what_it_is():
    # So that the objective that measured it is told, rather than the search misled.
    assert math.isnan(Target(1, 1).cost(math.nan))
    assert math.isnan(Target(1, 1).ratio_cost(math.nan))
