"""A session on a small shape, whose searches take a moment."""

from __future__ import annotations

import pytest

import moseg_core as moseg
from moseg_core.problem.recipe import Recipe
from moseg_core.tune.session import Session, Wish
from tests.shapes import tee


@pytest.fixture
def session():
    statement = moseg.Statement(
        labels=("stem", "bar"), minimize="narrow(stem) + 2*narrow(bar) + convex_parts"
    )
    options = moseg.SearchOptions(restarts=1, optimizer="pattern_search(max_evaluations=40)")
    session = Session(
        moseg.Shape.from_mesh(*tee(), name="tee"), Recipe(name="tee", statement=statement), options
    )
    session.search(Wish(weights=session.weights), lambda progress: False)
    return session
