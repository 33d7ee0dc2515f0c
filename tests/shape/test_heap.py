"""The heap of the kernels against Python's own."""

from __future__ import annotations

import heapq

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.heap import push, sift

ENTRIES = st.lists(st.tuples(st.integers(0, 4), st.integers(0, 9)), min_size=1, max_size=40)


def pushed(entries):
    """(keys, codes, count) of a heap of some entries."""
    key, code, count = np.empty(len(entries)), np.empty(len(entries), np.int64), 0
    for k, c in entries:
        count = push(key, code, count, float(k), c)
    return key, code, count


@given(ENTRIES)
@settings(deadline=None)
def test_entries_come_out_by_key_then_by_code(entries):
    key, code, count = pushed(entries)
    assert count == len(entries)
    found = []
    while count:
        found.append((key[0], code[0]))
        count -= 1
        if count:
            sift(key, code, count, key[count], code[count])  # the last in place of the first
    assert found == sorted(entries)


@given(ENTRIES, ENTRIES)
@settings(deadline=None)
def test_an_entry_in_place_of_the_least(entries, others):
    key, code, count = pushed(entries)
    reference = list(entries)
    heapq.heapify(reference)
    for k, c in others:
        assert (key[0], code[0]) == heapq.heapreplace(reference, (k, c))
        sift(key, code, count, float(k), c)
    assert sorted(zip(key, code, strict=True)) == sorted(reference)
