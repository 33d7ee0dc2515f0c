"""The aggregate objective, by hand: what is called with what, what is added, what is refused."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.cost import Cost
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import CallValue, evaluate_segmentation
from moseg_core.problem.problem import Problem
from moseg_core.shape.shape import Shape
from tests import shapes

STRIP = Shape.from_mesh(*shapes.strip(8))


def evaluate(minimize, labels, n, objectives, *, memo=None):
    problem = Problem([f"p{k}" for k in range(n)], minimize, objectives=objectives)
    segmentation = Segmentation.from_labels(STRIP, labels, n, memo=memo)
    return evaluate_segmentation(problem.terms, problem.labels, segmentation)


@objective(range=(0, math.inf))
def area(part: Part, *, power: float = 1.0) -> float:
    return part.area**power


@objective(range=(-math.inf, math.inf))
def more(first: Part, second: Part) -> float:
    return first.area - second.area


@objective(range=(0, math.inf))
def spread(parts: Sequence[Part]) -> float:
    return max(part.area for part in parts) - min(part.area for part in parts)


@objective(range=(0, math.inf))
def pieces(segmentation: Segmentation) -> float:
    return float(sum(part.n_components for part in segmentation.parts))


ALL = {"area": area, "more": more, "spread": spread, "pieces": pieces}


def test_each_arity_receives_its_parts_and_the_weighted_values_add_up():
    labels = [0, 0, 0, 1, 1, 2, 2, 0]
    text = "2*area(p0, p2) - 0.5*area(p1, power=3) + more(p2, p0) + 10*spread(p*) + pieces"
    found = evaluate(text, labels, 3, ALL)
    assert [[call.value for call in term.calls] for term in found.terms] == [
        [4.0, 2.0],
        [8.0],
        [-2.0],
        [2.0],
        [4.0],
    ]
    assert [term.text for term in found.terms] == [
        "area(p0, p2)",
        "area(p1, power=3)",
        "more(p2, p0)",
        "spread(p*)",
        "pieces",
    ]
    assert [term.value for term in found.terms] == [6.0, 8.0, -2.0, 2.0, 4.0]
    assert [term.weighted for term in found.terms] == [12.0, -4.0, -2.0, 20.0, 4.0]
    assert found.cost == Cost(0, 30.0)
    assert found.terms[3].calls == (CallValue(labels=("p0", "p1", "p2"), value=2.0),)
    assert found.terms[4].calls[0].labels == ()
    assert found.terms[0].objective == "python:area"


@given(st.integers(0, 2**32), st.lists(st.floats(-9, 9).filter(bool), min_size=1, max_size=5))
@settings(max_examples=40, deadline=None)
def test_the_cost_is_the_sum_in_the_order_written_to_the_last_bit(seed, weights):
    labels = np.random.default_rng(seed).integers(0, 3, 8)
    labels[:3] = range(3)
    terms = "".join(
        f"{'+' if w > 0 else '-'} {abs(w)!r}*area(p*, power={1 / (k + 1)}) "
        for k, w in enumerate(weights)
    )
    found = evaluate(terms, labels, 3, ALL)
    total = 0.0
    for k, w in enumerate(weights):
        inner = 0.0
        for part in range(3):
            inner += float((labels == part).sum()) ** (1 / (k + 1))
        total += w * inner
    assert found.cost.value == total == sum(term.weighted for term in found.terms)


def test_terms_about_empty_parts_are_left_out_and_the_empty_parts_counted():
    text = "area(p*) + more(p0, p1) + spread(p0, p2, p1) + spread(p0, p2) + pieces"
    found = evaluate(text, [0, 0, 0, 0, 0, 0, 2, 2], 4, ALL)
    assert found.cost == Cost(2, 6.0 + 2.0 + 4.0)
    assert found.empty == ("p1", "p3")
    values = [[call.value for call in term.calls] for term in found.terms]
    assert values == [[6.0, None, 2.0, None], [None], [None], [4.0], [None]]
    assert [term.value for term in found.terms] == [8.0, 0.0, 0.0, 4.0, 0.0]


def test_no_objective_receives_a_part_without_elements_area_or_extent():
    vertices, faces = shapes.strip(3)
    shape = Shape.from_mesh(vertices, [*faces, (0, 0, 1), (2, 2, 2)])
    seen = []

    @objective(range=(0, 1))
    def one(part: Part) -> float:
        seen.append(part)
        return 0.5

    @objective(range=(0, 1))
    def several(parts: Sequence[Part]) -> float:
        seen.extend(parts)
        return 0.5

    @objective(range=(0, 1))
    def whole(segmentation: Segmentation) -> float:
        seen.extend(segmentation.parts)
        return 0.5

    problem = Problem(
        ["a", "b", "c", "d"],
        "one(a, b, c, d) + several(a, b) + several(a, c) + whole",
        objectives={"one": one, "several": several, "whole": whole},
    )
    for labels in ([0, 0, 1, 2, 3], [0, 0, 0, 1, 2], [0, 1, 2, 3, 3], [0, 1, 1, 2, 2]):
        problem.evaluate(shape, labels)
    assert seen
    for part in seen:
        assert part.n_elements > 0
        assert part.area > 0
        assert part.scales[0] > 0
