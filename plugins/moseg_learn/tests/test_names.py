from __future__ import annotations

import pytest
from moseg_learn.names import argument, check_numbers, kind_of, labels_of

from moseg_core import Problem, UsageError


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("leg", "leg"),
        ("leg12", "leg"),
        ("leg_2", "leg"),
        ("leg 2", "leg"),
        ("Leg.002", "Leg"),
        ("left wing", "left_wing"),
        ("head/ear1", "head_ear"),
        ("7", "7"),
        ("größe", "gr_e"),
    ],
)
def test_a_kind_is_a_name_without_its_number_as_a_recipe_may_call_it(name, kind):
    assert kind_of(name) == kind


def test_numbers_tell_kinds_apart_where_that_is_asked_for():
    assert kind_of("finger2", numbers="different") == "finger2"
    with pytest.raises(UsageError, match="'different'"):
        check_numbers("diferent")


def test_a_name_of_which_nothing_is_left_is_refused():
    with pytest.raises(UsageError, match="rename it"):
        kind_of("---")


@pytest.mark.parametrize("kind", ["leg", "finger1", "x_"])
def test_labels_of_a_kind_are_of_that_kind_and_legal(kind):
    labels = labels_of(kind, 3)
    assert len(set(labels)) == 3
    Problem(list(labels), "convex_parts")
    assert {label.rstrip("0123456789").rstrip("_") for label in labels} == {kind.rstrip("_")}


def test_a_glob_stands_for_a_kind_unless_it_would_catch_others():
    assert argument("leg", ["leg1", "leg2"], ["body"]) == "leg*"
    assert argument("leg", ["leg1", "leg2"], ["legroom"]) == "leg1, leg2"
    assert argument("back", ["back"], ["backsupport"]) == "back"
    # 'finger1_*' does not catch those of finger2.
    assert argument("finger1", ["finger1_1", "finger1_2"], ["finger2_1"]) == "finger1_*"
