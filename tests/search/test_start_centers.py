"""Centres that somebody gives, in the order of the problem, or why they do not fit it."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.start_centers import check_counts, matched_centers, start_centers

PROBLEM = Problem(["stem", "bar"], "narrow(stem)")


def at(*xs, parts=None):
    positions = np.array([[x, 0.0, 0.0] for x in xs])
    return Centers(positions=positions, weights=np.arange(1.0, len(xs) + 1), parts=parts)


def test_no_start_is_none():
    assert start_centers(None, PROBLEM) is None


def test_centres_come_in_the_order_of_their_parts():
    found = start_centers(at(5, 6, 7, parts=np.array([1, 0, 1])), PROBLEM)
    assert found.positions[:, 0].tolist() == [6, 5, 7]
    assert found.weights.tolist() == [2, 1, 3]
    assert found.parts.tolist() == [0, 1, 1]
    assert start_centers(at(5, 6), PROBLEM).positions[:, 0].tolist() == [5, 6]


@pytest.mark.parametrize(
    ("start", "message"),
    [
        ("kmeans", "the start must be Centers, a Result or an Alignment, not 'kmeans'"),
        (at(1, 2, 3), "needs a centre and a weight for each of 2 labels|which of 2 labels"),
        (at(1, 2, parts=np.array([0, 0])), "which of 2 labels it belongs to"),
        (at(1, 2, parts=np.array([0.0, 1.0])), "which of 2 labels it belongs to"),
    ],
)
def test_what_is_no_start_is_refused(start, message):
    with pytest.raises(UsageError, match=message):
        start_centers(start, PROBLEM)


def test_centres_are_matched_by_label():
    found = matched_centers(["bar", "stem"], at(5, 6), PROBLEM)
    assert found.positions[:, 0].tolist() == [6, 5]
    with pytest.raises(UsageError, match="the start has the labels bar, leg; the problem has stem"):
        matched_centers(["bar", "leg"], at(5, 6), PROBLEM)
    with pytest.raises(UsageError, match=r"centres in the space 'mds'.*--embedding mds"):
        matched_centers(["bar", "stem"], at(5, 6), PROBLEM, embedding="mds")


def test_one_centre_a_label_or_as_many_as_the_partition_has():
    several = at(5, 6, 7, parts=np.array([0, 1, 1]))
    for start, allowed in ((at(5, 6), [1, 3]), (several, [1, 2])):
        check_counts(start, np.array(allowed), PROBLEM.labels)
    with pytest.raises(UsageError, match="2 centres for label 'bar', and the parameterization 3"):
        check_counts(several, np.array([1, 3]), PROBLEM.labels)
