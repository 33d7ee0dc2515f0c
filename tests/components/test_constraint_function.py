"""Constraints made from functions of the free parameters."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from moseg_core.components.constraint_function import constraint
from moseg_core.components.protocols import Constraint
from moseg_core.errors import UsageError
from tests.reflections import FLIP, pair


def test_a_function_makes_a_constraint_that_determines_the_labels_it_is_given():
    made = pair(None, (3, 1))
    assert isinstance(made, Constraint)
    assert (made.determines, made.reads) == ((3, 1), ())
    assert len(made.lower) == len(made.upper) == 4


def test_it_keeps_the_functions_name_and_text_and_pickles_by_reference():
    assert pair.__name__ == "pair"
    assert pair.__doc__.startswith("Two centres that mirror")
    assert pickle.loads(pickle.dumps(pair)) is pair


def test_the_free_numbers_of_a_function_are_found_by_least_squares():
    made = pair(None, (2, 3))
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
