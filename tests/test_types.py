from __future__ import annotations

import numpy as np
import pytest

from moseg_core.types import frozen


def test_a_frozen_array_is_the_same_one_and_cannot_be_changed():
    array = np.zeros(3)
    assert frozen(array) is array
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        array[1:] += 1.0
