from __future__ import annotations

import math

import numpy as np
from moseg_objectives_basic.arrays import row_sums


def test_sums_are_rounded_once_and_each_is_of_its_own_row():
    values = np.random.default_rng(0).normal(size=(7, 40)) * 10.0 ** np.arange(-20, 20)
    assert row_sums(values).tolist() == [math.fsum(row) for row in values]
    assert row_sums(values[:0]).shape == (0,)
