"""The checks of vectorised forms and bounds fail for those that are broken, and say how."""

from __future__ import annotations

import pytest

from moseg_core.components.discovery.specs import ObjectiveSpec
from tests.testing.broken.vectorized import BROKEN
from tests.testing.outcomes import assert_fails_only, failures, outcomes

CHECK, BOUND = BROKEN


def spec(name):
    return ObjectiveSpec(name="own", target=f"tests.testing.broken.vectorized:{name}")


def test_a_form_that_disagrees_fails_this_check_and_no_other():
    assert_fails_only(CHECK, BROKEN[CHECK])


def test_last_digits_that_depend_on_other_calls_fail_this_check_and_no_other():
    assert_fails_only(CHECK, spec("looks_at_its_neighbours"))
    assert "to the last bit" in failures(spec("looks_at_its_neighbours"))[CHECK]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("compares_with_the_others", "it and its vectorised form were asked about the same parts"),
        ("sums_up", "an array of 2 values, one for each"),
        ("writes_to_areas", "write to no array of the parts"),
        ("has_other_defaults", "missing 1 required keyword-only argument: 'factor'"),
    ],
)
def test_what_is_said_of_forms_that_are_broken_otherwise(name, said):
    assert said in failures(spec(name))[CHECK]


def test_one_that_agrees_passes():
    found = {outcome.check: outcome.status for outcome in outcomes(spec("agrees"))}
    assert found[CHECK] == "passed"
    assert "failed" not in found.values()


def test_objectives_without_a_vectorised_form_are_passed_over():
    plain = ObjectiveSpec(name="own", target="tests.testing.broken.objectives:counts_pieces")
    assert {outcome.check: outcome.status for outcome in outcomes(plain)}[CHECK] == "skipped"


def test_a_bound_that_is_above_the_value_fails_this_check_and_no_other():
    assert_fails_only(BOUND, BROKEN[BOUND])
    assert "expected at most its value" in failures(BROKEN[BOUND])[BOUND]


def test_a_bound_is_a_number_for_each_call():
    said = failures(spec("bounds_all_at_once"))[BOUND]
    assert "its lower bound was asked" in said
    assert "an array of 2 values, one for each" in said


def test_a_bound_that_holds_passes():
    found = {outcome.check: outcome.status for outcome in outcomes(spec("keeps_its_bound"))}
    assert found[BOUND] == "passed"
    assert "failed" not in found.values()
    assert {o.check: o.status for o in outcomes(spec("agrees"))}[BOUND] == "skipped"
