"""``moseg segment --profile``."""

from __future__ import annotations

import json

QUICK = ("--recipe", "paper_hammer", "--optimizer", "pattern_search(max_evaluations=60)")


def test_tables_of_stages_terms_and_bundles_on_stderr(moseg, mallet):
    run = moseg("segment", mallet, *QUICK, "--profile", "--json", "--quiet", "--workers", "2")
    assert run.code == 0, run.err
    assert json.loads(run.out)["reason"] == "evaluations"  # and nothing beside it
    first = [line.split("  ")[0] for line in run.err.splitlines()]
    for heading in ("stage", "term or component", "bundle"):
        assert heading in first
    for name in ("read", "seeds and labels", "search", "rest"):
        assert name in first
    for name in ("narrow(handle)", "convex_parts", "parameterization core:voronoi"):
        assert any(name in line for line in first)
    (total,) = [
        line.split()
        for line in run.err.splitlines()
        if "moseg-objectives-basic" in line and line.startswith("moseg")
    ]
    assert int(total[-2]) > 60


def test_a_run_that_fails_is_profiled_too(moseg, open_box):
    run = moseg("segment", open_box, "--recipe", "paper_hammer", "--profile")
    assert run.code != 0
    assert "stage" in run.err


def test_without_it_nothing_is_said(moseg, mallet):
    run = moseg("segment", mallet, *QUICK)
    assert "us per call" not in run.out + run.err


def test_the_result_is_the_same(moseg, mallet):
    words = ("segment", mallet, *QUICK, "--json")
    assert moseg(*words).out == moseg(*words, "--profile").out
