"""A result that was chosen among several: what it tells of the others."""

from __future__ import annotations

from dataclasses import replace

import pytest

from moseg_core.problem.problem import Problem
from moseg_core.search.alternatives import chosen_among
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests.shapes import strip

CONVERGED = segment(
    Shape.from_mesh(*strip(6)),
    Problem(["a", "b"], "narrow(a)"),
    optimizer="pattern_search(max_evaluations=9)",
)


@pytest.mark.parametrize(
    ("reasons", "failed", "reason"),
    [
        (("converged", "converged"), False, "converged"),
        (("converged", "interrupted"), False, "interrupted"),
        (("evaluations", "seconds"), False, "seconds"),
        (("converged", "seconds"), True, "failed"),
    ],
)
def test_the_reason_is_that_of_all_and_its_warning_comes_first(reasons, failed, reason):
    first, second = (
        replace(CONVERGED, reason=own, warnings=("of its own",), history={"search": ()})
        for own in reasons
    )
    tried = {"tried": ({"cost": 1.0},)}
    found = chosen_among(first, [first, second], failed=failed, tried=tried)
    assert found.reason == reason
    assert found.warnings[-1] == "of its own"
    assert len(found.warnings) == (1 if reason == "converged" else 2)
    assert found.history == {"search": (), **tried}
    assert found.labels is first.labels


def test_what_is_no_longer_so_is_not_said():
    ended = replace(
        CONVERGED,
        reason="evaluations",
        warnings=("the search ended on its limit (evaluations); a longer one may find better",),
    )
    found = chosen_among(ended, [ended], failed=True, tried={})
    assert found.warnings == ("the run failed; this is the best that it had found",)
