"""A session on a small shape, whose searches take a moment, and a server of it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

import moseg_core as moseg
from moseg_core.components.protocols import never_stop
from moseg_core.problem.recipe import Recipe
from moseg_core.tune.server import TuneServer
from moseg_core.tune.session import Session, Wish
from tests.shapes import tee


def small_session() -> Session:
    """A tee after its first search."""
    statement = moseg.Statement(
        labels=("stem", "bar"), minimize="narrow(stem) + 2*narrow(bar) + convex_parts"
    )
    options = moseg.SearchOptions(restarts=1, optimizer="pattern_search(max_evaluations=40)")
    session = Session(
        moseg.Shape.from_mesh(*tee(), name="tee"), Recipe(name="tee", statement=statement), options
    )
    session.search(Wish(weights=session.weights), never_stop)
    return session


@contextmanager
def serving(server: TuneServer) -> Iterator[None]:
    """Serve in a thread."""
    thread = threading.Thread(target=server.serve)
    thread.start()
    try:
        yield
    finally:
        server.close()
        thread.join()


@pytest.fixture
def session() -> Session:
    return small_session()
