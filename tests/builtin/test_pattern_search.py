"""Pattern search against its literal version, step by step, and what it does with odd costs."""

from __future__ import annotations

import itertools
import math
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Optimizer
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import references, shapes


def make(start, lower=None, upper=None, scale=None, **parameters):
    start = np.asarray(start, np.float64)
    m = len(start)
    return PatternSearch(
        start,
        np.full(m, -np.inf) if lower is None else np.asarray(lower, np.float64),
        np.full(m, np.inf) if upper is None else np.asarray(upper, np.float64),
        np.ones(m) if scale is None else np.asarray(scale, np.float64),
        rng=np.random.default_rng(0),
        **parameters,
    )


def step(search, function):
    batch = search.ask()
    search.tell([Cost(*function(vector.tolist())) for vector in batch.vectors])
    return batch


def run(search, function):
    batches = []
    while not search.finished:
        batches.append(step(search, function))
    return batches


def assert_same(search, expected):
    point, cost, history = expected
    assert search.best[0].tolist() == point
    assert tuple(search.best[1]) == tuple(cost)
    assert [
        (record["evaluations"], (record["empty"], record["value"]), record["step"])
        for record in search.history
    ] == history


# --- functions to minimise; a cost is (empty parts, value) ---------------------------------------


def bowl(x):
    return 0, sum((k + 1) * (v - 0.3 * k) ** 2 for k, v in enumerate(x))


def stairs(x):
    """Flat nearly everywhere, so that neighbours tie."""
    return 0, float(sum(abs(math.floor(3 * v - k)) for k, v in enumerate(x)))


def valley(x):
    return 0, sum(100 * (b - a * a) ** 2 + (1 - a) ** 2 for a, b in itertools.pairwise(x))


def with_empty(x):
    """Far out a part becomes empty, where the value alone would be best."""
    return (1, -100.0) if max(map(abs, x)) > 0.7 else bowl(x)


FUNCTIONS = [bowl, stairs, valley, with_empty]


@given(
    function=st.sampled_from(FUNCTIONS),
    start=st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=7),
    combine=st.booleans(),
    size=st.sampled_from([0.2, 0.5, 1.0, 1e-3]),
    expansion=st.sampled_from([1.0, 2.0, 3.0]),
    contraction=st.sampled_from([0.5, 0.3, 0.9]),
    threshold=st.sampled_from([1e-6, 1e-3, 0.3]),
    budget=st.sampled_from([None, 1, 2, 3, 7, 50, 120]),
    bounded=st.booleans(),
    scaled=st.booleans(),
)
@settings(max_examples=150, deadline=None)
def test_every_step_is_that_of_the_literal_search(
    function, start, combine, size, expansion, contraction, threshold, budget, bounded, scaled
):
    m = len(start)
    lower, upper = [-math.inf] * m, [math.inf] * m
    if bounded:  # with room to one side at least
        lower = [v - 0.01 * k for k, v in enumerate(start)]
        upper = [v + 4.0 for v in start]
    scale = [1.0 + 0.5 * k for k in range(m)] if scaled else [1.0] * m
    parameters = {
        "pattern_size": size,
        "expansion": expansion,
        "contraction": contraction,
        "threshold": threshold,
        "max_evaluations": 600 if budget is None else budget,
        "combine": combine,
    }
    search = make(start, lower, upper, scale, **parameters)
    batches = run(search, function)
    assert_same(
        search, references.pattern_search(function, start, lower, upper, scale, **parameters)
    )
    asked = [len(batch.vectors) for batch in batches]
    assert sum(asked) == search.history[-1]["evaluations"] <= parameters["max_evaluations"]
    assert batches[0].vectors.tolist() == [start]
    for batch in batches:
        assert ((batch.vectors >= lower) & (batch.vectors <= upper)).all()
        assert len(batch.vectors) > 0


def test_it_answers_the_protocol():
    assert isinstance(make([0.0]), Optimizer)


def test_the_first_batch_is_the_start_and_the_others_are_complete_polls():
    search = make([1.0, 2.0])
    first = step(search, bowl)
    assert first.vectors.tolist() == [[1.0, 2.0]]
    assert first.cutoff is None
    assert not first.best_only
    second = search.ask()
    assert second.vectors.tolist() == [[1.2, 2.0], [0.8, 2.0], [1.0, 2.2], [1.0, 1.8]]
    assert second.cutoff == search.best[1] == Cost(*bowl([1.0, 2.0]))
    assert second.best_only


def test_the_best_neighbour_is_taken_and_of_equal_ones_the_first():
    search = make([0.0, 0.0])
    search.ask()
    search.tell([Cost(0, 9.0)])
    search.ask()
    search.tell([Cost(0, 5.0), Cost(0, 3.0), Cost(0, 3.0), Cost(0, 4.0)])
    assert search.best[0].tolist() == [-0.2, 0.0]
    assert search.ask().vectors[0].tolist() == [0.2, 0.0]  # the step has doubled


def test_moves_that_were_better_are_combined_one_along_each_coordinate():
    search = make([0.0, 0.0, 0.0], combine=True)
    search.ask()
    search.tell([Cost(0, 9.0)])
    assert not search.ask().best_only  # all that are better must be known
    search.tell([Cost(0, v) for v in (8.0, 5.0, 7.0, 10.0, 6.0, 6.5)])
    assert search.best[0].tolist() == [-0.2, 0.0, 0.0]
    batch = search.ask()
    assert batch.vectors.tolist() == [[-0.2, 0.0, 0.2], [-0.2, 0.2, 0.2]]
    assert (batch.cutoff, batch.best_only) == (Cost(0, 5.0), True)
    search.tell([Cost(0, 4.0), Cost(0, 4.5)])
    assert search.best[0].tolist() == [-0.2, 0.0, 0.2]
    assert search.ask().vectors[0].tolist() == [0.2, 0.0, 0.2]  # the step has doubled once


def test_combined_moves_save_evaluations_where_coordinates_are_independent():
    start = [1.0 + 0.1 * k for k in range(12)]
    spent = {}
    for combine in (False, True):
        search = make(start, combine=combine, threshold=1e-3)
        run(search, bowl)
        assert search.best[1].value < 1e-3
        spent[combine] = search.history[-1]["evaluations"]
    assert spent[True] < spent[False] / 2


def test_an_equal_neighbour_is_no_success():
    search = make([0.0])
    run(search, lambda x: (0, 1.0))
    assert search.best[0].tolist() == [0.0]
    assert [record["step"] for record in search.history[1:]] == [
        0.2 * 0.5**k for k in range(len(search.history) - 1)
    ]
    assert search.finished == "converged"
    assert 1e-6 <= search.history[-1]["step"] < 2e-6


def test_answers_that_are_only_bounds_change_nothing():
    # Half-way down to the winner, or to the cutoff where nobody is below it: so much is allowed.
    exact, bounded = make([0.9, -0.4]), make([0.9, -0.4])
    while not exact.finished:
        step(exact, bowl)
        batch = bounded.ask()
        costs = [Cost(*bowl(vector.tolist())) for vector in batch.vectors]
        least = min(costs)
        if batch.cutoff is not None and least >= batch.cutoff:
            least = batch.cutoff
        bounded.tell([Cost(0, (cost.value + least.value) / 2) for cost in costs])
    assert bounded.history == exact.history
    assert bounded.best[0].tolist() == exact.best[0].tolist()


def test_infeasible_weights_are_skipped_and_not_counted():
    smallest = float(np.finfo(np.float64).tiny)
    seen = []

    def function(x):
        seen.append(x)
        return 0, (x[0] - 1.0) ** 2 + x[1]  # the second wants to be as small as it can

    search = make([0.0, 0.35], lower=[-math.inf, smallest], upper=[math.inf] * 2)
    run(search, function)
    assert search.finished == "converged"
    assert all(x[1] > 0 for x in seen)
    assert search.history[-1]["evaluations"] == len(seen)
    assert 0 < search.best[0][1] < 1e-5
    assert any(
        b["evaluations"] - a["evaluations"] == 3 for a, b in itertools.pairwise(search.history)
    )


@pytest.mark.parametrize("budget", range(1, 25))
def test_the_budget_is_kept_exactly(budget):
    asked = []
    search = make([0.0, 1.0, 2.0], max_evaluations=budget)
    run(search, lambda x: (asked.append(x), bowl(x))[1])
    assert len(asked) == budget == search.history[-1]["evaluations"]
    assert search.finished == "evaluations"
    assert search.best[1] == min(Cost(*bowl(x)) for x in asked)


def test_a_search_that_converges_on_its_last_evaluation_has_converged():
    free = make([0.0])
    run(free, bowl)
    search = make([0.0], max_evaluations=int(free.history[-1]["evaluations"]))
    run(search, bowl)
    assert search.finished == free.finished == "converged"


@pytest.mark.parametrize("room", [0.0, 3e-7])
def test_without_room_to_step_nothing_more_is_evaluated(room):
    asked = []
    search = make([0.5, 0.5], lower=[0.5 - room, 0.5], upper=[0.5 + room, 0.5])
    run(search, lambda x: (asked.append(x), bowl(x))[1])
    assert search.finished == "converged"
    # Every step that fits is below the threshold of 1e-6.
    assert asked == [[0.5, 0.5]]


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("where", ["start", "neighbours", "everywhere"])
def test_costs_that_are_not_finite_are_survived(odd, where):
    def function(x):
        at_start = x == [0.0, 0.0]
        bad = {"start": at_start, "neighbours": not at_start, "everywhere": True}[where]
        return (0, odd) if bad else bowl(x)

    search = make([0.0, 0.0], threshold=1e-3, max_evaluations=500)
    run(search, function)
    value = search.best[1].value
    assert not math.isnan(value)
    assert all(not math.isnan(record["value"]) for record in search.history)
    assert search.finished == "converged"
    if odd == -math.inf:
        assert value == odd
    elif where == "everywhere":
        assert value == math.inf
        assert search.best[0].tolist() == [0.0, 0.0]
    elif where == "neighbours":
        assert search.best == (pytest.approx([0.0, 0.0]), Cost(*bowl([0.0, 0.0])))
    else:
        assert math.isfinite(value)


def test_nan_with_fewer_empty_parts_is_left_again_for_a_number():
    search = make([0.0], max_evaluations=60)
    # All around the start NaN, which is better than an empty part and worse than any number.
    run(search, lambda x: (1, 5.0) if x[0] == 0.0 else (0, math.nan if abs(x[0]) < 0.5 else 1e9))
    assert search.best[1] == Cost(0, 1e9)
    assert all(not math.isnan(record["value"]) for record in search.history)


def test_fewer_empty_parts_are_worth_any_value():
    search = make([0.0], max_evaluations=60)
    run(search, lambda x: (2, -1e9) if x[0] < 0.1 else (1, math.nan) if x[0] < 0.5 else (0, 1e9))
    assert search.best[1] == Cost(0, 1e9)
    assert [record["empty"] for record in search.history][:2] == [2, 1]


@given(st.sampled_from(FUNCTIONS), st.sets(st.integers(0, 40), max_size=6))
@settings(max_examples=30, deadline=None)
def test_a_search_put_aside_and_taken_up_again_goes_on_as_if_nothing_had_been(function, pauses):
    parameters = {"threshold": 1e-4, "max_evaluations": 300}
    whole = make([0.4, -1.0, 0.2], **parameters)
    run(whole, function)
    search = make([0.4, -1.0, 0.2], **parameters)
    rounds = 0
    while not search.finished:
        if rounds in pauses:
            search = pickle.loads(pickle.dumps(search))
        step(search, function)
        rounds += 1
    search = pickle.loads(pickle.dumps(search))
    assert search.history == whole.history
    assert search.best[0].tolist() == whole.best[0].tolist()
    assert (search.finished, search.progress) == (whole.finished, 1.0)


def test_the_start_is_not_written_to():
    start = np.array([0.4, -1.0])
    search = make(start)
    run(search, bowl)
    assert start.tolist() == [0.4, -1.0]


def test_progress_goes_from_nothing_to_all():
    search = make([0.4, -1.0])
    seen = [search.progress]
    while not search.finished:
        step(search, bowl)
        seen.append(search.progress)
    assert seen[0] == 0.0
    assert seen[-1] == 1.0
    assert all(0.0 <= share <= 1.0 for share in seen)
    assert sorted(seen)[len(seen) // 2] > 0.1
    assert make([0.0], pattern_size=1e-6, threshold=1e-6).progress == 1.0


def test_costs_come_after_candidates():
    search = make([0.0])
    with pytest.raises(UsageError, match="tell"):
        search.tell([Cost(0, 1.0)])
    step(search, bowl)
    with pytest.raises(UsageError, match="tell"):
        search.tell([Cost(0, 1.0)])


# --- a real segmentation -------------------------------------------------------------------------


@objective(range=(0, 1))
def slender(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@objective(range=(0, math.inf), cost="expensive")
def unlike(first: Part, second: Part) -> float:
    return float(abs(first.area - second.area) / (first.area + second.area))


@pytest.mark.parametrize("text", ["slender(a) + slender(b)", "2*slender(b) - unlike(a, b)"])
def test_a_segmentation_is_searched_as_literally(text):
    mesh = shapes.jitter(shapes.bent_capsule(8, 5), 6)
    shape = Shape.from_mesh(*mesh)
    problem = Problem(["a", "b"], text, objectives={"slender": slender, "unlike": unlike})
    neighbors = references.edge_neighbors(*mesh)
    points = shape.unit_points.tolist()

    def literal(vector):
        rows = [vector[4 * k : 4 * k + 4] for k in range(2)]
        labels = references.connected_partition(
            points, neighbors, [row[:3] for row in rows], [row[3] for row in rows]
        )
        return tuple(problem.evaluate(shape, labels, memo=Memo(size=0)).cost)

    voronoi = Voronoi(shape, 2)
    evaluator = ProblemEvaluator(shape, problem, voronoi)
    at = Centers(positions=shape.points[[3, 12]], weights=np.ones(2))
    start = voronoi.encode(at)
    parameters = {"threshold": 5e-3, "pattern_size": 0.2}
    search = PatternSearch(
        start, voronoi.lower, voronoi.upper, voronoi.scale, rng=np.random.default_rng(0),
        **parameters,
    )  # fmt: skip
    while not search.finished:
        search.tell(evaluator.costs(search.ask()))
    expected = references.pattern_search(
        literal, start.tolist(), voronoi.lower, voronoi.upper, voronoi.scale, **parameters
    )
    assert_same(search, expected)
    assert search.best[1] < Cost(*literal(start.tolist()))
    assert evaluator.evaluations == search.history[-1]["evaluations"]
