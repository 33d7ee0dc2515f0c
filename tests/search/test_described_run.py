"""What makes a run the one that it is: all that changes the result, and nothing else."""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core.components.protocols import Centers
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.search.described_run import described, differences

PROBLEM = Problem(["a", "b"], "narrow(a)")
START = Centers(positions=np.zeros((2, 3)), weights=np.ones(2))


def description(shape, problem=PROBLEM, search=None, *, options=None, **more):
    task = Hierarchy(problem, search=search or Method())
    return described(shape, [task], options or SearchOptions(), **more)


def test_it_is_plain_data(row):
    found = description(row, start=START, freeze=["a"], pins={"a": [1]})
    assert json.loads(json.dumps(found)) == found
    assert found == description(row, start=START, freeze=["a"], pins={"a": [1]})


@pytest.mark.parametrize("options", [{"workers": 2}, {"max_seconds": 3.0}])
def test_what_makes_no_difference_is_left_out(row, options):
    assert description(row, options=SearchOptions(**options)) == description(row)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"seed": 2}, "search seed was 0 and is 2"),
        ({"restarts": 3}, "search restarts was not said and is 3"),
        ({"optimizer": "pattern_search(expansion=3)"}, "search optimizer was not said and is patt"),
        ({"settings": "paper"}, "search settings was default and is paper"),
        ({"ignore_pieces_below": 0.1}, "search ignore_pieces_below was 0.0 and is 0.1"),
    ],
)
def test_other_options_are_told(row, options, told):
    found = list(differences(description(row), description(row, options=SearchOptions(**options))))
    assert found[0].startswith(told)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"problem": Problem(["a", "b"], "narrow(b)")}, "problem minimize was narrow(a) and is na"),
        ({"search": Method(restarts=2)}, "problem restarts was not said and is 2"),
        ({"start": START}, "start was not said and is "),
        ({"freeze": ["b"]}, "freeze was [] and is ['b']"),
        ({"pins": {"a": [1]}}, "pins a was not said and is "),
        ({"asked": {"parts": "auto"}}, "problem was [{'labels': ['a', 'b'], "),
    ],
)
def test_another_request_is_told(row, changed, told):
    assert next(differences(description(row), description(row, **changed))).startswith(told)


def test_another_shape_is_told(row, box):
    assert next(differences(description(row), description(box))).startswith("shape geometry was ")


def test_pins_and_starts_are_told_apart(row):
    moved = Centers(positions=np.ones((2, 3)), weights=np.ones(2))
    assert description(row, start=START) != description(row, start=moved)
    assert description(row, pins={"a": [1]}) != description(row, pins={"a": [2]})


def test_long_values_are_cut():
    (line,) = differences({"x" * 1000: "y" * 1000}, {})
    assert len(line) < 200
