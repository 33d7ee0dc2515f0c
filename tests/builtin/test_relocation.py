"""Short searches of some centres, and centres moved elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.genome import Genome
from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.builtin.relocation import Found, Relocation, candidates_of, different
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import on_strip
from tests.reflections import known

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
LABELS = ("stem", "bar", "rest")
TEXT = "2*narrow(stem) + compact(bar) - 0.5*flat(rest) + similar_proportions(stem, bar)"


def relocation_on(evaluator, *, stop_after=np.inf):
    counted = []
    relocation = Relocation(
        genome=Genome.of(evaluator),
        points=evaluator.shape.points[::3],
        count=counted.append,
        stopped=lambda: len(counted) >= stop_after,
    )
    return relocation, counted


def made(**options):
    problem = Problem(LABELS, TEXT)
    evaluator = ProblemEvaluator(SHAPE, problem, Voronoi(SHAPE, len(LABELS)))
    relocation, counted = relocation_on(evaluator, **options)
    return evaluator, relocation, counted


def found_at(evaluator, relocation, elements=(0, 20, 40)):
    rows = np.column_stack([SHAPE.points[list(elements)], [1.0, 0.5, 1.5]])
    return Found(cost=evaluator.evaluate(relocation.vector(rows)).cost, rows=rows)


@pytest.mark.parametrize("moved", [[0, 1, 2], [1], [2, 0]])
def test_settling_is_a_pattern_search_of_the_rows_that_were_moved(moved):
    evaluator, relocation, counted = made()
    start = found_at(evaluator, relocation)
    rng = np.random.default_rng(0)
    found = relocation.settle(start, moved, step=0.1, threshold=0.02, polls=6, rng=rng)
    # The same, with the whole vector written out and everything evaluated.
    columns = np.concatenate([np.arange(4 * k, 4 * k + 4) for k in moved])
    box = SHAPE.unit_points
    search = PatternSearch(
        relocation.vector(start.rows)[columns],
        np.tile([*(box.min(axis=0) - 0.05), 0.02], len(moved)),
        np.tile([*(box.max(axis=0) + 0.05), np.inf], len(moved)),
        np.ones(len(columns)),
        rng=rng,
        pattern_size=0.1,
        threshold=0.02,
        max_evaluations=1 + 6 * 8 * len(moved),
    )
    count = -1
    while not search.finished:
        costs = []
        for x in search.ask().vectors:
            vector = relocation.vector(start.rows)
            vector[columns] = x
            costs.append(evaluator.evaluate(vector).cost)
        search.tell(costs)
        count += len(costs)
    assert found.cost == search.best[1] < start.cost
    ended = relocation.vector(start.rows)
    ended[columns] = search.best[0]
    assert relocation.vector(found.rows) == pytest.approx(ended)
    still = [k for k in range(3) if k not in moved]
    assert (found.rows[still] == start.rows[still]).all()
    assert sum(counted) == count


def test_centres_stay_near_the_shape_and_keep_some_weight():
    evaluator = on_strip("-area(a)")  # a wants everything: far away, or heavy
    relocation, _ = relocation_on(evaluator)
    rows = np.column_stack([evaluator.shape.points[[0, 7]], [1.0, 0.1]])
    start = Found(cost=Cost(0, 0.0), rows=rows)
    found = relocation.settle(
        start, [0, 1], step=0.5, threshold=0.01, polls=30, rng=np.random.default_rng(0)
    )
    box, margin = evaluator.shape.points, (0.05 + 1e-9) * evaluator.shape.frame.scale
    assert (found.rows[:, :3] >= box.min(axis=0) - margin).all()
    assert (found.rows[:, :3] <= box.max(axis=0) + margin).all()
    assert (found.rows[:, 3] >= 0.02).all()


def test_a_relocation_moves_one_centre_or_exchanges_two():
    evaluator, relocation, _ = made()
    start = found_at(evaluator, relocation)
    before = start.rows.copy()
    kinds = {"place": 0, "shaken": 0, "exchange": 0}
    rng = np.random.default_rng(1)
    for _ in range(600):
        rows, moved = relocation.relocated(start, rng)
        still = [k for k in range(3) if k not in moved]
        assert (rows[still] == start.rows[still]).all()
        if len(moved) == 2:
            kinds["exchange"] += 1
            assert (rows[moved] == start.rows[moved[::-1]]).all()
        elif (relocation.points == rows[moved[0], :3]).all(axis=1).any():
            kinds["place"] += 1
            assert rows[moved[0], 3] == start.rows[moved[0], 3]
        else:
            kinds["shaken"] += 1
            shift = rows[moved[0]] - start.rows[moved[0]]
            assert np.linalg.norm(shift[:3]) < 0.4 * SHAPE.frame.scale
    assert (start.rows == before).all()
    assert [n / 600 for n in kinds.values()] == pytest.approx([0.5, 0.2, 0.3], abs=0.06)


def test_only_labels_of_a_role_are_exchanged():
    evaluator = on_strip(names=("a", "b", "c"), constraints=["mirror(a, b)"], registry=known())
    relocation, _ = relocation_on(evaluator)
    rows = np.column_stack([evaluator.shape.points[[1, 3]], np.ones(2)])
    rng = np.random.default_rng(0)
    for _ in range(50):
        _, moved = relocation.relocated(Found(cost=Cost(0, 0.0), rows=rows), rng)
        assert len(moved) == 1


def test_the_best_so_far_never_gets_worse_and_costs_what_it_says():
    evaluator, relocation, counted = made()
    racers = [found_at(evaluator, relocation), found_at(evaluator, relocation, (5, 30, 45))]
    racers.sort(key=lambda found: found.cost)
    best = list(relocation.improved(racers, 12, np.random.default_rng(0)))
    costs = [found.cost for found in best]
    assert len(best) == 13
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] < racers[0].cost
    for found in best:
        assert evaluator.evaluate(relocation.vector(found.rows)).cost == found.cost
    assert sum(counted) <= candidates_of(12, 3)


@pytest.mark.parametrize("after", [1, 3, 40])
def test_it_ends_soon_after_it_is_asked_to_stop(after):
    evaluator, relocation, counted = made(stop_after=after)
    racers = [found_at(evaluator, relocation)]
    best = list(relocation.improved(racers, 30, np.random.default_rng(0)))
    assert len(counted) <= after + 1
    assert best[-1].cost <= racers[0].cost


def test_racers_differ_clearly_and_the_best_of_them_come_first():
    def found(value, *xs):
        rows = np.zeros((len(xs), 4))
        rows[:, 0] = xs
        return Found(cost=Cost(0, value), rows=rows)

    ranked = [found(1.0, 0, 1), found(1.5, 0.05, 1.05), found(2.0, 0, 1.2), found(3.0, 0, 0.85)]
    assert different(ranked, 1.0) == [ranked[0], ranked[2], ranked[3]]
    many = [found(float(k), 0, k) for k in range(20)]
    assert different(many, 1.0) == many[:6]
    assert different(many, 30.0) == many[::3][:6]
    assert candidates_of(0, 5) == 0
