"""Where a search begins: what seeders and labelers may return, and what the start obeys."""

from __future__ import annotations

import types
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Centers, Progress, Seeding, never_stop
from moseg_core.errors import PluginError, UsageError
from moseg_core.search.beginning import begin
from tests.made_up import (
    STRIP,
    centers_at,
    fail,
    labeler,
    on_strip,
    seeder,
    seeding_at,
    stranger,
)
from tests.reflections import known

AS_THEY_ARE = labeler([0, 1])


def begun(evaluator, seeds=None, labels=AS_THEY_ARE, *, report=never_stop, **options):
    ready = {
        "seeder": seeds or seeder(fail),
        "labeler": labels,
        "optimizer": stranger("optimizer", PatternSearch),
    }
    rng = np.random.default_rng(0)
    return begin(evaluator, ready, rng=rng, report=report, **options)


def vector_of(evaluator, run):
    """The whole vector that a run begins at."""
    return evaluator.constraints.expand(run.base[None])[0]


def squares_of(evaluator, run):
    """The squares in whose middles the centres of a run begin."""
    positions = evaluator.parameterization.decode(vector_of(evaluator, run)).positions
    assert positions[:, 1] == pytest.approx(0.5)
    return (positions[:, 0] - 0.5).tolist()


# --- seeders and labelers ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "garbage",
    [
        None,
        "centres",
        fail,
        Seeding(centers=np.zeros((1, 3))),
        Seeding(centers=np.zeros((3, 3))),
        Seeding(centers=np.zeros((2, 2))),
        Seeding(centers=np.full((2, 3), np.nan)),
        Seeding(centers=np.array([[0.0, 0, 0], [0, 0, np.inf]])),
        Seeding(centers=None),
        Seeding(centers=[["a", "b", "c"]] * 2),
        Seeding(centers=np.full((2, 3), None)),
        Seeding(centers=[[0.0, 0.0, 0.0], [0.0]]),
        types.SimpleNamespace(centers=np.eye(3)[:2]),
        Seeding(centers=np.eye(3)[:2], history=({"round": "first"},)),
    ],
    ids=[
        *["None", "text", "raises", "1 centre", "3 centres", "2 coordinates", "nan", "inf"],
        *["no centres", "words", "objects", "ragged", "no Seeding", "history of words"],
    ],
)
def test_a_seeder_that_returns_garbage_is_named(garbage):
    with pytest.raises(
        PluginError,
        match=r"seeder 'strange:made' of moseg-strange 2\.0 (failed: ValueError|has a history that"
        r" is not made of numbers|must return a Seeding of 2 finite centres)",
    ):
        begun(on_strip(), seeder(garbage))


@pytest.mark.parametrize(
    "weights",
    [[1.0], np.ones((2, 1)), [0.0, 1], [-1.0, 1], [np.nan, 1], [1, np.inf], "ab", [1, None], 1.0],
    ids=["1 of 2", "a column", "0", "-1", "nan", "inf", "text", "None", "a number"],
)
def test_a_seeder_with_impossible_weights_is_named(weights):
    seeding = replace(seeding_at(1, 6), weights=weights)
    with pytest.raises(
        PluginError,
        match=r"seeder 'strange:made' of moseg-strange 2\.0 must weigh 2 centres by positive",
    ):
        begun(on_strip(), seeder(seeding))


def test_the_search_begins_with_the_weights_of_the_seeder():
    evaluator = on_strip()
    for weights, expected in ([0.5, 2], [0.5, 2.0]), (None, [1.0, 1.0]):
        run = begun(evaluator, seeder(replace(seeding_at(1, 6), weights=weights)))
        assert squares_of(evaluator, run) == [1, 6]
        found = evaluator.parameterization.decode(vector_of(evaluator, run)).weights
        assert found.tolist() == expected


def test_labels_go_to_centres_with_their_weights():
    evaluator = on_strip()
    run = begun(evaluator, seeder(replace(seeding_at(1, 6), weights=[0.5, 2])), labeler([1, 0]))
    found = evaluator.parameterization.decode(vector_of(evaluator, run))
    assert (found.positions[:, 0] - 0.5).tolist() == [6, 1]
    assert found.weights.tolist() == [2.0, 0.5]


@pytest.mark.parametrize(
    "garbage",
    [
        None,
        fail,
        "ab",
        1,
        [0, 0],
        [0, 2],
        [-1, 0],
        [0],
        [0, 1, 2],
        [[0], [1]],
        [0.0, 1.0],
        [False, True],
        ["a", 0],
        [[0, 1], [1]],
        [None, 0],
    ],
    ids=lambda garbage: "raises" if garbage is fail else str(garbage),
)
def test_a_labeler_that_returns_garbage_is_named(garbage):
    with pytest.raises(PluginError, match=r"labeler 'strange:made' of moseg-strange 2\.0"):
        begun(on_strip(), seeder(seeding_at(1, 6)), labeler(garbage))


class Fenced(Voronoi):
    """Centres stay near to the shape."""

    @property
    def lower(self):
        return np.maximum(super().lower, -1.0)

    @property
    def upper(self):
        return np.minimum(super().upper, 1.0)


@pytest.mark.parametrize("shift", [-100.0, 100.0])
def test_centres_outside_the_bounds_are_the_fault_of_the_seeder(shift):
    far = Seeding(centers=STRIP.points[[1, 6]] + [shift, 0, 0])
    with pytest.raises(PluginError, match=r"seeder 'strange:made' .* outside the bounds"):
        begun(on_strip(partition=Fenced), seeder(far))
    assert begun(on_strip(), seeder(far)).free.all()


def test_labels_go_to_the_centres_that_the_labeler_says():
    evaluator = on_strip()
    seen = []

    def turned(evaluator, vector):
        seen.append(vector)
        return np.array([1, 0], np.int32)

    run = begun(evaluator, seeder(seeding_at(1, 6)), labeler(turned))
    assert squares_of(evaluator, run) == pytest.approx([6, 1])
    assert evaluator.parameterization.decode(seen[0]).weights.tolist() == [1.0, 1.0]


def test_a_labelled_seeding_asks_no_labeler():
    evaluator = on_strip()
    run = begun(evaluator, seeder(seeding_at(6, 1, labelled=True)), labeler(fail))
    assert squares_of(evaluator, run) == pytest.approx([6, 1])


def test_a_run_tells_of_its_seeding():
    rounds = ({"round": np.int64(1), "step": np.float32(0.5)}, {"round": 2, "step": 0})
    run = begun(on_strip(), seeder(seeding_at(1, 6, history=rounds, warning="guessed")))
    assert run.seeding == ({"round": 1, "step": 0.5}, {"round": 2, "step": 0})
    assert [type(value) for value in run.seeding[0].values()] == [int, float]
    assert (run.warning, run.stage, run.evaluations) == ("guessed", "made", 0)


@pytest.mark.parametrize(
    ("asked", "deadline", "stop"),
    [(False, None, False), (True, None, True), (False, 0.0, True), (False, np.inf, False)],
)
def test_a_seeder_is_asked_to_stop_by_the_report_or_when_time_is_up(asked, deadline, stop):
    answers, seen = [], []

    class Made:
        def __call__(self, evaluator, *, rng, report):
            answers.append(report(Progress(stage="seeding", done=1)))
            return seeding_at(1, 6)

    def report(progress):
        seen.append(progress.stage)
        return asked

    begun(on_strip(), stranger("seeder", Made), report=report, deadline=deadline)
    assert (answers, seen) == ([stop], ["seeding"])


# --- starts, constraints and frozen labels -------------------------------------------------------


def test_centres_by_hand_skip_seeder_and_labeler():
    evaluator = on_strip()
    start = centers_at(5, 2, weights=[1.0, 1.5])
    run = begun(evaluator, seeder(fail), labeler(fail), start=start)
    assert run.base.tobytes() == evaluator.parameterization.encode(start).tobytes()
    assert run.seeding == ()


@pytest.mark.parametrize(
    "start",
    [
        centers_at(1, 6, weights=[1.0, 0.0]),
        centers_at(1, 6, weights=[1.0, -2.0]),
        centers_at(1, 6, weights=[1.0, np.inf]),
        Centers(positions=np.full((2, 3), np.nan), weights=np.ones(2)),
    ],
    ids=["weight 0", "weight below 0", "weight inf", "nan"],
)
def test_a_start_that_cannot_be_used_is_the_fault_of_who_gave_it(start):
    with pytest.raises(UsageError, match="the start must have finite centres and positive"):
        begun(on_strip(), start=start)


def constrained(*rules, text="area(a)", **more):
    return on_strip(text, constraints=list(rules), registry=known(), **more)


def test_seeds_are_moved_to_where_constraints_hold():
    evaluator = constrained("onplane(a)")  # the plane is x = 4
    run = begun(evaluator, seeder(seeding_at(1, 6)))
    assert squares_of(evaluator, run) == pytest.approx([3.5, 6])


@pytest.mark.parametrize(("pins", "expected"), [({}, [3.5, 7]), ({"a": [7]}, [3.5, 4])])
def test_alike_labels_change_places_where_that_moves_centres_less_unless_pinned(pins, expected):
    evaluator = constrained("onplane(a)", text="area(a, b)", pins=pins)
    assert evaluator.problem.alike == ((0, 1),)
    run = begun(evaluator, seeder(seeding_at(7, 4)))
    assert squares_of(evaluator, run) == pytest.approx(expected)


def test_a_frozen_label_must_start_where_constraints_allow_it():
    evaluator = constrained("onplane(a)")
    start = centers_at(1, 6)
    with pytest.raises(UsageError, match="label 'a' is frozen at a place that the constraints do"):
        begun(evaluator, start=start, frozen=[0])
    assert squares_of(evaluator, begun(evaluator, start=start, frozen=[1]))[1] == 6
    allowed = Centers(positions=np.array([[4.0, 0.5, 0], [6.5, 0.5, 0]]), weights=np.ones(2))
    run = begun(evaluator, start=allowed, frozen=[0])
    assert squares_of(evaluator, run) == pytest.approx([3.5, 6])
    assert run.free.sum() == 4


def test_a_frozen_label_draws_those_that_follow_it_or_lead_it():
    evaluator = constrained("mirror(b, a)")
    for frozen, expected in ((0, [1, 6]), (1, [3, 4])):
        run = begun(evaluator, start=centers_at(1, 4), frozen=[frozen])
        assert squares_of(evaluator, run) == pytest.approx(expected)
        assert not run.free.any()


# --- pins ----------------------------------------------------------------------------------------


def broken_pins(evaluator, run):
    return evaluator.pins.broken(evaluator.labels(vector_of(evaluator, run)))


def test_centres_move_towards_pins_that_the_start_breaks():
    evaluator = on_strip(pins={"a": [6, 7]})
    start = centers_at(1, 5)
    encoded = evaluator.parameterization.encode(start)
    assert evaluator.pins.broken(evaluator.labels(encoded)) == 2
    run = begun(evaluator, start=start)
    assert broken_pins(evaluator, run) == 0
    assert squares_of(evaluator, run)[1] == 5  # a label without pins stays


def test_centres_stay_where_no_pin_is_broken():
    evaluator = on_strip(pins={"a": [0, 1], "b": [7]})
    start = centers_at(2, 5)
    run = begun(evaluator, start=start)
    assert run.base.tobytes() == evaluator.parameterization.encode(start).tobytes()


def test_frozen_centres_do_not_move_towards_their_pins():
    evaluator = on_strip(pins={"a": [6, 7]})
    start = centers_at(1, 5)
    run = begun(evaluator, start=start, frozen=[0])
    assert run.base.tobytes() == evaluator.parameterization.encode(start).tobytes()
    assert broken_pins(evaluator, run) == 2


def test_a_label_that_follows_a_frozen_one_does_not_draw_it_towards_pins():
    evaluator = constrained("mirror(b, a)", pins={"b": [3]})
    for frozen, expected in (([0], [0, 7]), ([], [4, 3])):
        run = begun(evaluator, start=centers_at(0, 7), frozen=frozen)
        assert squares_of(evaluator, run) == pytest.approx(expected)


def test_centres_move_towards_pins_as_far_as_constraints_allow():
    evaluator = constrained("mirror(b, a)", pins={"a": [7], "b": [0]})
    run = begun(evaluator, start=centers_at(2, 5))
    assert broken_pins(evaluator, run) == 0
    one, other = squares_of(evaluator, run)
    assert one + other == pytest.approx(7)


def test_of_several_centres_the_nearest_moves_towards_a_pin():
    def twice(shape, n):
        return Voronoi(shape, n, centers="a=2", labels=["a", "b"])

    evaluator = on_strip(partition=twice, pins={"a": [5]})
    start = centers_at(1, 2, 6)
    run = begun(evaluator, start=replace(start, parts=np.array([0, 0, 1])))
    assert broken_pins(evaluator, run) == 0
    assert squares_of(evaluator, run) == pytest.approx([1, 5, 6])


def test_a_seeder_gives_one_centre_where_a_label_has_several():
    def twice(shape, n):
        return Voronoi(shape, n, centers="a=2", labels=["a", "b"])

    run = begun(on_strip(partition=twice), seeder(seeding_at(1, 6)), labeler([1, 0]))
    assert squares_of(on_strip(partition=twice), run) == pytest.approx([6, 6, 1])
    assert run.free.all()
    assert len(run.free) == 12
