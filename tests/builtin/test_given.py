"""Centres placed by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.builtin.given import Given, parse_centers
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes

number = st.floats(-1e9, 1e9)


@given(rows=st.lists(st.tuples(number, number, number), min_size=3, max_size=3))
def test_what_is_written_is_read(rows):
    names = ("a", "leg_1", "9")
    text = ",".join(f"{n}={x!r},{y!r}, {z!r}" for n, (x, y, z) in zip(names, rows, strict=True))
    assert parse_centers(text, names).tolist() == [list(row) for row in rows]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is not understood"),
        ("a", "is not understood"),
        ("1,2,3", "is not understood"),
        ("a=1,2", "'a' needs three coordinates, and has 2 numbers"),
        ("a=1,2,3,4", "'a' needs three coordinates, and has 4 numbers"),
        ("a=1,2,3", "'b' needs three coordinates, and has none"),
        ("a=1,2,x", "'x' is not understood"),
        ("a=1,2,nan,b=0,0,0", "'nan' is not understood"),
        ("a=1,2,inf,b=0,0,0", "'inf' is not understood"),
        ("a=1,2,3,a=1,2,3,b=0,0,0", "'a' is given twice"),
        ("a=1,2,3,c=0,0,0", "unknown label 'c'"),
    ],
)
def test_mistakes_are_named(text, says):
    with pytest.raises(UsageError, match=says):
        parse_centers(text, ("a", "b"))


def run(centers):
    shape = Shape.from_mesh(*shapes.strip(10))
    problem = Problem(["a", "b"], "narrow(a)")
    evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 2))
    return Given(centers=centers)(evaluator, rng=np.random.default_rng(0), report=lambda p: False)


def test_the_centres_are_the_labels_own():
    seeding = run("b=1,0.5,0,a=7,0.5,0")
    assert seeding.labelled
    assert seeding.centers.tolist() == [[7, 0.5, 0], [1, 0.5, 0]]


def test_a_centre_that_gets_nothing_is_refused_by_name():
    with pytest.raises(UsageError, match="label 'b' gets no part of the surface"):
        run("a=9,0.5,0,b=40,0.5,0")


@pytest.mark.parametrize("n", [1, 3])
def test_its_example_places_every_label_on_an_element(n):
    shape = Shape.from_mesh(*shapes.strip(8))
    labels = ["a", "b", "c"][:n]
    evaluator = ProblemEvaluator(shape, Problem(labels, "narrow(a)"), Voronoi(shape, n))
    places = parse_centers(Given.example(evaluator)["centers"], tuple(labels))
    assert len({tuple(place) for place in places.tolist()}) == n
    assert all(place in shape.points.tolist() for place in places.tolist())
