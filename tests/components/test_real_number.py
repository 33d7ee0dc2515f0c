"""What counts as a real number."""

from __future__ import annotations

import math
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from moseg_core.components.real_number import described, real_number


@pytest.mark.parametrize(
    ("value", "number"),
    [
        (0.5, 0.5),
        (3, 3.0),
        (Fraction(1, 4), 0.25),
        (np.float16(0.5), 0.5),
        (np.float32(0.5), 0.5),
        (np.float64(0.5), 0.5),
        (np.longdouble(0.5), 0.5),
        (np.int8(-3), -3.0),
        (np.uint64(7), 7.0),
        (np.array(0.5), 0.5),
        (np.array([[0.5]], np.float32), 0.5),
        (math.inf, math.inf),
        (10**400, math.inf),
    ],
)
def test_numbers(value, number):
    found = real_number(value)
    assert found == number
    assert type(found) is float


@pytest.mark.parametrize(
    "value",
    [
        *("0.5", b"0.5", None, True, np.True_, 1j, np.complex128(1), Decimal("0.5")),
        *([0.5], (), np.ones(2), np.empty(0), np.array("0.5"), np.array(None), np.array(True)),
        *(np.datetime64(1, "s"), np.timedelta64(1, "s"), object(), float),
    ],
    ids=lambda value: type(value).__name__,
)
def test_everything_else(value):
    assert real_number(value) is None
    assert type(value).__name__ in described(value) or value is None


def test_what_is_nan_is_a_number():
    assert math.isnan(real_number(np.float32("nan")))


def test_descriptions_are_short_and_one_line():
    assert len(described(np.arange(1000.0))) < 130
    assert "\n" not in described(np.zeros((9, 9)))
