"""Costs: how many parts are empty comes first, and nothing is worse than the worst."""

from __future__ import annotations

import math
import pickle

from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.cost import WORST, Cost

values = st.floats(allow_nan=False)
costs = st.builds(Cost, st.integers(0, 50), values)


@given(costs, costs)
def test_fewer_empty_parts_win_whatever_the_value(one, two):
    if one.empty != two.empty:
        assert (one < two) == (one.empty < two.empty)
    else:
        assert (one < two) == (one.value < two.value)


@given(st.lists(costs, min_size=1))
def test_the_least_of_several_is_found_by_sorting(several):
    assert min(several) == sorted(several)[0] <= several[0]


@given(costs)
def test_every_cost_is_better_than_the_worst(cost):
    assert cost < WORST
    assert WORST.value == math.inf


@given(
    st.builds(Cost, st.integers(0, 9), st.floats(-1e11, 1e11)),
    st.builds(Cost, st.integers(0, 9), st.floats(-1e11, 1e11)),
)
def test_the_scalar_form_keeps_the_order(one, two):
    if one.empty != two.empty:
        assert (one < two) == (one.scalar < two.scalar)
    elif one.value < two.value:
        assert one.scalar <= two.scalar
    if one.empty == 0:
        assert one.scalar == one.value


def test_a_cost_survives_pickling_as_what_it_is():
    again = pickle.loads(pickle.dumps(Cost(1, -math.inf)))
    assert again == Cost(1, -math.inf)
    assert isinstance(again, Cost)
