"""Sums over links against a literal loop."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.boundary_sums import find_crossings, sum_boundaries


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_sums_are_those_of_a_loop_over_parts(seed, n):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, n, 12).astype(np.int32)
    first = rng.integers(0, 11, 30).astype(np.int32)
    second = (first + rng.integers(1, 12 - first)).astype(np.int32)
    values = rng.integers(-9, 9, 30).astype(float)  # whole, so that sums are exact
    whole, between = np.full(n, 7.0), np.full((n, n), 7.0)
    crossings, sides = np.empty(30, np.int32), np.empty((30, 2), np.int32)
    count = find_crossings(labels, first, second, crossings, sides)
    crossing = np.flatnonzero(labels[first] != labels[second])
    assert crossings[:count].tolist() == crossing.tolist()
    assert sides[:count, 0].tolist() == labels[first[crossing]].tolist()
    assert sides[:count, 1].tolist() == labels[second[crossing]].tolist()
    sum_boundaries(count, crossings, sides, values, whole, between)
    for p in range(n):
        for q in range(n):
            pairs = [{labels[a], labels[b]} for a, b in zip(first, second, strict=True)]
            mine = [v for pair, v in zip(pairs, values, strict=True) if pair == {p, q} and p != q]
            assert between[p, q] == sum(mine)
        assert whole[p] == between[p].sum()
