from __future__ import annotations

from moseg_learn.label_sets import label_sets_of

from moseg_core import Statement


def test_alike_members_have_plain_labels():
    found = label_sets_of([{"body": 1, "leg": 2}, {"body": 1, "leg": 2}])
    assert found.stated == ("body", "leg1", "leg2")
    assert found.variants == ()


def test_members_that_differ_have_counts_and_variants_the_commonest_first():
    few, many = {"body": 1, "leg": 1}, {"body": 1, "leg": 3, "tail": 1}
    found = label_sets_of([many, few, many])
    assert found.variants == (("body", "leg{3}", "tail"), ("body", "leg{1}"))
    stated = Statement(labels=found.stated, variants=found.variants, minimize="narrow(body)")
    assert stated.label_sets() == (
        ("body", "leg1", "leg2", "leg3", "tail"),
        ("body", "leg1"),
    )


def test_kinds_with_numbers_in_their_names_can_have_counts():
    found = label_sets_of([{"finger1": 1, "palm": 1}, {"finger1": 2, "palm": 1}])
    stated = Statement(labels=found.stated, variants=found.variants, minimize="narrow(palm)")
    assert stated.label_sets() == (
        ("finger1_1", "palm"),
        ("finger1_1", "finger1_2", "palm"),
    )


def test_where_no_example_has_all_kinds_all_of_them_are_a_variant_too():
    horned, tailed = {"body": 1, "horn": 2, "leg": 4}, {"body": 1, "leg": 4, "tail": 1}
    found = label_sets_of([horned, tailed, tailed])
    assert found.variants == (
        ("body", "leg{4}", "tail"),
        ("body", "horn{2}", "leg{4}"),
        ("body", "horn{2}", "leg{4}", "tail"),
    )
    # One that has them all is enough; what all have in another number is no matter.
    assert len(label_sets_of([horned, tailed, horned | tailed]).variants) == 3
    assert len(label_sets_of([horned, horned | {"leg": 2}]).variants) == 2


def test_all_kinds_are_as_many_as_most_have_that_have_any():
    examples = [
        {"a": 1, "handle": 2},
        {"a": 1, "handle": 1, "lid": 1},
        {"a": 1, "handle": 1},
        {"a": 1, "lid": 3, "spout": 1},
    ]
    assert label_sets_of(examples).variants[-1] == ("a", "handle{1}", "lid{1}", "spout")


def test_families_that_have_no_kind_in_common_are_not_mixed():
    boxes, rollers = {"box": 2, "lid": 1}, {"roller": 2, "axle": 1}
    assert label_sets_of([boxes, rollers, boxes]).variants == (
        ("box{2}", "lid"),
        ("axle", "roller{2}"),
    )
