"""Pairs of labellings made up at random, for all measures alike."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st


@st.composite
def pairs_of_labellings(draw):
    """Two labellings of a few elements, with weights, some of them 0 but not all."""
    size = draw(st.integers(2, 20))
    # Few labels and many, near each other and far apart: numbered by counting and by sorting.
    label = st.one_of(st.integers(-3, 4), st.sampled_from([-(2**62), -1, 0, 5, 2**62]))
    labels = st.lists(label, min_size=size, max_size=size)
    weight = st.one_of(st.just(0.0), st.floats(0.01, 100.0))
    weights = draw(st.lists(weight, min_size=size, max_size=size).filter(any))
    return np.array(draw(labels)), np.array(draw(labels)), np.array(weights)


def shuffled(arrays, seed):
    """The arrays with their elements in another order, the same for all."""
    order = np.random.default_rng(seed).permutation(len(arrays[0]))
    return [array[order] for array in arrays]


def renumbered(labels, seed):
    """The same segmentation under other numbers."""
    distinct, place = np.unique(labels, return_inverse=True)
    return np.random.default_rng(seed).permutation(3 * len(distinct))[place] - 2
