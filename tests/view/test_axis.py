"""Places on an axis, and round numbers beside it."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.view.axis import Axis, linear_axis, log_axis

values = st.lists(st.floats(-1e280, 1e280), min_size=1, max_size=6)
positive = st.lists(st.floats(1e-279, 1e279), min_size=1, max_size=6)


def texts(axis):
    return [text for _, text in axis.ticks]


@pytest.mark.parametrize(
    ("given_values", "expected"),
    [
        ([0, 10], ["0", "2", "4", "6", "8", "10"]),
        ([-1, 1], ["-1.0", "-0.5", "0.0", "0.5", "1.0"]),
        ([0.12, 0.13], ["0.120", "0.122", "0.124", "0.126", "0.128", "0.130"]),
        ([0, 3e9], ["0", "1e9", "2e9", "3e9"]),
        ([0, 2.5e-12], ["0", "5e-13", "1.0e-12", "1.5e-12", "2.0e-12", "2.5e-12"]),
        ([7, 7], ["6.5", "7.0", "7.5"]),
        ([0, 0], ["-1.0", "-0.5", "0.0", "0.5", "1.0"]),
        ([], ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
    ],
)
def test_linear_ticks_are_round_numbers(given_values, expected):
    assert texts(linear_axis(given_values)) == expected


def test_whole_numbers_have_no_ticks_between():
    assert texts(linear_axis([1, 2], most=10, whole=True)) == ["1", "2"]
    assert texts(linear_axis([4], most=10, whole=True)) == ["3", "4", "5"]
    assert texts(linear_axis([1, 90], most=10, whole=True)) == [str(k) for k in range(0, 91, 10)]


@pytest.mark.parametrize(
    ("given_values", "expected"),
    [
        ([0.03, 2], ["0.05", "0.1", "0.2", "0.5", "1", "2"]),
        ([1e-6, 0.2], ["1e-6", "1e-5", "1e-4", "0.001", "0.01", "0.1"]),
        ([5, 5], ["2", "5", "10"]),
        ([1, 1e16], ["1", "1000", "1e6", "1e9", "1e12", "1e15"]),
    ],
)
def test_log_ticks_are_powers_of_ten(given_values, expected):
    assert texts(log_axis(given_values)) == expected


def test_places():
    axis = linear_axis([2.0, 4.0])
    # The values fill all of the axis but its margins, of 4 % of their range at either end.
    assert axis.place(2.0) == pytest.approx(0.04 / 1.08)
    assert axis.place(3.0) == pytest.approx(0.5)
    assert axis.place(4.0) == pytest.approx(1.04 / 1.08)
    assert Axis(low=1e-2, high=1e2, log=True).place(0.1) == pytest.approx(0.25)


@given(values)
def test_linear_axes_hold_their_values_and_say_where_they_are(numbers):
    axis = linear_axis(numbers)
    assert all(-1e-9 <= axis.place(number) <= 1 + 1e-9 for number in numbers)
    check_ticks(axis, least=2)


@given(positive)
def test_log_axes_hold_their_values_and_say_where_they_are(numbers):
    axis = log_axis(numbers)
    assert all(-1e-9 <= axis.place(number) <= 1 + 1e-9 for number in numbers)
    check_ticks(axis, least=1)


def check_ticks(axis, *, least):
    assert least <= len(axis.ticks) <= 12
    places = [axis.place(value) for value, _ in axis.ticks]
    assert all(0 <= place <= 1 for place in places)
    gaps = [after - before for before, after in itertools.pairwise(places)]
    assert all(gap > 0.01 for gap in gaps)
    for value, text in axis.ticks:
        assert len(text) <= 14
        # What is written differs from what is meant by far less than the ticks from each other.
        assert math.isclose(axis.place(float(text)), axis.place(value), abs_tol=1e-3)
