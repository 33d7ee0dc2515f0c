"""Constraints as they are written: names, labels, parameters, functions."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.components.constraint_function import FunctionConstraint
from moseg_core.components.profile import profiling
from moseg_core.components.protocols import Constraint
from moseg_core.errors import ExpressionError, PluginError, UsageError
from moseg_core.language import Argument, Table, Term
from moseg_core.problem.constraint_calls import bind_constraints
from moseg_core.problem.problem import Problem
from tests.reflections import known, pair

LABELS = ("head", "body", "leg1", "leg2")


def bound(*given, plane=None):
    return bind_constraints(given, LABELS, known(), plane)


def test_a_rule_knows_its_labels_in_the_order_written():
    (rule,) = bound("mirror(leg2, leg1)")
    assert (rule.labels, rule.id, rule.text) == ((3, 2), "test:mirror", "mirror(leg2, leg1)")


def test_a_rule_on_single_labels_is_made_for_each():
    rules = bound("onplane(head, body)", "onplane(leg*)")
    assert [rule.labels for rule in rules] == [(0,), (1,), (2,), (3,)]
    assert rules[0].text == "onplane(head)"


def test_what_a_rule_says_of_itself_gives_the_same_rule_again():
    rules = bound("onplane(head, body, plane=y)", "test:onplane(leg*)", "mirror(body, head)")
    assert rules[0].text == "onplane(head, plane=y)"
    for rule in rules:
        (again,) = bound(rule.text)
        assert (again.id, again.labels, again.parameters) == (rule.id, rule.labels, rule.parameters)


def test_a_rule_takes_parameters_from_a_table():
    tables = Table({"both": {"plane": "y", "share": 0.25}})
    rules = bind_constraints(["tilted(leg*, given=both)"], LABELS, known(), None, tables)
    for rule in rules:
        assert rule.parameters == {"plane": "y", "share": 0.25}
        assert "given=both" in rule.text
    with pytest.raises(ExpressionError, match="there is no table 'both'"):
        bound("tilted(leg*, given=both)")


@given(
    words=st.one_of(
        st.text(), st.sampled_from(["a b", "1.5", "0,0,0,1,0,0", "", "tête", '"', "\\", "none"])
    ),
    share=st.floats(0, 1),
)
def test_any_parameter_reads_back_from_what_a_rule_says_of_itself(words, share):
    term = Term("tilted", (Argument("leg*"),), (("plane", words), ("share", share)))
    for rule in bound(str(term)):
        assert rule.parameters == {"plane": words, "share": share}
        (again,) = bound(rule.text)
        assert (again.id, again.labels, again.parameters) == (rule.id, rule.labels, rule.parameters)


@pytest.mark.parametrize(
    ("text", "message", "place"),
    [
        ("tilted(head, share=x)", "parameter 'share' must be a number, not 'x'", "share"),
        ("tilted(head, plane=y, share=2)", "'share' is 2; allowed is 0 to 1", "share"),
        ("tilted(head, plane=3)", "must be a word, not 3; in quotes it is one: plane=", "plane"),
        ("tilted(head, plain=x)", "unknown parameter 'plain'", "plain"),
    ],
)
def test_a_mistake_in_a_parameter_is_pointed_at(text, message, place):
    with pytest.raises(ExpressionError) as caught:
        bound(text)
    assert message in caught.value.reason
    assert text[caught.value.start : caught.value.stop] == place


def test_a_plane_is_passed_to_those_that_take_one_and_are_not_given_one():
    first, second, third = bound(
        "onplane(head)", "onplane(body, plane=y)", "mirror(leg2, leg1)", plane="x"
    )
    assert (first.parameters, second.parameters) == ({"plane": "x"}, {"plane": "y"})
    assert third.parameters == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("miror(leg2, leg1)", "unknown constraint 'miror' in .*; did you mean 'mirror'"),
        ("mirror(leg2, leg3)", "unknown label 'leg3' in .*; did you mean 'leg"),
        ("mirror(leg2, leg2)", "label 'leg2' is given twice to 'mirror'"),
        ("onplane(arm*)", r"'arm\*' matches none of the labels"),
        ("onplane(head, plain=x)", "unknown parameter 'plain' in"),
        ("onplane(head", "expected ',' or '\\)', found the end"),
        ("2*onplane(head)", "expected a name, found '2'"),
    ],
)
def test_what_is_wrong_is_named(text, message):
    with pytest.raises(ExpressionError, match=message):
        bound(text)


def test_other_things_than_constraints_are_refused():
    with pytest.raises(UsageError, match="a list of calls, not the text"):
        bind_constraints("mirror(leg2, leg1)", LABELS, known(), None)
    with pytest.raises(UsageError, match="decorated with @moseg_core"):
        bound(lambda free: free)
    (rule,) = bound("nothing(head)")
    with pytest.raises(PluginError, match="'test:nothing' of tests 1"):
        rule.make(None)


def test_a_function_is_a_constraint_on_all_labels_or_those_given():
    assert isinstance(pair, FunctionConstraint)
    (by_name,) = bound("pair(leg1, leg2)")
    assert by_name.labels == (2, 3)
    (whole,) = bind_constraints([pair], ("a", "b"), known(), None)
    assert (whole.labels, whole.id) == ((0, 1), "python:pair")
    assert isinstance(whole.make(None), Constraint)
    assert isinstance(pair.__doc__, str)


def test_what_a_constraint_answers_is_timed_and_its_faults_name_it():
    (rule,) = bound("mirror(leg2, leg1)")
    with profiling() as profile:
        assert rule.call(lambda k: k + 1, 1) == 2
        with pytest.raises(PluginError, match=r"constraint 'test:mirror' of tests 1.*ZeroDivision"):
            rule.call(lambda: 1 / 0)
    (entry,) = profile.of("component")
    assert (entry[0], entry[2].calls) == ("constraint test:mirror", 2)


def test_a_problem_checks_its_constraints_when_it_is_made():
    with pytest.raises(ExpressionError, match="did you mean 'mirror'"):
        Problem(LABELS, "narrow(head)", constraints=["miror(leg2, leg1)"], registry=known())


def test_a_plane_that_is_no_text_is_refused():
    with pytest.raises(UsageError, match=r"plane must be a text such as 'auto' or 'x', not \(0, "):
        Problem(["a", "b"], "narrow(a)", constraints=["onplane(a)"], plane=(0, 0), registry=known())
