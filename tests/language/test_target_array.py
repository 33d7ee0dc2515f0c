"""Costs of tables of values: to the last bit those of each value alone."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from moseg_core import Target, TargetArray
from moseg_core.errors import UsageError

ANY = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(1e-6, 1e6)
COLUMNS = st.lists(
    st.tuples(ANY, st.floats(min_value=5e-324, max_value=1e300), st.booleans()), min_size=1
)


@given(COLUMNS, st.data())
@example([(5e-324, 5e-324, True), (1.0, 2.0, False)], None)
def test_costs_of_a_table_are_those_of_each_value(columns, data):
    targets = tuple(Target(abs(v) or 1.0 if ratio else v, s) for v, s, ratio in columns)
    array = TargetArray(targets, tuple(ratio for _, _, ratio in columns))
    one = st.one_of(ANY, POSITIVE)
    rows = st.lists(st.tuples(*(one for _ in targets)), max_size=4)
    values = [(0.0, 0.0), (3.0, 9.0)] if data is None else data.draw(rows)
    with np.errstate(over="ignore"):  # as far off as can be
        found = array.costs(np.array(values, float).reshape(-1, len(targets)))
    assert found.shape == (len(values), len(targets))
    alone = [
        [t.ratio_cost(v) if ratio else t.cost(v) for t, ratio, v in zip(*row, strict=True)]
        for row in ((targets, array.by_ratio, values_of_row) for values_of_row in values)
    ]
    assert found.tolist() == alone


@pytest.mark.parametrize("by_ratio", [False, True])
def test_values_that_are_no_numbers_or_not_positive(by_ratio):
    target = Target(0.1, 0.1)
    array = TargetArray((target,), (by_ratio,))
    cost = target.ratio_cost if by_ratio else target.cost
    values = [0.0, -1.0, 1e-9, math.inf]
    assert array.costs([[v] for v in values]).tolist() == [[cost(v)] for v in values]
    # So that the objective that measured it is told, rather than the search misled.
    assert np.isnan(array.costs([[0.1], [math.nan]])).tolist() == [[False], [True]]


def test_values_are_not_written_to():
    values = np.array([[0.2, 12.0]])
    values.flags.writeable = False
    TargetArray((Target(0.1, 0.1), Target(10, 2)), (True, False)).costs(values)
    assert values.tolist() == [[0.2, 12.0]]


def test_ratios_to_what_is_not_positive_mean_nothing():
    pair = Target(1, 1), Target(-1, 1)
    with pytest.raises(UsageError, match=r"the target -1\+-1 must have a positive value"):
        TargetArray(pair, (True, True))
    assert TargetArray(pair, (True, False)).costs([[1.0, -1.0]]).tolist() == [[0.0, 0.0]]
