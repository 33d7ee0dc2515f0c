"""The distance to one triangle against libigl's, wherever the nearest point is."""

from __future__ import annotations

import igl
import numpy as np
import pytest
from moseg_objectives_basic.triangle_distance import to_triangle


@pytest.mark.parametrize("flattened", [1.0, 1e-6, 0.0])
def test_libigls_distance_to_the_last_bit(flattened):
    rng = np.random.default_rng(0)
    for _ in range(40):
        corners = np.ascontiguousarray(rng.normal(size=(3, 3)) * [1.0, 1.0, flattened])
        points = rng.normal(size=(50, 3)) * rng.choice([0.3, 1.0, 3.0])
        points[:3] = corners
        tree, triangle = igl.AABB(), np.array([[0, 1, 2]])
        tree.init(corners, triangle)
        exact = np.asarray(tree.squared_distance(corners, triangle, points)[0]).reshape(-1)
        found = [to_triangle(*point, corners[None], 0) for point in points]
        np.testing.assert_array_equal(found, exact)
