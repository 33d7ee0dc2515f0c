"""The loop of asking and telling: pauses, ends, bounds, what stays, and who breaks it."""

from __future__ import annotations

import types

import numpy as np
import pytest

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.components.constraint_function import constraint
from moseg_core.components.cost import WORST
from moseg_core.components.protocols import Batch, never_stop
from moseg_core.errors import PluginError
from moseg_core.search.run import go_on, plain_records, set_up
from tests.made_up import centers_at, fail, on_strip, seeding_at, stranger

SEARCH = stranger("optimizer", PatternSearch, pattern_size=0.1, threshold=0.01)
#: The part a is to be as small as can be, which takes a few steps from where the centres start.
TEXT = "area(a) - 0.3*area(b)"


def prepared(evaluator, ready=SEARCH, *, frozen=(), stage="made", seeding=None, start=None):
    vector = evaluator.parameterization.encode(start or centers_at(4, 6))
    rng = np.random.default_rng(0)
    return set_up(evaluator, ready, vector, rng=rng, frozen=frozen, stage=stage, seeding=seeding)


def searched(evaluator, ready=SEARCH, *, report=never_stop, deadline=None, **options):
    run = prepared(evaluator, ready, **options)
    return run, go_on(run, evaluator, ready, report=report, deadline=deadline)


def everything(outcome):
    return outcome.vector.tobytes(), outcome.cost, outcome.reason, outcome.history


def asking(*batches, seen=None):
    """An optimizer that asks for what it is told to, and keeps what it is told."""

    class Made:
        def __init__(self, start, lower, upper, scale, *, rng):
            self.start, self.told = start, [] if seen is None else seen
            self.waiting = list(batches)

        def ask(self):
            asked = self.waiting.pop(0)
            self.asked = np.asarray(asked(self.start) if callable(asked) else asked)
            return Batch(vectors=self.asked)

        def tell(self, costs):
            self.told.append(costs)
            self.best = self.asked[costs.index(min(costs))], min(costs)

        finished = property(lambda self: "" if self.waiting else "converged")
        history = ()
        progress = 0.5

    return stranger("optimizer", Made)


# --- pauses and ends -----------------------------------------------------------------------------


@pytest.mark.parametrize("steps", [[1], [10, 30, 31, 90], [17] * 3])
def test_a_run_that_pauses_and_goes_on_ends_like_one_in_one_go(steps):
    evaluator = on_strip(TEXT)
    _, whole = searched(evaluator)
    assert whole.reason == "converged"
    assert whole.history["search"][-1]["evaluations"] > 100
    run = prepared(evaluator)
    for until in steps:
        paused = go_on(run, evaluator, SEARCH, report=never_stop, until=until)
        assert paused.reason == "paused"
        assert until <= run.evaluations < until + 16  # a batch is not cut short
        assert paused.cost == evaluator.evaluate(paused.vector).cost
    assert everything(go_on(run, evaluator, SEARCH, report=never_stop)) == everything(whole)


def test_a_run_that_is_there_already_pauses_before_it_asks():
    evaluator = on_strip(TEXT)
    run = prepared(evaluator)
    go_on(run, evaluator, SEARCH, report=never_stop, until=20)
    before = run.evaluations
    assert go_on(run, evaluator, SEARCH, report=fail, until=20).reason == "paused"
    assert run.evaluations == before == evaluator.evaluations


def test_the_clock_is_looked_at_after_each_batch():
    run, outcome = searched(on_strip(TEXT), deadline=0.0)
    assert (outcome.reason, run.evaluations) == ("seconds", 1)
    assert searched(on_strip(TEXT), deadline=np.inf)[1].reason == "converged"


def test_a_report_ends_the_run():
    seen = []

    def report(progress):
        seen.append(progress)
        return progress.done > 20

    run, outcome = searched(on_strip(TEXT), report=report)
    assert outcome.reason == "interrupted"
    assert [progress.done for progress in seen] == [1, 17, 33]
    assert {progress.stage for progress in seen} == {"made"}
    assert seen[-1].best == outcome.cost
    assert all(0.0 <= progress.fraction <= 1.0 for progress in seen)
    assert run.evaluations == 33


@pytest.mark.parametrize("more", [{"report": lambda progress: True}, {"deadline": 0.0}])
def test_a_run_that_has_finished_was_not_ended_by_anybody(more):
    ready = stranger("optimizer", PatternSearch, max_evaluations=1)
    assert searched(on_strip(TEXT), ready, **more)[1].reason == "evaluations"


def test_what_the_seeder_said_is_in_the_outcome_and_polishing_has_its_own_stage():
    seeding = seeding_at(4, 6, history=({"round": 1},), warning="guessed")
    _, outcome = searched(on_strip(TEXT), seeding=seeding)
    assert list(outcome.history) == ["seeding", "search"]
    assert outcome.history["seeding"] == ({"round": 1},)
    assert outcome.warning == "guessed"
    _, polished = searched(on_strip(TEXT), stage="polish")
    assert list(polished.history) == ["polish"]
    assert polished.history["polish"] == outcome.history["search"]


# --- bounds, and coordinates that stay -----------------------------------------------------------


@constraint(start=[0.3, 1.0])
def shrinking(free):
    """Two centres apart; their weights are positive from 0.5 on."""
    x, w = free
    return [[-x, 0, 0, w - 0.5], [x, 0, 0, w - 0.5]]


@pytest.mark.parametrize(
    ("weights", "inside"), [([1.0, 0.2, 2.0, 0.5], [0, 2]), ([0.2, 0.1], []), ([1.0, 2.0], [0, 1])]
)
def test_what_constraints_lead_out_of_the_bounds_is_worst_and_not_evaluated(weights, inside):
    evaluator = on_strip(TEXT, constraints=[shrinking])
    told = []
    good = [0.3, 1.0]
    ready = asking([good], [[0.2, w] for w in weights], seen=told)
    _, outcome = searched(evaluator, ready)
    assert [k for k, cost in enumerate(told[1]) if cost != WORST] == inside
    assert evaluator.evaluations == 1 + len(inside)
    expected = evaluator.constraints.expand(np.array([[0.2, weights[k]] for k in inside] or [good]))
    for k, vector in zip(inside, expected, strict=False):
        assert told[1][k] == evaluator.evaluate(vector).cost
    assert outcome.vector.shape == (8,)


def test_an_optimizer_begins_within_its_bounds():
    evaluator = on_strip(TEXT)
    ready = asking(lambda start: [start])
    run = prepared(evaluator, ready, start=centers_at(4, 6, weights=[1.0, -1.0]))
    assert (run.search.start >= evaluator.constraints.lower).all()
    assert run.search.start[7] > 0


def test_frozen_coordinates_stay_to_the_last_bit():
    evaluator = on_strip(TEXT)
    start = centers_at(5, 6, weights=[1.0, 0.98])
    vector = evaluator.parameterization.encode(start)
    ready = stranger("optimizer", PatternSearch, threshold=0.01)
    run, outcome = searched(evaluator, ready, frozen=[1], start=start)
    assert run.free.tolist() == [True] * 4 + [False] * 4
    assert outcome.vector[4:].tobytes() == vector[4:].tobytes()
    assert (outcome.vector[:4] != vector[:4]).any()
    assert outcome.cost < evaluator.evaluate(vector).cost
    assert max(np.diff([r["evaluations"] for r in outcome.history["search"]])) == 8


def test_with_no_free_coordinate_the_start_is_the_outcome():
    evaluator = on_strip(TEXT)
    vector = evaluator.parameterization.encode(centers_at(4, 6))
    run, outcome = searched(evaluator, stranger("optimizer", fail), frozen=[0, 1])
    assert run.search is None
    assert everything(outcome) == (
        vector.tobytes(),
        evaluator.evaluate(vector).cost,
        "converged",
        {"seeding": (), "search": ()},
    )
    # Nothing is left to wait for, whatever is asked.
    assert go_on(run, evaluator, SEARCH, report=fail, deadline=0.0, until=0).reason == "converged"


# --- optimizers that break their word ------------------------------------------------------------


class Broken(PatternSearch):
    """A search that breaks its word in the way that the test says, after the start."""

    how = ""

    def ask(self):
        batch = super().ask()
        if not self.history:
            return batch
        return {
            "raises": fail,
            "nothing": lambda: None,
            "narrow": lambda: Batch(vectors=batch.vectors[:, :5]),
            "flat": lambda: Batch(vectors=batch.vectors[0]),
            "nan": lambda: Batch(vectors=batch.vectors * np.nan),
            "none": lambda: Batch(vectors=batch.vectors[:0]),
            "no batch": lambda: types.SimpleNamespace(vectors=batch.vectors),
        }[self.how]()


@pytest.mark.parametrize("how", ["raises", "nothing", "narrow", "flat", "nan", "none", "no batch"])
def test_an_optimizer_that_asks_for_garbage_is_named(how):
    ready = stranger("optimizer", type("Walk", (Broken,), {"how": how}))
    said = "failed: ValueError" if how == "raises" else "must ask for a Batch of one or more finite"
    with pytest.raises(PluginError, match=rf"'strange:made' of moseg-strange 2\.0 {said}"):
        searched(on_strip(TEXT), ready)


@pytest.mark.parametrize("what", ["best", "history", "progress", "finished"])
def test_an_optimizer_that_cannot_say_what_it_found_is_named(what):
    def unknown(self):
        if self._evaluations:
            raise ValueError("no idea")
        return ""

    made = type("Walk", (PatternSearch,), {what: property(unknown)})
    ready = stranger("optimizer", made, max_evaluations=3)
    with pytest.raises(PluginError, match=r"optimizer 'strange:made' of moseg-strange 2\.0"):
        searched(on_strip(TEXT), ready)


def test_records_are_of_plain_numbers():
    records = plain_records([{"round": np.int32(3), "cost": np.float32(0.5), "all": True}])
    assert records == ({"round": 3, "cost": 0.5, "all": 1},)
    assert [type(value) for value in records[0].values()] == [int, float, int]
    with pytest.raises(ValueError, match="could not convert"):
        plain_records([{"round": "first"}])
