"""Pairs of labellings made up at random, for all measures alike."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st


@st.composite
def pairs_of_labellings(draw):
    """Two labellings of a few elements, with weights, some of them 0 but not all."""
    size = draw(st.integers(2, 20))
    # Few labels and many, near each other and far apart: numbered by counting and by sorting.
    # -1 is none of them: it says that there is no label.
    near = st.integers(-3, 4).filter(lambda label: label != -1)
    label = st.one_of(near, st.sampled_from([-(2**62), -2, 0, 5, 2**62]))
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
    numbers = np.random.default_rng(seed).permutation(3 * len(distinct))[place] - 2
    return np.where(numbers == -1, 3 * len(distinct), numbers)


@st.composite
def partly_labelled_pairs(draw):
    """The same, with -1 in some places of either, and the elements that both still label."""
    first, second, weights = draw(pairs_of_labellings())
    known = np.ones(len(first), bool)
    for labels in (first, second):
        missing = np.array(draw(st.lists(st.booleans(), min_size=len(first), max_size=len(first))))
        labels[missing] = -1
        known &= ~missing
    return first, second, weights, known
