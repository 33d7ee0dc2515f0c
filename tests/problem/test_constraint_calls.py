"""Constraints as they are written: names, labels, parameters, functions."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.constraint_function import FunctionConstraint, constraint
from moseg_core.components.protocols import Constraint
from moseg_core.errors import ExpressionError, PluginError, UsageError
from moseg_core.problem.constraint_calls import bind_rules
from moseg_core.problem.problem import Problem
from tests.reflections import FLIP, known, pair

LABELS = ("head", "body", "leg1", "leg2")


def bound(*given, plane=None):
    return bind_rules(given, LABELS, known(), plane)


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
        bind_rules("mirror(leg2, leg1)", LABELS, known(), None)
    with pytest.raises(UsageError, match="decorated with @moseg_core"):
        bound(lambda free: free)
    (rule,) = bound("nothing(head)")
    with pytest.raises(PluginError, match="'test:nothing' of tests 1"):
        rule.make(None)


def test_a_function_is_a_constraint_on_all_labels_or_those_given():
    assert isinstance(pair, FunctionConstraint)
    (by_name,) = bound("pair(leg1, leg2)")
    assert by_name.labels == (2, 3)
    (whole,) = bind_rules([pair], ("a", "b"), known(), None)
    assert (whole.labels, whole.id) == ((0, 1), "python:pair")
    assert isinstance(whole.make(None), Constraint)
    assert isinstance(pair.__doc__, str)


def test_the_free_numbers_of_a_function_are_found_by_least_squares():
    (rule,) = bound("pair(leg1, leg2)")
    made = rule.make(None)
    rng = np.random.default_rng(3)
    for _ in range(20):
        free = rng.normal(size=4)
        given = rng.normal(size=(4, 4))
        centers = made.expand(free, given)
        assert (centers[:2] == given[:2]).all()
        assert made.reduce(centers)[0] == pytest.approx(free, abs=1e-9)
        # The nearest pair to any two centres: the mean of the one and the other's image.
        assert made.reduce(given)[0] == pytest.approx((given[2] + FLIP * given[3]) / 2, abs=1e-7)


def test_a_curved_family_is_reduced_too():
    @constraint(start=[0.5, 1.0])
    def on_circle(free):
        angle, weight = free
        return [[np.cos(angle), np.sin(angle), 0, weight]]

    made = on_circle(None, (0,))
    free, rows = made.reduce(np.array([[3.0, 3.0, 0.0, 2.0]]))
    assert free == pytest.approx([np.pi / 4, 2.0], abs=1e-7)
    assert rows[0, :2] == pytest.approx([0.5**0.5, 0.5**0.5], abs=1e-7)


def test_a_function_that_returns_too_few_rows_is_named():
    @constraint(start=[1.0])
    def short(free):
        return [[0, 0, 0, 1]]

    with pytest.raises(UsageError, match=r"'short' must return a row .* for each of 2 labels"):
        short(None, (0, 1)).expand(np.ones(1), np.zeros((2, 4)))


@pytest.mark.parametrize("start", [[], [np.nan], [[1.0]]])
def test_a_start_that_is_none_is_refused(start):
    with pytest.raises(ValueError, match="a finite number for each free parameter"):
        constraint(start=start)


def test_a_problem_checks_its_constraints_when_it_is_made():
    with pytest.raises(ExpressionError, match="did you mean 'mirror'"):
        Problem(LABELS, "narrow(head)", constraints=["miror(leg2, leg1)"], registry=known())


def test_a_plane_that_is_no_text_is_refused():
    with pytest.raises(UsageError, match=r"plane must be a text such as 'auto' or 'x', not \(0, "):
        Problem(["a", "b"], "narrow(a)", constraints=["onplane(a)"], plane=(0, 0), registry=known())
