"""What ``moseg segment`` says of its result."""

from __future__ import annotations

import pytest

from moseg_core import Problem, load, sample_path, segment
from moseg_core.cli.segment_output import print_tables, summary


@pytest.fixture(scope="module")
def result():
    hammer = load(sample_path("hammer"))
    problem = Problem(["handle", "head"], "narrow(handle) + convex_parts")
    return segment(hammer, problem, optimizer="pattern_search(max_evaluations=20)")


def test_shares_of_the_parts_make_up_the_shape(result):
    parts = summary(result)["parts"]
    assert [part["label"] for part in parts] == ["handle", "head"]
    assert sum(part["elements"] for part in parts) == result.shape.n_elements
    assert sum(part["area_share"] for part in parts) == pytest.approx(1)


def test_tables_name_parts_and_terms(result, capsys):
    print_tables(result)
    words = capsys.readouterr().out.split()
    assert {"handle", "head", "narrow", "convex_parts", "total"} <= {*words}
