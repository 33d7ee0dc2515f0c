"""Greedy and exhaustive labels against their definitions."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.exhaustive import Exhaustive
from moseg_core.builtin.greedy import Greedy
from moseg_core.builtin.hungarian import Hungarian
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Labeler
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes

N = 4
STRIP = Shape.from_mesh(*shapes.strip(10))
STARTS = np.array([[0.5, 0.5, 0], [2.0, 0.5, 0], [4.5, 0.5, 0], [8.0, 0.5, 0]])
NAMES = ("a", "b", "c", "d")
costs_of = st.lists(
    st.lists(st.integers(-9, 9).map(float), min_size=N, max_size=N), min_size=N, max_size=N
)


def evaluator_with(unary, pairs=None, overall=0.0):
    """A problem whose unary cost of part i as label j is unary[i][j], and so on."""
    voronoi = Voronoi(STRIP, N)
    vector = voronoi.encode(Centers(positions=STARTS, weights=np.ones(N)))
    number = {int(f): i for i, f in enumerate(_middles(voronoi.labels(vector[None])[0]))}

    def index(part: Part) -> int:
        return number[int(part.elements[len(part.elements) // 2])]

    own = {}
    text = []
    for j, name in enumerate(NAMES):

        @objective(range=(-99, 99))
        def single(part: Part, *, j: int = j) -> float:
            return unary[index(part)][j]

        own[f"u{j}"] = single
        text.append(f"u{j}({name})")
    if pairs is not None:

        @objective(range=(-99, 99))
        def pair(first: Part, second: Part) -> float:
            return pairs[index(first)][index(second)]

        @objective(range=(-99, 99))
        def whole(segmentation: Segmentation) -> float:
            return overall

        own |= {"pair": pair, "whole": whole}
        text += ["2*pair(a, c)", "pair(d, b)", "whole"]
    problem = Problem(NAMES, " + ".join(text), objectives=own)
    return ProblemEvaluator(STRIP, problem, voronoi), vector


def _middles(labels):
    return [np.flatnonzero(labels == k)[(labels == k).sum() // 2] for k in range(N)]


def value(order, unary, pairs):
    total = sum(unary[order[j]][j] for j in range(N))
    return total + 2 * pairs[order[0]][order[2]] + pairs[order[3]][order[1]]


@given(unary=costs_of, pairs=costs_of)
@settings(max_examples=30)
def test_exhaustive_finds_the_first_of_the_cheapest_permutations(unary, pairs):
    evaluator, vector = evaluator_with(unary, pairs, overall=3.0)
    expected = min(itertools.permutations(range(N)), key=lambda o: value(o, unary, pairs))
    assert Exhaustive()(evaluator, vector).tolist() == list(expected)


@given(unary=costs_of)
@settings(max_examples=30)
def test_hungarian_costs_what_exhaustive_costs_on_unary_terms(unary):
    evaluator, vector = evaluator_with(unary)

    def total(order):
        return sum(unary[order[j]][j] for j in range(N))

    assert total(Hungarian()(evaluator, vector)) == total(Exhaustive()(evaluator, vector))


@given(unary=costs_of, pairs=costs_of, sequence=st.permutations(range(N)))
@settings(max_examples=40)
def test_greedy_takes_the_least_increase_label_by_label(unary, pairs, sequence):
    evaluator, vector = evaluator_with(unary, pairs, overall=50.0)
    order = [-1] * N
    for label in sequence:
        increases = {}
        for part in range(N):
            if part in order:
                continue
            tried = [*order[:label], part, *order[label + 1 :]]
            increase = unary[part][label]
            if label in (0, 2) and tried[0] >= 0 and tried[2] >= 0:
                increase += 2 * pairs[tried[0]][tried[2]]
            if label in (1, 3) and tried[1] >= 0 and tried[3] >= 0:
                increase += pairs[tried[3]][tried[1]]
            increases[part] = increase
        order[label] = min(increases, key=lambda part: (increases[part], part))
    asked = ",".join(NAMES[k] for k in sequence)
    assert Greedy(order=asked)(evaluator, vector).tolist() == order


def test_greedy_completes_a_partial_order_with_the_rest():
    unary = [[float(10 * i + j) for j in range(N)] for i in range(N)]
    evaluator, vector = evaluator_with(unary)
    whole = Greedy(order="c,a,b,d")(evaluator, vector)
    assert Greedy(order="c")(evaluator, vector).tolist() == whole.tolist()
    assert sorted(Greedy()(evaluator, vector).tolist()) == list(range(N))


@pytest.mark.parametrize(
    ("order", "says"), [("a,e", "unknown label 'e'"), ("a,b,a", "'a' is given twice")]
)
def test_greedy_refuses_an_order_it_cannot_follow(order, says):
    evaluator, vector = evaluator_with([[0.0] * N] * N)
    with pytest.raises(UsageError, match=says):
        Greedy(order=order)(evaluator, vector)


def test_exhaustive_refuses_nine_labels_with_the_count():
    shape = Shape.from_mesh(*shapes.strip(12))
    problem = Problem([f"p{k}" for k in range(9)], "narrow(p0)")
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 9))
    with pytest.raises(UsageError, match="362880 assignments of 9 labels"):
        Exhaustive()(evaluator, np.ones(36))


@pytest.mark.parametrize("labeler", [Exhaustive(), Greedy(), Hungarian()])
def test_they_are_labelers(labeler):
    assert isinstance(labeler, Labeler)
