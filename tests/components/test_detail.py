"""Details: said with as many digits as tell something beside the spread."""

from __future__ import annotations

import pytest

from moseg_core.components.detail import Detail
from moseg_core.errors import UsageError
from moseg_core.language import Target


@pytest.mark.parametrize(
    ("value", "expected", "percent", "text"),
    [
        (0.09, Target(0.04, 0.01), True, "q 9 %, typical 4 ± 1"),
        (0.0912, Target(0.0444, 0.0149), True, "q 9.1 %, typical 4.4 ± 1.5"),
        (1.23456, Target(1.1, 0.25), False, "q 1.23, typical 1.10 ± 0.25"),
        (1.23456, Target(1.1, 0.1), False, "q 1.2, typical 1.1 ± 0.1"),
        (-0.0001, Target(0, 1), False, "q 0, typical 0 ± 1"),
        (123.4, Target(500, 123), False, "q 123, typical 500 ± 123"),
        (0.5, Target(0.5, 0.0001), False, "q 0.5000, typical 0.5000 ± 0.0001"),
        (0.98, Target(0.97, 0.0996), False, "q 1.0, typical 1.0 ± 0.1"),
        (0.12345, None, True, "q 12.3 %"),
        (0.12345, None, False, "q 0.123"),
    ],
)
def test_a_detail_in_words(value, expected, percent, text):
    assert str(Detail(name="q", value=value, cost=1.0, expected=expected, percent=percent)) == text


@pytest.mark.parametrize("numbers", [{"value": float("nan")}, {"cost": float("inf")}])
def test_its_numbers_are_finite(numbers):
    with pytest.raises(UsageError, match="of detail 'q' must be finite"):
        Detail(**{"name": "q", "value": 1.0, "cost": 1.0, **numbers})
