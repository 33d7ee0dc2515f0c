"""Calls of objectives: what is remembered, what is refused, and what is asked of many at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from moseg_core.components.cost import Cost
from moseg_core.components.detail import Detail
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.aggregate import evaluate_segmentation
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.problem.test_aggregate import ALL, STRIP, area, evaluate, more, pieces


def told(part, *, power=1.0):
    return [Detail(name="area", value=part.area, cost=part.area**power)]


def told_of_both(first, second):
    return [Detail(name=f"{k}", value=k, cost=k) for k in range(2)]


def test_details_are_told_with_the_calls_own_parameters_where_they_are_asked_for():
    objectives = {
        "area": objective(details=told)(area._function),
        "more": objective(details=told_of_both)(more._function),
        "pieces": pieces,
    }
    text = "2*area(p*, power=2) + more(p0, p1) + pieces"
    labels = np.array([0, 0, 0, 1, 1, 1, 1, 1])
    problem = Problem(["p0", "p1"], text, objectives=objectives)
    found = problem.evaluate(STRIP, labels)
    assert [[len(call.details) for call in term.calls] for term in found.terms] == [
        [1, 1],
        [2],
        [0],
    ]
    assert found.terms[0].calls[0].details == (Detail(name="area", value=3.0, cost=9.0),)
    assert {labels: str(detail) for labels, detail in found.disagreements.items()} == {
        ("p0",): "area 3",
        ("p1",): "area 5",
        ("p0", "p1"): "1 1",
    }
    plain = evaluate(text, labels, 2, objectives)
    assert plain.cost == found.cost
    assert plain.disagreements == {}


def failing(part, *, power=1.0):
    raise ZeroDivisionError("no area")


@pytest.mark.parametrize(
    ("details", "says"),
    [
        (failing, "failed to say what its value comes from: ZeroDivisionError: no area"),
        (
            lambda part: [("area", 1.0)],
            r"must give its details as Detail, not \(\('area', 1\.0\),\)",
        ),
        (
            lambda part: [Detail(name="area", value=math.nan, cost=1)],
            "the value of detail 'area' must be finite, not nan",
        ),
    ],
)
def test_an_objective_that_fails_to_tell_is_named(details, says):
    own = {"area": objective(details=details)(area._function)}
    with pytest.raises(
        PluginError, match=f"objective 'python:area' of the calling program.*{says}"
    ):
        Problem(["p0"], "area(p0)", objectives=own).evaluate(STRIP, [0] * 8)


def returns(value, low=0.0, high=1.0):
    @objective(range=(low, high))
    def odd(part: Part) -> float:
        return value() if callable(value) else value

    return {"odd": odd}


@pytest.mark.parametrize(
    ("value", "high", "message"),
    [
        (math.nan, 1.0, "returned nan"),
        (math.nan, math.inf, "returned nan"),
        (math.inf, math.inf, "returned inf"),
        (1.1, 1.0, "returned 1.1 .* it declares values from 0 to 1"),
        (-0.001, 1.0, "returned -0.001"),
        (1.0 + 1e-8, 1.0, "returned 1.00000001"),
        (None, 1.0, "returned None .* must be a real number"),
        ("0.5", 1.0, "returned '0.5' .a str. .* must be a real number"),
        (np.ones(2), 1.0, r"returned array.* of shape \(2,\) .* must be a real number"),
        (np.bool_(True), 1.0, "a bool.* must be a real number"),
        (lambda: 1 / 0, 1.0, r"failed .* ZeroDivisionError: .* \(.*test_calls.py:\d+: .*1 / 0"),
    ],
)
def test_an_objective_that_breaks_its_word_is_named(value, high, message):
    with pytest.raises(PluginError, match=message) as caught:
        evaluate("area(p0) + 2*odd(p1)", [0, 1] * 4, 2, {**ALL, **returns(value, 0.0, high)})
    text = str(caught.value)
    for name in ("'python:odd'", "the calling program", "'odd(p1)' for p1"):
        assert name in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (1.0 + 1e-10, 1.0),
        (-1e-10, 0.0),
        (0.0, 0.0),
        (np.float32(0.5), 0.5),
        (np.array(0.25), 0.25),
        (np.array([0.25]), 0.25),
        (np.uint8(1), 1.0),
        (Fraction(1, 4), 0.25),
    ],
)
def test_rounding_beyond_the_range_is_clipped(value, expected):
    found = evaluate("odd(p0)", [0, 1] * 4, 2, returns(value))
    assert found.cost == Cost(0, expected)
    assert isinstance(found.terms[0].calls[0].value, float)


def returns_many(values):
    """An objective whose vectorised form returns something, or what that makes of its parts."""

    @objective(range=(0, 1), vectorized=values if callable(values) else lambda parts: values)
    def odd(part: Part) -> float:
        raise AssertionError("where there is a vectorised form, that is asked")

    return {"odd": odd}


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (lambda parts: parts.areas / 0.0, "failed .* RuntimeWarning: .*test_calls.py"),
        (
            lambda parts: 1 / 0,
            r"failed .* ZeroDivisionError: .* \(.*test_calls.py:\d+: .*1 / 0",
        ),
        (lambda: None, "failed .* TypeError: .*positional argument"),
        (None, "returned None .* an array of 2 real numbers, one for each call"),
        (0.5, "returned 0.5 .* an array of 2 real numbers"),
        (np.ones(3), r"returned array.* of shape \(3,\) .* an array of 2 real numbers"),
        (np.ones((2, 1)), r"of shape \(2, 1\) .* an array of 2 real numbers"),
        ([[1.0], [0.5, 0.5]], "an array of 2 real numbers"),
        (np.ones(2, complex), "an array of 2 real numbers"),
        (np.ones(2, bool), "an array of 2 real numbers"),
        (["0.5", "0.5"], "an array of 2 real numbers"),
        (np.array([0.5, math.nan]), "returned nan .* must be finite"),
        (np.array([math.inf, 0.5]), "returned inf"),
        (np.array([0.5, 1.1]), "returned 1.1 .* it declares values from 0 to 1"),
        (np.array([-0.001, 0.5]), "returned -0.001"),
        (np.array([1.0 + 1e-8, 0.5]), "returned 1.00000001"),
    ],
)
def test_a_vectorised_form_that_breaks_its_word_is_named(values, message):
    with pytest.raises(PluginError, match=message) as caught:
        evaluate("area(p0) + 2*odd(p*)", [0, 1] * 4, 2, {**ALL, **returns_many(values)})
    text = str(caught.value)
    for name in ("'python:odd'", "the calling program", "'odd(p*)'"):
        assert name in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1.0 + 1e-10, -1e-10], [1.0, 0.0]),
        (np.array([0.5, 0.25], np.float32), [0.5, 0.25]),
        (np.array([1, 0], np.uint8), [1.0, 0.0]),
    ],
)
def test_vectorised_values_beyond_the_range_by_rounding_are_clipped(values, expected):
    found = evaluate("odd(p*)", [0, 1] * 4, 2, returns_many(values))
    assert [call.value for call in found.terms[0].calls] == expected
    assert all(type(call.value) is float for call in found.terms[0].calls)


def shares(parts):
    return (parts.areas / parts.shape.area).sum(axis=1)


@objective(range=(0, 1), vectorized=shares)
def share_of_all(parts: Sequence[Part]) -> float:
    raise AssertionError("where there is a vectorised form, that is asked")


@objective(range=(0, 1), vectorized=shares)
def share_of_whole(segmentation: Segmentation) -> float:
    raise AssertionError("where there is a vectorised form, that is asked")


def test_vectorised_forms_receive_parts_of_each_call_and_none_that_is_empty():
    objectives = {"two": share_of_all, "whole": share_of_whole}
    text = "two(p2, p0) + two(p0, p1) + 4*whole"
    found = evaluate(text, [0, 0, 0, 1, 1, 2, 2, 2], 3, objectives)
    assert [[call.value for call in term.calls] for term in found.terms] == [[0.75], [0.625], [1.0]]
    found = evaluate(text, [0, 0, 0, 0, 0, 2, 2, 2], 3, objectives)
    assert found.cost == Cost(1, 1.0)
    assert [[call.value for call in term.calls] for term in found.terms] == [[1.0], [None], [None]]


def test_a_vectorised_form_is_not_asked_about_nothing():
    found = evaluate("odd(p1)", [0] * 8, 2, returns_many(lambda parts: 1 / 0))
    assert found.cost == Cost(1, 0.0)


def test_an_error_of_its_parameters_is_told_with_the_term():
    def refuse(parts):
        raise UsageError("the bounds cross")

    with pytest.raises(UsageError, match=r"in 'odd\(p\*\)': the bounds cross"):
        evaluate("odd(p*)", [0, 1] * 4, 2, returns_many(refuse))


def test_a_value_is_asked_for_once_for_the_same_parts_and_parameters():
    calls = []

    @objective(range=(-9, 9))
    def seen(first: Part, second: Part, *, times: float = 1.0) -> float:
        calls.append((first.n_elements, second.n_elements, times))
        return times * (first.n_elements - second.n_elements)

    memo = Memo()
    text = "seen(p0, p1) + seen(p1, p0) + seen(p0, p1, times=2) + 3*seen(p0, p1)"
    found = evaluate(text, [0, 0, 0, 0, 0, 1, 1, 2], 3, {"seen": seen}, memo=memo)
    assert found.cost.value == 3 - 3 + 6 + 9
    assert calls == [(5, 2, 1.0), (2, 5, 1.0), (5, 2, 2.0)]
    # The third part changes nothing, nor do names: p1 and p0 have swapped their elements.
    evaluate(text, [1, 1, 1, 1, 1, 0, 0, 2], 3, {"seen": seen}, memo=memo)
    assert len(calls) == 4
    assert calls[3] == (2, 5, 2.0)


def test_parts_of_which_all_values_are_remembered_are_not_made():
    shape = Shape.from_mesh(*shapes.tee())
    problem = Problem(["a", "b"], "area(a) + area(b) + more(a, b)", objectives=ALL)
    memo, labels = Memo(), np.arange(shape.n_elements) % 2
    made = []
    for _ in range(2):
        segmentation = Segmentation.from_labels(shape, labels, 2, memo=memo)
        cost = evaluate_segmentation(problem.terms, problem.labels, segmentation).cost
        made.append((cost, len(segmentation._made)))
    assert made == [(made[0][0], 2), (made[0][0], 0)]


def test_the_worst_values_are_known():
    worst = returns(1.0)["odd"]
    best = returns(0.0)["odd"]
    text = "worst(p0) + best(p0, p1) - worst(p1) - 2*best(p1) + area(p0)"
    found = evaluate(text, [0, 1] * 4, 2, {**ALL, "worst": worst, "best": best})
    assert [term.worst for term in found.terms] == [1.0, 1.0, 0.0, 0.0, math.inf]
    assert [len(term.at_worst) for term in found.terms] == [1, 0, 0, 1, 0]
    left_out = evaluate("worst(p0, p1)", [0] * 8, 2, {"worst": worst})
    assert [call.labels for call in left_out.terms[0].at_worst] == [("p0",)]
