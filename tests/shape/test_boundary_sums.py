"""Sums over links against a literal loop."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.boundary_sums import sum_boundaries


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_sums_are_those_of_a_loop_over_parts(seed, n):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, n, (2, 12)).astype(np.int32)
    first = rng.integers(0, 11, 30).astype(np.int32)
    second = (first + rng.integers(1, 12 - first)).astype(np.int32)
    values = rng.integers(-9, 9, 30).astype(float)  # whole, so that sums are exact
    whole, between = np.full((2, n), 7.0), np.full((2, n, n), 7.0)
    sum_boundaries(labels, first, second, values, whole, between)
    for b, p, q in np.ndindex(2, n, n):
        pairs = [{labels[b, i], labels[b, j]} for i, j in zip(first, second, strict=True)]
        mine = [v for pair, v in zip(pairs, values, strict=True) if pair == {p, q} and p != q]
        assert between[b, p, q] == sum(mine)
        assert whole[b, p] == between[b, p].sum()
