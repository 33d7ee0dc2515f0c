"""A record of answers: what is in it is not computed, and comes out as it went in."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

from moseg_core.components.cost import WORST, Cost
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Batch
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.answer_record import (
    NO_RECORD,
    AnswerRecord,
    RecordedAnswers,
    answers_about,
    current_record,
    one_run,
    packed,
    recording,
    unpacked,
)
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.search.workers import Workers
from moseg_core.shape.pins import NO_PINS, read_pins


class Kept:
    """A sink in memory."""

    def __init__(self, known=()):
        self.known, self.written, self.runs = dict(known), [], []

    def begin(self, run):
        self.runs.append(run)
        return self.known

    def write(self, answers):
        self.written += answers

    def all(self):
        return unpacked(b"".join(self.written))


def begun(sink, **options):
    """A record of a run that goes on."""
    record = AnswerRecord(sink, **options)
    running = record.of_run(dict)
    running.__enter__()
    return record, running


@pytest.mark.parametrize("values", [[], [0.1, -0.0, math.inf, math.nan, 5e-324]])
def test_answers_come_out_as_they_went_in(values):
    found = unpacked(packed(b"k" * 16, np.array(values)) + packed(b"l" * 16, np.array([1.0])))
    assert np.array(values).tobytes() == found[b"k" * 16]
    assert list(found) == [b"k" * 16, b"l" * 16]


@pytest.mark.parametrize("size", [1, 15, 16, 19, 20, 27, 29])
def test_answers_that_are_cut_off_are_noticed(size):
    with pytest.raises(ValueError, match="cut off"):
        unpacked(packed(b"k" * 16, np.array([1.0, 2.0]))[:size])


def test_what_is_known_is_not_asked_for_again():
    asked = []

    def compute():
        asked.append(1)
        return [Cost(0, 0.1), WORST]

    sink = Kept()
    record, running = begun(sink)
    first = RecordedAnswers(record, b"here").costs("costs", [np.arange(3)], compute)
    running.__exit__(None, None, None)
    record, _ = begun(Kept(sink.all()))
    answers = RecordedAnswers(record, b"here")
    assert answers.costs("costs", [np.arange(3)], compute) == first == [Cost(0, 0.1), WORST]
    assert len(asked) == 1
    for question, given, about in (
        ("order", [np.arange(3)], b"here"),
        ("costs", [np.arange(4)], b"here"),
        ("costs", [np.arange(3.0)], b"here"),
        ("costs", [np.arange(3), ()], b"here"),
        ("costs", [np.arange(3)], b"there"),
    ):
        RecordedAnswers(record, about).costs(question, given, compute)
    assert len(asked) == 6


def test_additions_are_written_now_and_then_and_at_the_end():
    now, sink = [0.0], Kept()
    record, running = begun(sink, every=10.0, clock=lambda: now[0])
    record.add(b"a" * 16, np.zeros(1))
    assert not sink.written
    now[0] = 10.0
    record.add(b"b" * 16, np.zeros(1))
    assert len(sink.all()) == 2
    record.receive(packed(b"c" * 16, np.zeros(1)))
    assert len(sink.all()) == 2
    running.__exit__(None, None, None)
    assert len(sink.all()) == 3


def test_a_run_within_a_run_is_not_spoken_of():
    sink = Kept()
    with recording(AnswerRecord(sink)) as nothing:
        assert nothing is None
        with one_run(lambda: {"outer": 1}), one_run(lambda: {"inner": 1}):
            pass
    assert sink.runs == [{"outer": 1}]
    assert current_record() is None
    with one_run(lambda: pytest.fail("nobody asks")):
        pass


def test_copies_hand_on_what_they_add():
    sink = Kept()

    def add(k, *, report):
        record = current_record()
        record.add(bytes([k]) * 16, np.array([float(k), os.getpid()]))
        record.write()  # of which a copy does nothing
        return k

    with recording(AnswerRecord(sink)), one_run(dict):
        with Workers({"add": add}, 2, lambda progress: False) as workers:
            assert workers.map("add", [(k,) for k in range(5)]) == [0, 1, 2, 3, 4]
        written = {key: np.frombuffer(values) for key, values in sink.all().items()}
    assert {key: values[0] for key, values in written.items()} == {
        bytes([k]) * 16: float(k) for k in range(5)
    }
    assert os.getpid() not in {int(values[1]) for values in written.values()}


def test_searches_in_processes_of_their_own_are_refused():
    def search(k, *, report):
        with one_run(lambda: {"number": k}):
            return k

    with (
        recording(AnswerRecord(Kept())),
        Workers({"search": search}, 2, lambda progress: False) as workers,
        pytest.raises(UsageError, match="kept of one search"),
    ):
        workers.map("search", [(0,), (1,)])


def test_huge_answers_are_computed_again():
    sink = Kept()
    record, running = begun(sink)
    record.add(b"h" * 16, np.zeros((1 << 20) + 1))
    running.__exit__(None, None, None)
    assert not sink.written


@objective(range=(0, 9))
def size(part: Part) -> float:
    return part.area


@objective(range=(0, 9), cost="expensive")
def slow(part: Part) -> float:
    return part.area / 7


def evaluator_of(shape, problem, **options):
    from moseg_core.builtin.voronoi import Voronoi

    return ProblemEvaluator(shape, problem, Voronoi(shape, len(problem.labels)), **options)


def everything(evaluator):
    """What an evaluator answers to all questions that there are."""
    rng = np.random.default_rng(3)
    partition = evaluator.parameterization
    vectors = rng.uniform(-0.4, 0.4, (6, len(partition.lower))).clip(
        partition.lower, partition.upper
    )
    segmentation = evaluator.segmentation(evaluator.labels(vectors[0]))
    orders = [np.array(order) for order in ([0, 1, 2], [1, 0, 2], [2, 1, 0])]
    unary = evaluator.unary_costs(vectors[1])
    first = unary.known.copy(), unary.lower.copy()
    return [
        evaluator.costs(Batch(vectors=vectors)),
        evaluator.costs(Batch(vectors=vectors, best_only=True)),
        evaluator.costs(Batch(vectors=vectors, cutoff=Cost(0, 0.9), best_only=True)),
        evaluator.order_cost(segmentation, orders[1]),
        evaluator.order_costs(segmentation, orders, Cost(0, 9.0)),
        [(order.tolist(), cost) for order, cost in evaluator.labelled_costs(vectors)],
        [evaluator.evaluate(vector) for vector in vectors],
        first[0].tolist(),
        first[1].tolist(),
        unary.assign().tolist(),
        unary.known.tolist(),
        unary.all().tolist(),
        evaluator.evaluations,
        evaluator.best[0],
        evaluator.best[1].tolist(),
    ]


def test_every_question_is_answered_alike_from_a_record(row):
    text = "2*size(a) - slow(b) + size(c) + slow(a)"
    problem = Problem(["a", "b", "c"], text, objectives={"size": size, "slow": slow})
    pins = read_pins({"c": [5]}, problem.labels, row.n_elements)
    plain = everything(evaluator_of(row, problem, pins=pins))
    sink = Kept()
    with recording(AnswerRecord(sink)), one_run(dict):
        assert everything(evaluator_of(row, problem, pins=pins)) == plain
    known = Kept(sink.all())
    with recording(AnswerRecord(known)), one_run(dict):
        assert everything(evaluator_of(row, problem, pins=pins)) == plain
    assert not known.written


def test_answers_are_about_shape_problem_pins_and_partition(row, box):
    from moseg_core.builtin.voronoi import Voronoi

    first = Problem(["a", "b"], "size(a)", objectives={"size": size})
    other = Problem(["a", "b"], "2*size(a)", objectives={"size": size})
    assert answers_about(row, first, Voronoi(row, 2), NO_PINS) is NO_RECORD
    pins = read_pins({"a": [1]}, first.labels, row.n_elements)
    with recording(AnswerRecord(Kept())), one_run(dict):
        about = {
            answers_about(*given).about
            for given in (
                (row, first, Voronoi(row, 2), NO_PINS),
                (row, other, Voronoi(row, 2), NO_PINS),
                (box, first, Voronoi(box, 2), NO_PINS),
                (row, first, Voronoi(row, 2), pins),
                (row, first, Voronoi(row, 3), NO_PINS),
            )
        }
    assert len(about) == 5
