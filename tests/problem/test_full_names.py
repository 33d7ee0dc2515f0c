"""Names that have become ambiguous, in recipes of bundles and in results."""

from __future__ import annotations

import pytest

from moseg_core.components.chosen import Choice
from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import ConstraintSpec, ObjectiveSpec, SeederSpec
from moseg_core.errors import ExpressionError, UsageError
from moseg_core.problem.full_names import (
    choice_in_full,
    constraint_in_full,
    expression_in_full,
    meant_by_bundle,
    meant_by_result,
    statement_in_full,
)
from moseg_core.problem.statement import Statement


def bundle(name, *specs):
    components = tuple(Component(name, f"moseg-{name} 1.0", spec) for spec in specs)
    return Bundle(name, f"moseg-{name}", "1.0", name, components)


def objective(name):
    return ObjectiveSpec(name=name, target="nowhere:f")


SPECS = [
    ConstraintSpec(name="mirror", target="nowhere:f"),
    SeederSpec(name="far", target="nowhere:f"),
]
CROWD = Registry(
    [
        bundle("ours", objective("narrow"), objective("flat"), *SPECS),
        bundle("theirs", objective("narrow"), objective("wide"), *SPECS),
        bundle("third", objective("wide")),
    ]
)
USED = {"ours:narrow", "ours:mirror", "ours:far"}
MEANINGS = [meant_by_bundle("ours", CROWD), meant_by_result(USED, CROWD)]


@pytest.mark.parametrize("meaning", MEANINGS, ids=["bundle", "result"])
@pytest.mark.parametrize(
    ("text", "full"),
    [
        ("3*narrow( a ) - flat(b)", "3*ours:narrow(a) - flat(b)"),
        ("flat( a )", "flat( a )"),
        ("theirs:narrow( a )", "theirs:narrow( a )"),
        ('narrow(a, k="x,y") @ mds', 'ours:narrow(a, k="x,y") @ mds'),
        ("gone(a)", "gone(a)"),
    ],
)
def test_only_ambiguous_names_are_replaced(meaning, text, full):
    assert expression_in_full(text, meaning) == full
    assert expression_in_full(full, meaning) == full


@pytest.mark.parametrize("meaning", MEANINGS, ids=["bundle", "result"])
def test_constraints_and_components_too(meaning):
    assert constraint_in_full("mirror(b, a, plane=x)", meaning) == "ours:mirror(b, a, plane=x)"
    assert constraint_in_full("gone( a )", meaning) == "gone( a )"
    far = Choice("far", {"rounds": 3})
    assert choice_in_full(far, "seeder", meaning) == Choice("ours:far", {"rounds": 3})
    assert choice_in_full(far, "labeler", meaning) == far


def test_what_is_ambiguous_to_a_bundle_itself_is_pointed_at():
    meaning = meant_by_bundle("ours", CROWD)
    with pytest.raises(ExpressionError) as caught:
        expression_in_full("flat(a) + wide(b)", meaning)
    assert (
        caught.value.reason == "objective 'wide' is ambiguous; say which: theirs:wide, third:wide"
    )
    assert caught.value.text[caught.value.start : caught.value.stop] == "wide"
    with pytest.raises(UsageError, match="ambiguous"):
        choice_in_full(Choice("far"), "seeder", meant_by_bundle("third", CROWD))


def test_a_result_that_does_not_list_a_component_leaves_its_name_alone():
    assert expression_in_full("narrow(a)", meant_by_result({"ours:flat"}, CROWD)) == "narrow(a)"
    both = meant_by_result({"ours:narrow", "theirs:narrow"}, CROWD)
    assert expression_in_full("narrow(a)", both) == "narrow(a)"


def test_a_name_that_another_component_has_by_now_is_not_taken_for_it():
    meaning = meant_by_result({"python:narrow"}, CROWD)
    with pytest.raises(ExpressionError, match="objective 'narrow' was 'python:narrow' when the"):
        expression_in_full("narrow(a)", meaning)


def test_what_will_be_replaced_is_not_looked_at():
    stated = Statement(labels=("a",), minimize="?", constraints=("<lambda>",))
    found = statement_in_full(
        stated, meant_by_result(set(), CROWD), leave={"minimize", "constraints"}
    )
    assert found == stated
