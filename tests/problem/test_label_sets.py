"""Labels with counts: the sets that they stand for, and what is refused."""

from __future__ import annotations

import itertools

import pytest

from moseg_core.errors import UsageError
from moseg_core.problem.label_sets import (
    MOST_SETS,
    CountedLabel,
    declared_labels,
    is_counted,
    label_sets,
    labels_of_variants,
    named_sets,
    read_label,
    set_text,
)


@pytest.mark.parametrize(
    ("text", "names", "least", "again"),
    [
        ("leg", ("leg",), 1, "leg"),
        ("leg2", ("leg2",), 1, "leg2"),
        ("leg{4}", ("leg1", "leg2", "leg3", "leg4"), 4, "leg{4}"),
        ("leg{ 2 .. 3 }", ("leg1", "leg2", "leg3"), 2, "leg{2..3}"),
        ("tail{0..1}", ("tail",), 0, "tail{0..1}"),
        ("tail{1}", ("tail",), 1, "tail"),
        ("leg3{0..1}", ("leg3",), 0, "leg3{0..1}"),
        ("arm_{0..2}", ("arm_1", "arm_2"), 0, "arm_{0..2}"),
    ],
)
def test_a_label_with_a_count(text, names, least, again):
    label = read_label(text)
    assert (label.names, label.least, str(label)) == (names, least, again)
    assert is_counted(text) == ("{" in text)
    assert read_label(again) == label


@pytest.mark.parametrize("text", ["leg{3..2}", "leg{0}", "leg{0..0}"])
def test_counts_that_make_no_sense(text):
    with pytest.raises(UsageError, match=r"from the least to the greatest number, which is 1"):
        read_label(text)


def test_numbers_do_not_run_into_each_other():
    with pytest.raises(UsageError, match=r"'leg2\{3\}': the numbers would run into each other"):
        read_label("leg2{3}")


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        (["leg{2}", "leg1"], "label 'leg1' is given twice by 'leg{2}' and 'leg1'"),
        (["leg{2}", "leg{0..1}", "leg{3}"], "label 'leg1' is given twice by 'leg{2}' and 'leg{3}'"),
        (["a", "b", "a"], "label 'a' is given twice; labels are distinct"),
    ],
)
def test_names_stay_distinct_after_expansion(labels, message):
    with pytest.raises(UsageError) as caught:
        declared_labels(labels)
    assert message in str(caught.value)


def test_all_combinations_by_counting():
    labels = ["torso", "leg{2..4}", "horn{0..2}", "tail{0..1}"]
    expected = set()
    for legs, horns, tail in itertools.product((2, 3, 4), (0, 1, 2), (0, 1)):
        names = ["torso", *(f"leg{k + 1}" for k in range(legs))]
        names += [f"horn{k + 1}" for k in range(horns)] + ["tail"] * tail
        expected.add(tuple(names))
    found = label_sets(labels)
    assert len(found) == len(set(found)) == 18
    assert set(found) == expected


def test_a_set_without_labels_is_none():
    assert label_sets(["a{0..1}", "b{0..1}"]) == (("b",), ("a",), ("a", "b"))


def test_too_many_sets_are_refused_with_what_to_do():
    most = MOST_SETS // 2 - 1
    assert len(label_sets([f"leg{{0..{most}}}", "tail{0..1}"])) == MOST_SETS - 1  # none is empty
    with pytest.raises(UsageError, match=r"stand for 36 label sets, .* the 24 .* variants ="):
        label_sets(["leg{0..5}", "arm{0..5}"])


def test_labels_follow_from_variants():
    variants = [["torso", "leg{2}", "horn"], ["torso", "leg{4}", "tail"], ["torso", "leg{3}"]]
    labels = labels_of_variants(variants)
    assert labels == ("torso", "leg{2..4}", "horn{0..1}", "tail{0..1}")
    assert label_sets(labels, variants) == (
        ("torso", "leg1", "leg2", "horn"),
        ("torso", "leg1", "leg2", "leg3", "leg4", "tail"),
        ("torso", "leg1", "leg2", "leg3"),
    )


def test_one_of_several_bears_its_number():
    variants = [["body", "arm{1}"], ["body", "arm{2}"]]
    assert label_sets(labels_of_variants(variants), variants)[0] == ("body", "arm1")


def test_a_variant_may_have_counts_and_names_of_declared_labels():
    labels = ["torso", "leg{0..4}", "tail{0..1}"]
    assert label_sets(labels, [["tail", "torso", "leg1", "leg2"], ["torso", "leg{3..4}"]]) == (
        ("torso", "leg1", "leg2", "tail"),
        ("torso", "leg1", "leg2", "leg3"),
        ("torso", "leg1", "leg2", "leg3", "leg4"),
    )


@pytest.mark.parametrize(
    ("variant", "message"),
    [
        (["torso", "leg{5}"], "variants: 'leg{5}' is more than the labels allow, 'leg{2..4}'"),
        (["torso", "leg{1}"], "of 'leg{2..4}' it has leg1; change the count"),
        (["leg{2}"], "of 'torso' it has none; change the count, or leave labels out"),
        (["torso", "leg2", "leg3"], "of 'leg{2..4}' it has leg2, leg3"),
        (["torso", "leg{2}", "tial"], "unknown label 'tial'; did you mean 'tail'?"),
    ],
)
def test_variants_that_the_labels_do_not_allow(variant, message):
    with pytest.raises(UsageError) as caught:
        label_sets(["torso", "leg{2..4}", "tail{0..1}"], [variant])
    assert message in str(caught.value)


def test_sets_that_are_named_need_only_be_declared():
    labels = ["torso", "leg{2..4}", "tail{0..1}"]
    assert named_sets(["leg{1}", "tail"], labels) == (("leg1", "tail"),)
    assert named_sets(["leg{2..3}"], labels) == (("leg1", "leg2"), ("leg1", "leg2", "leg3"))
    assert named_sets(["torso", "leg{5}"], labels) is None
    assert named_sets(["torso", "wing"], labels) is None


def test_a_set_in_words():
    labels = ["torso", "leg{2..4}", "tail{0..1}"]
    assert set_text(["tail", "leg1", "leg2", "torso"], labels) == "torso, leg{2}, tail"
    assert CountedLabel(stem="leg", least=4, most=4).names == read_label("leg{4}").names
