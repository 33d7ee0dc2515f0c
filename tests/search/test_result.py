"""Results: parts by name, and what a user is warned of."""

from __future__ import annotations

import math
import sys
import types

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry
from moseg_core.components.discovery.specs import MeasureSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.problem import Problem
from moseg_core.search.result import Result, find_warnings
from moseg_core.shape.shape import Shape
from tests import shapes

STRIP = Shape.from_mesh(*shapes.strip(8), name="strip")


@objective(range=(0, 8))
def area(part: Part) -> float:
    return part.area


@objective(range=(0, 1))
def full(part: Part, *, value: float = 1.0) -> float:
    return value


@objective(range=(0, 1))
def alike(first: Part, second: Part) -> float:
    return 1.0


ALL = {"area": area, "full": full, "alike": alike}


def result_of(labels, text="area(a)", names=("a", "b"), *, registry=None, **more):
    problem = Problem(names, text, objectives=ALL, registry=registry)
    n = len(names)
    fields = {
        "shape": STRIP,
        "problem": problem,
        "labels": np.array(labels, np.int32),
        "evaluation": problem.evaluate(STRIP, labels),
        "centers": Centers(positions=np.zeros((n, 3)), weights=np.ones(n)),
        "history": {"seeding": (), "search": ()},
        "method": {},
        "seed": 0,
        "versions": {},
        "reason": "converged",
    }
    return Result(**{**fields, **more})


def warnings_of(result):
    return find_warnings(
        result.evaluation, result.segmentation, result.problem.labels, result.reason
    )


def test_parts_go_by_their_labels():
    result = result_of([0, 0, 1, 1, 1, 1, 1, 0])
    assert list(result.parts) == ["a", "b"]
    assert result.parts["a"].elements.tolist() == [0, 1, 7]
    assert result.parts["b"].area == 5.0
    assert result.parts["b"].to_mesh().area == pytest.approx(5.0)
    assert isinstance(result.segmentation, Segmentation)
    with pytest.raises(TypeError):
        result.parts["c"] = result.parts["a"]
    with pytest.raises(KeyError, match="unknown part 'zz'; known: a, b"):
        result.parts["zz"]
    with pytest.raises(KeyError, match="unknown level 'a'"):
        result.levels["a"]


def test_the_cost_is_that_of_the_evaluation():
    result = result_of([0] * 3 + [1] * 5, "2*area(a) - area(b)")
    assert result.cost == 1.0
    assert repr(result) == "Result(strip: a, b; cost 1, converged)"


def test_nothing_to_warn_of():
    assert warnings_of(result_of([0] * 3 + [1] * 5)) == ()


@pytest.mark.parametrize("reason", ["evaluations", "seconds"])
def test_a_search_cut_short_is_said_to_be(reason):
    (warning,) = warnings_of(result_of([0] * 3 + [1] * 5, reason=reason))
    assert f"ended on its limit ({reason})" in warning


def test_empty_parts_are_named():
    warnings = warnings_of(result_of([1] * 8, "area(a) + area(b, c)", ["a", "b", "c"]))
    assert [w for w in warnings if "empty" in w] == [
        "part 'a' is empty; terms about it are left out of the cost",
        "part 'c' is empty; terms about it are left out of the cost",
    ]


def test_values_at_their_worst_are_named_with_their_labels():
    text = "full(a, b) - full(b) + full(a, value=0) - full(a, value=0) + alike(b, a)"
    assert warnings_of(result_of([0] * 3 + [1] * 5, text)) == (
        "python:full is at its worst value, 1 for a",
        "python:full is at its worst value, 1 for b",
        "python:full is at its worst value, 0 for a",
        "python:alike is at its worst value, 1 for b, a",
    )


def test_parts_in_several_pieces_are_counted():
    assert warnings_of(result_of([0, 1, 1, 0, 1, 1, 0, 0])) == (
        "part 'a' is in 3 pieces",
        "part 'b' is in 2 pieces",
    )


def test_measures_of_its_parts_come_from_the_registry_of_the_problem(monkeypatch):
    module = types.ModuleType("lengths")
    module.length = lambda part: float(np.ptp(part.points[:, 0]))
    monkeypatch.setitem(sys.modules, "lengths", module)
    component = Component("mine", "mine 1.0", MeasureSpec(name="length", target="lengths:length"))
    registry = Registry([Bundle("mine", "mine", "1.0", "lengths", (component,))])
    result = result_of([0] * 3 + [1] * 5, registry=registry)
    assert result.parts["b"].measure("mine:length") == 4.0


def test_an_unlimited_objective_is_never_at_its_worst():
    @objective(range=(-math.inf, math.inf))
    def free(part: Part) -> float:
        return 1e300

    problem = Problem(["a", "b"], "free(a) - free(b)", objectives={"free": free})
    evaluation = problem.evaluate(STRIP, [0] * 3 + [1] * 5)
    segmentation = Segmentation.from_labels(STRIP, [0] * 3 + [1] * 5, 2)
    assert find_warnings(evaluation, segmentation, problem.labels, "converged") == ()
