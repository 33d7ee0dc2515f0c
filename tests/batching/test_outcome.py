"""Outcomes are plain data, there and back, and what is no outcome is refused."""

from __future__ import annotations

import json

import pytest

from moseg_core.batching.outcome import KINDS, BatchProgress, BatchResult, Outcome
from moseg_core.errors import UsageError

WHOLE = Outcome(
    shape="models/a.off",
    key="0f",
    kind="ok",
    files=("a.json", "a.glb"),
    cost=-0.25,
    parts=("leg1", "body"),
    warnings=("part 'leg1' is in 2 pieces",),
    seconds=1.5,
)
FAILED = Outcome(shape="b.off", key="0e", kind="crashed", message="was ended", component="field x")


@pytest.mark.parametrize("outcome", [WHOLE, FAILED, Outcome(shape="\udcff", key="", kind="ok")])
def test_there_and_back(outcome):
    assert Outcome.read(json.loads(json.dumps(outcome.document()))) == outcome


def test_a_cost_of_nothing_is_a_cost():
    assert Outcome.read(Outcome(shape="a", key="b", kind="ok", cost=0.0).document()).cost == 0.0


def test_what_a_later_version_adds_is_passed_over():
    assert Outcome.read({**FAILED.document(), "host": "x"}) == FAILED


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "fine"},
        {"kind": None},
        {"shape": 3},
        {"files": "a.json"},
        {"files": [1]},
        {"cost": "low"},
        {"seconds": True},
        {"message": ["x"]},
    ],
)
def test_what_is_no_outcome_is_refused(change):
    with pytest.raises(UsageError):
        Outcome.read({**FAILED.document(), **change})


def test_what_lacks_a_key_is_refused():
    with pytest.raises(UsageError, match="has a shape, a key and a kind"):
        Outcome.read({"shape": "a", "kind": "ok"})


def test_counts_are_in_the_order_of_the_kinds():
    outcomes = {str(k): Outcome(shape=str(k), key="", kind=kind) for k, kind in enumerate(KINDS)}
    outcomes["again"] = FAILED
    found = BatchResult(folder=None, outcomes=dict(reversed(outcomes.items())), total=9)
    assert list(found.counts) == list(KINDS)
    assert found.counts["crashed"] == 2
    assert len(found.failed) == len(KINDS)


def test_what_is_left_takes_as_long_as_what_is_new():
    progress = BatchProgress(
        total=100, kept=50, counts={"ok": 8, "timeout": 2}, at_work=(), seconds=5.0
    )
    assert progress.done == 60
    assert progress.seconds_left == 20.0
    none = BatchProgress(total=100, kept=50, counts={}, at_work=(), seconds=5.0)
    assert none.seconds_left is None
