"""Several starts: who goes on and for how long, what they share, and which result is the best."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import registry
from moseg_core.components.protocols import Batch, Centers, Progress, never_stop
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.best_so_far import TrackedWorkers
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.restarts import (
    Listener,
    Plan,
    carry_out,
    disagreement,
    finish,
    polisher,
    searched_shape,
    shared_budget,
)
from moseg_core.search.run import RunOutcome
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.pins import NO_PINS, read_pins
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import area, labeler, on_strip, seeder, seeding_at, stranger

#: A sheet of 120 squares, and what a search on it sees.
SHEET = Shape.from_mesh(*shapes.jitter(shapes.rectangle(12, 10, 12, 10), 1), name="sheet")
COARSE = coarsen(SHEET, 30)


class Staying:
    """Asks 40 times in a batch what its start costs, until `most` evaluations are done."""

    def __init__(self, start, lower, upper, scale, *, rng, most=1000, max_evaluations=None):
        self.start, self.done = start, 0
        self.limit = min(most, max_evaluations or most)
        self.said = "converged" if max_evaluations is None else "evaluations"

    def ask(self):
        return Batch(vectors=np.repeat(self.start[None], min(40, self.limit - self.done), axis=0))

    def tell(self, costs):
        self.done += len(costs)
        self.best = self.start, costs[0]

    finished = property(lambda self: self.said if self.done >= self.limit else "")
    progress = property(lambda self: self.done / self.limit)
    history = property(lambda self: ({"evaluations": self.done},))


def placed(squares, *, draws=True):
    """A seeder for one start after the other: part a has the squares up to a given one."""
    waiting = iter(squares)

    def place(evaluator, rng):
        if draws:
            rng.random()
        k = next(waiting)
        return seeding_at(k, k + 1)

    return seeder(place)


def plan_of(
    seeds,
    *,
    restarts,
    finalists=2,
    polished=2,
    repeats=True,
    deadline=None,
    exchanges=False,
    **parameters,
):
    evaluator = on_strip()
    ready = {
        "seeder": seeds,
        "labeler": labeler([0, 1]),
        "optimizer": stranger("optimizer", Staying, **parameters),
    }
    return Plan(
        coarse=evaluator,
        whole=evaluator,
        resolution="full",
        ready=ready,
        restarts=restarts,
        finalists=finalists,
        polished=polished,
        seed=0,
        start=None,
        frozen=(),
        deadline=deadline,
        repeats=repeats,
        exchanges=exchanges,
    )


def evaluations(outcomes):
    return [outcome.history["search"][-1]["evaluations"] for outcome in outcomes]


# --- who goes on, and for how long ---------------------------------------------------------------


@pytest.mark.parametrize(("finalists", "third"), [(2, 480), (3, 1000)])
def test_the_better_half_goes_on_for_three_times_as_long_until_finalists_are_left(finalists, third):
    # The last start is as good as the second, but it has the same labels.
    squares = [3, 0, 5, 1, 6, 2, 4, 0]
    outcomes, best = carry_out(
        plan_of(placed(squares), restarts=8, finalists=finalists), 1, Listener(never_stop)
    )
    assert [outcome.cost for outcome in outcomes] == [Cost(0, k + 1) for k in squares]
    # 8 coordinates: first judged after 160 evaluations, then after 480.
    assert evaluations(outcomes) == [480, 1000, 160, 1000, 160, third, 160, 160]
    reasons = {3: "paused", 0: "converged", 5: "paused", 1: "converged"}
    assert [outcome.reason for outcome in outcomes[:4]] == [reasons[k] for k in squares[:4]]
    assert best is outcomes[1]


@pytest.mark.parametrize(
    ("options", "ends", "reason"),
    [
        ({"finalists": 3}, [1000] * 3, "converged"),
        ({"finalists": 5}, [1000] * 3, "converged"),
        ({"finalists": 1, "max_evaluations": 300}, [300] * 3, "evaluations"),
        ({"finalists": 1, "most": 100}, [100] * 3, "converged"),
    ],
)
def test_all_go_on_where_all_are_finalists_or_end_before_they_are_judged(options, ends, reason):
    outcomes, _ = carry_out(
        plan_of(placed([4, 2, 6]), restarts=3, **options), 1, Listener(never_stop)
    )
    assert evaluations(outcomes) == ends
    assert {outcome.reason for outcome in outcomes} == {reason}


@pytest.mark.parametrize(
    ("draws", "repeats", "count"), [(1, 0, 3), (0, 0, 1), (0, 1, 3), (1, 1, 3)]
)
def test_starts_that_draw_nothing_are_repeated_on_request_only(draws, repeats, count):
    plan = plan_of(placed([4, 4, 4], draws=draws), restarts=3, repeats=repeats)
    outcomes, _ = carry_out(plan, 1, Listener(never_stop))
    assert len(outcomes) == count
    assert evaluations(outcomes)[0] == 1000


def test_each_start_has_random_numbers_of_its_own_the_first_those_of_the_seed():
    drawn = []

    def draw(evaluator, rng):
        drawn.append(float(rng.random()))
        return seeding_at(1, 6)

    plan = replace(plan_of(seeder(draw), restarts=3), seed=5)
    carry_out(plan, 1, Listener(never_stop))
    assert drawn == [float(np.random.default_rng(seed).random()) for seed in (5, [5, 1], [5, 2])]
    assert len(set(drawn)) == 3


def test_no_start_begins_when_time_is_up():
    plan = plan_of(placed([4, 2, 6]), restarts=3, deadline=0.0)
    outcomes, best = carry_out(plan, 1, Listener(never_stop))
    assert [outcome.reason for outcome in outcomes] == ["seconds"]
    assert best is outcomes[0]


def test_asked_to_stop_nothing_new_begins():
    reports = []

    def report(progress):
        reports.append(progress.done)
        return len(reports) == 6

    listener = Listener(report)
    outcomes, best = carry_out(plan_of(placed([4, 2, 6]), restarts=3), 1, listener)
    assert listener.stopped
    assert [outcome.reason for outcome in outcomes] == ["paused", "interrupted"]
    assert evaluations(outcomes) == [160, 80]
    assert best is outcomes[1]


def test_a_listener_remembers_that_it_was_asked_to_stop():
    answers = iter([None, True, False])
    listener = Listener(lambda progress: next(answers))
    progress = Progress(stage="search", done=1)
    assert [listener(progress) for _ in range(3)] == [False, True, True]


# --- what starts share ---------------------------------------------------------------------------


def test_a_limit_on_evaluations_is_divided_among_the_starts():
    def left(budget, restarts):
        ready = {"optimizer": stranger("optimizer", PatternSearch, max_evaluations=budget)}
        return shared_budget(ready, restarts)["optimizer"].parameters["max_evaluations"]

    assert [left(90, 1), left(90, 3), left(100, 3), left(3, 3)] == [90, 30, 33, 1]
    with pytest.raises(UsageError, match="3 starts cannot share 2 evaluations"):
        left(2, 3)
    unlimited = {"optimizer": stranger("optimizer", PatternSearch, threshold=0.1)}
    assert shared_budget(unlimited, 3) is unlimited
    assert left(None, 3) is None


def outcome_of(value, reason="converged"):
    return RunOutcome(vector=np.zeros(8), cost=Cost(0, value), reason=reason, history={})


@pytest.mark.parametrize(
    ("values", "warned"),
    [
        ([], False),
        ([20.0], False),
        ([20.0, 21.0], False),
        ([21.1, 20.0], True),
        ([-20.0, -19.0], False),
        ([-20.0, -18.9], True),
        ([0.0, 0.0], False),
        ([0.0, 1e-9], True),
    ],
)
def test_clearly_different_costs_are_warned_of(values, warned):
    assert bool(disagreement([outcome_of(value) for value in values])) == warned


def test_only_starts_that_went_on_to_the_end_can_disagree():
    early = outcome_of(9.0, "paused")
    assert disagreement([outcome_of(2.0), early, outcome_of(2.05)]) == []
    (text,) = disagreement([outcome_of(2.0), early, outcome_of(3.0, "evaluations")])
    assert text.startswith("2 of 3 starts ended at costs from 2 to 3; ")
    (text,) = disagreement([outcome_of(2.0), outcome_of(3.0)])
    assert text.startswith("2 starts ended at costs from 2 to 3; ")


# --- on a coarse shape first ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("resolution", "coarse"), [("full", False), (80, False), (79, True), (20, True)]
)
def test_a_shape_is_searched_coarsely_where_that_has_clearly_fewer_elements(resolution, coarse):
    found = searched_shape(SHEET, resolution, NO_PINS)  # 120 elements
    assert (found is not SHEET) == coarse
    assert found.n_elements <= (120 / 1.5 if coarse else 120)


def test_a_shape_whose_elements_cannot_be_grouped_is_searched_as_it_is():
    # A chessboard of pins: no two neighbours may be in one group.
    white = np.add.outer(np.arange(10), np.arange(12)).reshape(-1) % 2 == 0
    turns = {"a": np.flatnonzero(white), "b": np.flatnonzero(~white)}
    pins = read_pins(turns, ["a", "b"], 120)
    assert coarsen(SHEET, 20, pins=pins).n_elements > 80
    assert searched_shape(SHEET, 20, pins) is SHEET


def test_what_polishes_is_the_optimizer_where_it_says_how_else_the_default_one():
    own = stranger("optimizer", Staying, most=7)
    assert polisher(own, registry()).component.id == "core:pattern_search"
    found = polisher(replace(own, presets={"polish": {"most": 3}}), registry())
    assert found.component.id == "strange:made"
    assert found.parameters == {"most": 3}


def on_sheet(text="area(a)"):
    """The same problem on super-elements and on the sheet's own squares."""
    problem = Problem(["a", "b"], text, objectives={"area": area})
    whole = ProblemEvaluator(SHEET, problem, Voronoi(SHEET, 2))
    return ProblemEvaluator(COARSE, problem, Voronoi(COARSE, 2), input=whole), whole


def finished(ends, *, deadline=0.0, finer=None, polished=2):
    """What `finish` makes of ends: elements of the two centres, claimed cost, reason."""
    coarse, whole = on_sheet()
    fine = whole
    if finer is not None:
        fine = ProblemEvaluator(finer, whole.problem, Voronoi(finer, 2), input=whole)
    outcomes = [
        RunOutcome(
            vector=coarse.parameterization.encode(
                Centers(positions=SHEET.points[list(at)], weights=np.ones(2))
            ),
            cost=Cost(0, claimed),
            reason=reason,
            history={"search": ({"number": k},)},
            warning="guessed",
        )
        for k, (at, claimed, reason) in enumerate(ends)
    ]
    plan = Plan(
        coarse=coarse,
        whole=whole,
        resolution=coarse.shape.n_elements,
        ready={"optimizer": stranger("optimizer", Staying)},
        restarts=len(ends),
        finalists=1,
        polished=polished,
        seed=0,
        start=None,
        frozen=(),
        deadline=deadline,
        repeats=True,
        exchanges=False,
    )
    vars(plan)["fine"] = fine  # in place of one that would be made of as many elements
    tracked = TrackedWorkers(coarse, whole)

    class Here:
        def map(self, name, arguments, **more):
            return [plan.polish(*given, report=never_stop) for given in arguments]

        def release(self):
            pass

    best = finish(plan, outcomes, Here() if deadline is None else tracked)
    exact = [whole.evaluate_labels(whole.labels(outcome.vector)).cost for outcome in outcomes]
    return best, best.history["search"][0]["number"], exact


LOST = (100, 100)  # two centres in one place: nothing is left for the second label
SMALL, LARGE = (9, 100), (100, 9)  # the first part in a corner, and all the rest


def test_a_result_that_loses_a_part_comes_last_whatever_it_claims():
    best, number, exact = finished([(LOST, 0.0, "converged"), (LARGE, 5.0, "converged")])
    assert number == 1
    assert exact[0].empty == 1
    assert best.cost == exact[1]


def test_the_best_is_the_one_of_least_cost_on_input_elements():
    best, number, exact = finished([(LARGE, 0.0, "converged"), (SMALL, 5.0, "converged")])
    assert number == 1
    assert best.cost == exact[1] < exact[0]


@pytest.mark.parametrize(("finalist", "expected"), [(LOST, 1), (LARGE, 0)])
def test_starts_that_were_dropped_are_taken_up_where_every_finalist_loses_a_part(
    finalist, expected
):
    best, number, exact = finished([(finalist, 0.0, "converged"), (SMALL, 5.0, "paused")])
    assert number == expected
    assert best.cost == exact[expected]
    assert best.reason == ("evaluations" if expected else "converged")


def test_what_was_polished_on_a_finer_level_costs_what_it_does_on_the_whole():
    ends = [(SMALL, 5.0, "converged")]
    best, _, exact = finished(ends, deadline=None, finer=coarsen(SHEET, 150))
    _, whole = on_sheet()
    assert best.history["polish"]
    assert best.cost == whole.evaluate(best.vector).cost <= exact[0]


def test_the_best_two_are_polished_while_there_is_time():
    ends = [(LARGE, 0.0, "converged"), (SMALL, 5.0, "converged")]
    rough, *_ = finished(ends)
    best, number, exact = finished(ends, deadline=None)
    none, *_ = finished(ends, deadline=None, polished=0)
    assert "polish" not in rough.history
    assert "polish" not in none.history
    assert none.vector.tobytes() == rough.vector.tobytes()
    assert (number, best.warning, best.reason) == (1, "guessed", "converged")
    values = [record["value"] for record in best.history["polish"]]
    assert values[0] == exact[1].value
    assert best.cost.value == values[-1] <= exact[1].value


@pytest.mark.parametrize(("claimed", "polished"), [(0.5, True), (0.9, False)])
def test_what_lost_much_between_the_levels_is_polished_whatever_is_asked(claimed, polished):
    _, _, (exact,) = finished([(SMALL, 1.0, "converged")])
    ends = [(SMALL, claimed * exact.value, "converged")]
    best, *_ = finished(ends, deadline=None, polished=0)
    assert ("polish" in best.history) == polished


def test_without_a_finalist_the_best_so_far_is_judged():
    best, number, exact = finished([(SMALL, 1.0, "paused")], polished=0)
    assert (number, best.cost) == (0, exact[0])
    assert best.reason == "evaluations"
