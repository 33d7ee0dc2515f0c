"""Exhaustive labels against their definition."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings

from moseg_core.builtin.exhaustive import Exhaustive
from moseg_core.builtin.greedy import Greedy
from moseg_core.builtin.hungarian import Hungarian
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Labeler
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.builtin.labelled_strip import N, costs_of, evaluator_with, value


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


def test_exhaustive_refuses_nine_labels_with_the_count():
    shape = Shape.from_mesh(*shapes.strip(12))
    problem = Problem([f"p{k}" for k in range(9)], "narrow(p0)")
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 9))
    with pytest.raises(UsageError, match="362880 assignments of 9 labels"):
        Exhaustive()(evaluator, np.ones(36))


@pytest.mark.parametrize("labeler", [Exhaustive(), Greedy(), Hungarian()])
def test_they_are_labelers(labeler):
    assert isinstance(labeler, Labeler)
