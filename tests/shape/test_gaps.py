"""The least distance between two parts against all distances."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.gaps import least_distance


@given(st.integers(0, 2**32), st.sampled_from([2, 3, 40]), st.floats(0, 9))
@settings(max_examples=80, deadline=None)
def test_the_least_of_all_distances(seed, n, apart):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, n, 60).astype(np.int32)
    # Parts lie side by side, from one upon the other to far from each other.
    points = rng.normal(size=(60, 3)) + apart * labels[:, None]
    found = least_distance(points, labels, 0, 1)
    least = math.inf
    for one in points[labels == 0]:
        for two in points[labels == 1]:
            x, y, z = (one - two).tolist()
            least = min(least, math.sqrt(x * x + y * y + z * z))
    assert found == least == least_distance(points, labels, 1, 0)
