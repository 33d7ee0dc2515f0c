"""Greedy labels against their definition."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.greedy import Greedy
from moseg_core.errors import UsageError
from tests.builtin.labelled_strip import NAMES, N, costs_of, evaluator_with


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
