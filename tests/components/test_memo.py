"""The memory: what it keeps, what it forgets, and that it says so."""

from __future__ import annotations

from collections import OrderedDict

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.memo import Memo


def test_a_value_is_computed_once():
    memo, calls = Memo(), []
    for _ in range(3):
        assert memo.get("key", lambda: calls.append(1) or "value") == "value"
    assert calls == [1]
    assert (memo.hits, memo.misses, len(memo)) == (2, 1, 1)


def test_what_was_least_recently_used_is_forgotten_first():
    memo = Memo(size=2)
    memo.get("a", lambda: 1)
    memo.get("b", lambda: 2)
    memo.get("a", lambda: pytest.fail("a is known"))
    memo.get("c", lambda: 3)  # b goes: a was used since
    memo.get("a", lambda: pytest.fail("a is known still"))
    assert memo.get("b", lambda: 4) == 4
    assert len(memo) == 2


def test_a_memory_of_no_size_keeps_nothing():
    memo = Memo(size=0)
    assert [memo.get("a", lambda value=value: value) for value in (1, 2)] == [1, 2]
    assert (memo.hits, memo.misses, len(memo)) == (0, 2, 0)


@pytest.mark.parametrize("value", [None, 0.0, False])
def test_values_that_count_as_false_are_kept_like_others(value):
    memo = Memo()
    assert memo.get("a", lambda: value) is value
    assert memo.get("a", lambda: pytest.fail("known")) is value


def test_looking_computes_nothing_and_counts_as_use():
    memo = Memo(size=2)
    assert memo.known("a") is None
    assert memo.get("a", lambda one, two: one + two, 1, 2) == 3
    memo.get("b", lambda: 0.0)
    assert memo.known("a") == 3
    memo.get("c", lambda: 5)  # b goes: a was used since
    assert (memo.known("b"), memo.known("a"), memo.known("c")) == (None, 3, 5)
    assert (memo.hits, memo.misses) == (3, 3)


def test_a_failure_is_not_kept():
    memo = Memo()
    with pytest.raises(ZeroDivisionError):
        memo.get("a", lambda: 1 / 0)
    assert memo.get("a", lambda: 7) == 7


def test_computing_a_value_may_ask_for_others():
    memo = Memo(size=1)
    assert memo.get("a", lambda: memo.get("b", lambda: 1) + 1) == 2
    assert len(memo) == 1


@given(st.integers(0, 5), st.lists(st.integers(0, 8), max_size=60))
def test_it_behaves_like_a_list_of_recent_keys(size, asked):
    memo, recent = Memo(size=size), OrderedDict()
    for number, key in enumerate(asked):
        known = key in recent
        expected = recent.pop(key) if known else number
        recent[key] = expected
        while len(recent) > size:
            recent.popitem(last=False)
        assert memo.get(key, lambda number=number: number) == expected
    assert memo.hits + memo.misses == len(asked)
    assert len(memo) == len(recent)
