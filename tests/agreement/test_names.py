"""Names given rightly, translated, and mistaken for others."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.agreement import confusion, fold, named_right, renamed
from moseg_core.errors import UsageError

NAMES, TRUTH_NAMES = ["leg1", "leg2", "body", "head1"], ["body", "leg7", "head", "tail"]
KINDS, TRUTH_KINDS = ["leg", "leg", "body", "head"], ["body", "leg", "head", "tail"]


def drawn(seed, size):
    rng = np.random.default_rng(seed)
    return rng.integers(0, 4, size), rng.integers(0, 4, size), rng.uniform(0.1, 5.0, size)


@given(st.integers(0, 2**32), st.integers(1, 20))
@settings(max_examples=60)
def test_the_share_named_right_is_that_of_the_area_under_the_right_name(seed, size):
    labels, truth, areas = drawn(seed, size)
    right = sum(
        area
        for label, true, area in zip(labels, truth, areas, strict=True)
        if KINDS[label] == TRUTH_KINDS[true]
    )
    found = named_right(labels, NAMES, truth, TRUTH_NAMES, areas)
    assert found == pytest.approx(right / areas.sum())


@given(st.integers(0, 2**32), st.integers(1, 20))
@settings(max_examples=60)
def test_elements_without_a_label_on_either_side_do_not_count(seed, size):
    labels, truth, areas = drawn(seed, size)
    rng = np.random.default_rng(seed)
    labels[rng.random(size) < 0.3] = -1
    truth[rng.random(size) < 0.3] = -1
    known = (labels >= 0) & (truth >= 0)
    if not known.any():
        for measure in (named_right, confusion):
            with pytest.raises(UsageError, match="there is nothing to compare"):
                measure(labels, NAMES, truth, TRUTH_NAMES, areas)
        return
    here, there = (labels, truth, areas), (labels[known], truth[known], areas[known])
    right, table = (
        [measure(a, NAMES, b, TRUTH_NAMES, c) for a, b, c in (here, there)]
        for measure in (named_right, confusion)
    )
    assert right[0] == right[1]
    np.testing.assert_array_equal(table[0].areas, table[1].areas)


@pytest.mark.parametrize(
    ("name", "folded"),
    [
        ("leg", "leg"),
        ("leg12", "leg"),
        ("leg1_2", "leg1_"),
        ("007", "007"),
        ("a1b", "a1b"),
        ("leg1/shin2", "leg/shin"),
        ("3/leg3", "3/leg"),
    ],
)
def test_instance_numbers_are_folded(name, folded):
    assert fold(name) == folded


@pytest.mark.parametrize(
    ("rename", "expected"),
    [
        ({}, ["leg", "leg", "body", "head"]),
        ({"leg": "limb"}, ["limb", "limb", "body", "head"]),
        ({"leg1": "arm", "leg": "limb"}, ["arm", "limb", "body", "head"]),
        ({"leg2": "arm3"}, ["leg", "arm", "body", "head"]),  # the truth's names fold as well
        ({"head": "body", "body": "head"}, ["leg", "leg", "head", "body"]),
        ({"head": "leg", "leg": "body"}, ["body", "body", "body", "leg"]),
    ],
)
def test_names_are_translated_all_at_once_the_full_name_first(rename, expected):
    assert renamed(NAMES, rename) == expected


@pytest.mark.parametrize("name", ["leg3", "hed", "tail", ""])
def test_only_names_that_are_there_can_be_translated(name):
    with pytest.raises(UsageError, match=f"unknown label to rename '{name}'; .*(leg|head|body)"):
        renamed(NAMES, {name: "body"})


def test_a_translation_decides_what_is_right():
    labels, truth, areas = np.array([0, 1, 2]), np.array([0, 1, 1]), np.array([1.0, 2.0, 5.0])
    names, true_names = ["front", "rear", "middle"], ["head", "torso"]
    assert named_right(labels, names, truth, true_names, areas) == 0.0
    rename = {"front": "head", "middle": "torso"}
    assert named_right(labels, names, truth, true_names, areas, rename=rename) == 6.0 / 8.0


@given(st.integers(0, 2**32), st.integers(1, 20), st.booleans())
@settings(max_examples=60)
def test_the_confusion_table_holds_every_area_once(seed, size, exchanged):
    labels, truth, areas = drawn(seed, size)
    rename = {"body": "head", "head": "body"} if exchanged else None
    given = renamed(NAMES, rename or {})
    table = confusion(labels, NAMES, truth, TRUTH_NAMES, areas, rename=rename)
    assert table.true_names == ("body", "head", "leg", "tail")
    assert table.given_names == ("body", "head", "leg")
    for row, true in enumerate(table.true_names):
        for column, name in enumerate(table.given_names):
            expected = sum(
                areas[f]
                for f in range(size)
                if TRUTH_KINDS[truth[f]] == true and given[labels[f]] == name
            )
            assert table.areas[row, column] == pytest.approx(expected)
    right = sum(table.areas[table.true_names.index(n), k] for k, n in enumerate(table.given_names))
    named = named_right(labels, NAMES, truth, TRUTH_NAMES, areas, rename=rename)
    assert right / areas.sum() == pytest.approx(named)
