"""The rule that compares results with different labels."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest

from moseg_core.problem.problem import Problem
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.typical_cost import typical_cost
from moseg_core.shape.shape import Shape
from tests.shapes import solid, strip

# A body of 10 by 6 by 3 cubes and legs of 2 by 2 by 6, at its corners; a tail of 8 cubes in a row.
CORNERS = ((0, 0), (8, 4), (8, 0), (0, 4))
LIKE = (
    "is(body, thickness=0.25+-0.06, area=0.5+-0.15) + 3*convex(body)"
    " + is(leg*, thickness=0.14+-0.03, area=0.12+-0.03, boundary=1.1+-0.3) + 3*convex(leg*)"
    " + is(tail, thickness=0.06+-0.02, area=0.07+-0.02) + 3*convex(tail)"
)


def beast(legs: int, tail: bool) -> tuple[Shape, np.ndarray]:
    """A body with so many legs; for each face 0 on the body, 1 to 4 on a leg, 5 on the tail."""
    cells = list(product(range(10), range(6), range(3)))
    for x, y in CORNERS[:legs]:
        cells += [(x + i, y + j, -1 - k) for i, j, k in product(range(2), range(2), range(6))]
    if tail:
        cells += [(10 + k, 3, 2) for k in range(8)]
    shape = Shape.from_mesh(*solid(cells), name="beast")
    x, y, z = shape.points.T
    leg = 1 + np.array([0, 3, 2, 1])[2 * (x > 5) + (y > 3)]  # the number of the corner
    return shape, np.where(z < 0, leg, np.where(x > 10, 5, 0))


def labelled(problem: Problem, shape: Shape, parts: np.ndarray) -> np.ndarray:
    """The true parts under a problem's labels.

    A part without a label goes to the body. A label without a part takes a fifth of the largest
    part, from one end.
    """
    here = [0] + [k for k in range(1, 6) if (parts == k).any()]
    legs = [k for k, name in enumerate(problem.labels) if name.startswith("leg")]
    labels = np.zeros(len(parts), np.int64)
    for k, part in zip(legs, [k for k in here if 0 < k < 5], strict=False):
        labels[parts == part] = k
    if "tail" in problem.labels:
        labels[parts == 5] = problem.labels.index("tail")
    for k in range(1, len(problem.labels)):
        if not (labels == k).any():
            largest = np.flatnonzero(labels == np.bincount(labels).argmax())
            along = largest[np.argsort(shape.points[largest, 0], kind="stable")]
            labels[along[: len(along) // 5]] = k
    return labels


@pytest.mark.parametrize(("legs", "tail"), [*product((2, 3, 4), (False, True))])
def test_the_rule_chooses_the_labels_that_a_shape_has(legs, tail):
    shape, parts = beast(legs, tail)
    variants = Variants.of(Statement(labels=("body", "leg{2..4}", "tail{0..1}"), minimize=LIKE))
    typical = {}
    for task, text in zip(variants.tasks, variants.texts, strict=True):
        problem = task.problem
        labels = labelled(problem, shape, parts)
        evaluation = problem.evaluate(shape, labels)
        assert not evaluation.empty
        areas = np.bincount(labels, shape.areas)
        typical[text] = typical_cost(problem, evaluation, areas)
    right = f"body, leg{{{legs}}}" + (", tail" if tail else "")
    assert min(typical, key=lambda text: typical[text]) == right


def test_the_rule_does_not_favour_fewer_parts_as_the_total_does():
    """Four legs, each half a unit off; to leave one to the body costs less than half in all."""
    shape = Shape.from_mesh(*strip(10))
    stated = Statement(
        labels=("body", "leg{2..4}"),
        minimize="10*area_fraction(leg*, max=0.05) + 4*area_fraction(body, max=0.6)",
    )
    rules, totals = [], []
    for task in Variants.of(stated).tasks:
        legs = len(task.problem.labels) - 1
        labels = np.array([0] * (10 - legs) + [k + 1 for k in range(legs)])
        evaluation = task.problem.evaluate(shape, labels)
        rules.append(typical_cost(task.problem, evaluation, np.bincount(labels, shape.areas)))
        totals.append(evaluation.cost.value)
    assert rules == sorted(rules, reverse=True)  # all four legs are best
    assert totals == sorted(totals)  # the total would have had two
    assert totals == pytest.approx([1.8, 1.9, 2.0])


def test_parts_that_are_alike_cost_the_same_however_many_there_are():
    costs = []
    for n in (2, 3, 5):
        problem = Problem([f"a{k}" for k in range(n)], "2*narrow(a*) + area_fraction(a*, max=0.1)")
        shape = Shape.from_mesh(*strip(2 * n))
        evaluation = problem.evaluate(shape, np.repeat(np.arange(n), 2))
        only = problem.evaluate(shape, np.repeat(np.arange(n), 2)).terms[0].calls[0].value
        share = evaluation.terms[1].calls[0].value
        costs.append(typical_cost(problem, evaluation, np.full(n, 2.0)) - 2 * only - share)
    assert costs == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_the_rule_against_a_plain_sum():
    shape = Shape.from_mesh(*strip(9))
    problem = Problem(
        ["a", "b", "c", "d"],
        "2*narrow(a) - flat(a) + 3*area_fraction(a, b, max=0.01) + 5*touching(a, b)"
        " + perpendicular(a, b) + narrow(d)",
    )
    evaluation = problem.evaluate(shape, [0, 0, 0, 0, 1, 1, 2, 2, 2])  # d is empty
    areas = np.array([4.0, 2.0, 3.0, 0.0])
    value = {
        (term.objective, call.labels): call.value
        for term in evaluation.terms
        for call in term.calls
    }
    of_a = (
        2 * value["basic:narrow", ("a",)]
        - value["basic:flat", ("a",)]
        + 3 * value["basic:area_fraction", ("a",)]
    )
    of_b = 3 * value["basic:area_fraction", ("b",)]
    own = (of_a * math.sqrt(4.0) + of_b * math.sqrt(2.0)) / (math.sqrt(4.0) + math.sqrt(2.0))
    shared = 5 * value["basic:touching", ("a", "b")] + value["basic:perpendicular", ("a", "b")]
    assert shared > 0
    expected = own + shared / 3  # of which one is empty
    assert typical_cost(problem, evaluation, areas) == pytest.approx(expected, rel=1e-12)


def test_nothing_is_said_of_any_part_alone():
    shape = Shape.from_mesh(*strip(4))
    problem = Problem(["a", "b"], "4*perpendicular(a, b)")
    evaluation = problem.evaluate(shape, [0, 0, 1, 1])
    assert evaluation.cost.value > 0
    found = typical_cost(problem, evaluation, np.array([2.0, 2.0]))
    assert found == pytest.approx(evaluation.cost.value / 2)


def test_a_part_along_a_long_line_tells_against_its_label():
    """Two parts as good alone: what cuts the strip lengthwise is left to the larger label set."""
    shape = Shape.from_mesh(*strip(4))
    found = []
    for labels, parts in ((["a"], [0, 0, 0, 0]), (["a", "b"], [0, 1, 0, 1])):
        problem = Problem(labels, "area_fraction(*, max=1) + short_boundaries")
        evaluation = problem.evaluate(shape, parts)
        found.append(typical_cost(problem, evaluation, np.bincount(parts, shape.areas)))
    assert found[0] < found[1]
