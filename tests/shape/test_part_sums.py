"""Sums and hashes of parts: equal to a plain loop to the last bit, and about their members only."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.part_sums import (
    find_empty,
    hash_elements,
    summarize_field,
    summarize_parts,
)
from tests.references import membership_hash

HASHES = [
    [8447903541665901379, 4365002077101263283],
    [15757075719729598363, 14647117497964623384],
    [1961750202426094747, 1807842579671483761],
]
"""Of the elements {1, 2}, {0, 3} and {4}."""


def summarize(labels, areas, first, second, n):
    """The sums of a labelling, which comes second of two."""
    both = np.array([labels[::-1], labels], np.int32)
    counts = np.full((2, n), 9, np.int64)
    hashes = np.full((2, n, 2), 9, np.uint64)
    moments = np.full((2, n, 10), 9.0)
    of_elements = np.full((len(labels), 2), 9, np.uint64)
    hash_elements(of_elements)
    summarize_parts(both, areas, first, second, of_elements, counts, hashes, moments)
    return counts[1], hashes[1], moments[1]


def hashes_of(labels, n):
    size = len(labels)
    zeros = np.zeros
    return summarize(labels, zeros(size), zeros((size, 3)), zeros((size, 6)), n)[1]


@st.composite
def labelled(draw):
    """Labels, areas, first and second moments of very different sizes, and a number of parts."""
    size, n = draw(st.integers(1, 60)), draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    wide = 10.0 ** rng.uniform(-12, 4, (size, 1))
    rows = rng.normal(size=(size, 10)) * wide
    return rng.integers(0, n, size), np.abs(rows[:, 0]), rows[:, 1:4], rows[:, 4:], n


@given(labelled())
@settings(max_examples=80, deadline=None)
def test_the_sums_are_those_of_a_plain_loop_to_the_last_bit(case):
    labels, areas, first, second, n = case
    counts, hashes, moments = summarize(*case)
    for k in range(n):
        members = [f for f in range(len(labels)) if labels[f] == k]
        sums = [0.0] * 10
        for f in members:
            for j, value in enumerate([areas[f], *first[f], *second[f]]):
                sums[j] += float(value)
        assert counts[k] == len(members)
        assert moments[k].tolist() == sums
        assert tuple(hashes[k].tolist()) == membership_hash(members)


@given(labelled(), st.randoms(use_true_random=False))
@settings(max_examples=60, deadline=None)
def test_what_is_known_of_a_part_does_not_depend_on_the_others(case, random):
    labels, areas, first, second, n = case
    before = summarize(*case)
    others = np.array([k if k == 0 else random.randint(1, 7) for k in labels])
    after = summarize(others, areas, first, second, 8)
    for one, two in zip(before, after, strict=True):
        assert one[0].tobytes() == two[0].tobytes()
    # Nor on the number that the part goes by.
    swapped = summarize(np.where(labels == 0, n, labels), areas, first, second, n + 1)
    for one, two in zip(before, swapped, strict=True):
        assert one[0].tobytes() == two[n].tobytes()


def test_every_set_of_twelve_elements_has_a_hash_of_its_own():
    labels = np.array(list(itertools.product([0, 1], repeat=12)))
    first, second = set(), set()
    for row in labels:
        hashes = hashes_of(row, 2)[1].tolist()
        first.add(hashes[0])
        second.add(hashes[1])
    # Each half alone tells the sets apart already.
    assert len(first) == len(second) == len(labels)


@given(st.integers(0, 2**32), st.integers(2, 3000))
@settings(max_examples=60, deadline=None)
def test_random_sets_that_differ_have_hashes_that_differ(seed, size):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, 2, size)
    changed = labels.copy()
    changed[rng.integers(0, size, 2)] ^= 1
    same = (labels == changed).all()
    one, two = hashes_of(labels, 2), hashes_of(changed, 2)
    assert ((one == two).all(axis=1) == same).all()
    assert ((one == two) == same).all()


def test_neighbouring_elements_swapped_change_the_hash():
    # A sum of unmixed numbers would not see that 1 and 4 became 2 and 3.
    assert (
        hashes_of([0, 1, 0, 0, 1, 0], 2)[1].tolist() != hashes_of([0, 0, 1, 1, 0, 0], 2)[1].tolist()
    )


def test_the_hash_is_the_same_in_every_process():
    # The first halves of single elements are the published outputs of SplitMix64 for the seed 0.
    published = [0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F, 0xF88BB8A8724C81EC]
    assert hashes_of([0, 1, 2, 3], 4)[:, 0].tolist() == published
    assert hashes_of([1, 0, 0, 1, 2], 3).tolist() == HASHES


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_summaries_of_a_field_are_those_of_a_loop_over_the_wanted_parts(seed, n):
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, n, (3, 20)).astype(np.int32)
    weighted, squared, least, greatest = rng.integers(-9, 9, (4, 20)).astype(float)
    areas, wanted = rng.integers(0, 5, (3, n)).astype(float), rng.random((3, n)) < 0.7
    wanted[1] = False
    rows = np.full((3, n, 4), 7.0)
    summarize_field(labels, wanted, weighted, squared, least, greatest, areas, 2.0, rows)
    for b, k in np.ndindex(3, n):
        if not wanted[b, k]:
            assert rows[b, k].tolist() == [7.0] * 4
            continue
        own = labels[b] == k
        extremes = [least[own].min(initial=np.inf), greatest[own].max(initial=-np.inf)]
        assert rows[b, k, 2:].tolist() == extremes
        if areas[b, k] == 0:
            assert np.isnan(rows[b, k, :2]).all()
            continue
        mean = weighted[own].sum() / areas[b, k]
        variance = squared[own].sum() / areas[b, k] - mean**2
        assert rows[b, k, :2].tolist() == [2.0 + mean, max(variance, 0.0) ** 0.5]


@given(st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_parts_without_area_or_extent_are_empty(seed):
    rng = np.random.default_rng(seed)
    moments = rng.integers(0, 4, (5, 10)).astype(float)
    empty = np.zeros(5, np.bool_)
    find_empty(moments, 1.0, 0.5, empty)
    for row, found in zip(moments, empty.tolist(), strict=True):
        if row[0] <= 1.0:
            assert found
        else:
            spread = (row[4] + row[7] + row[9]) / row[0] - ((row[1:4] / row[0]) ** 2).sum()
            assert found == (not spread > 0.5)
