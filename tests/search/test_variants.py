"""Which labels a shape has: the rule that chooses, and the searches that share a budget."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from moseg_core.components.protocols import Progress
from moseg_core.errors import PluginError, UsageError
from moseg_core.io import read_result, save
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search import restarts
from moseg_core.search import variants as module
from moseg_core.search.levels import solve_hierarchy
from moseg_core.search.variants import (
    check_variants,
    score,
    segment_variants,
    solve_variants,
    tried_sets,
    typical_cost,
)
from moseg_core.shape.shape import Shape
from tests.shapes import solid, strip

QUICK = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=60)", "restarts": 1}

# A body of 10 by 6 by 3 cubes and legs of 2 by 2 by 6, at its corners; a tail of 8 cubes in a row.
CORNERS = ((0, 0), (8, 4), (8, 0), (0, 4))
LIKE = (
    "is(body, thickness=0.25+-0.06, area=0.5+-0.15) + 3*convex(body)"
    " + is(leg*, thickness=0.14+-0.03, area=0.12+-0.03, boundary=1.1+-0.3) + 3*convex(leg*)"
    " + is(tail, thickness=0.06+-0.02, area=0.07+-0.02) + 3*convex(tail)"
)


def beast(legs: int, tail: bool) -> tuple[Shape, np.ndarray]:
    """A body with so many legs; for each face 0 on the body, 1 to 4 on a leg, 5 on the tail."""
    cells = list(product(range(10), range(6), range(3)))
    for x, y in CORNERS[:legs]:
        cells += [(x + i, y + j, -1 - k) for i, j, k in product(range(2), range(2), range(6))]
    if tail:
        cells += [(10 + k, 3, 2) for k in range(8)]
    shape = Shape.from_mesh(*solid(cells), name="beast")
    x, y, z = shape.points.T
    leg = 1 + np.array([0, 3, 2, 1])[2 * (x > 5) + (y > 3)]  # the number of the corner
    return shape, np.where(z < 0, leg, np.where(x > 10, 5, 0))


def labelled(problem: Problem, shape: Shape, parts: np.ndarray) -> np.ndarray:
    """The true parts under a problem's labels.

    A part without a label goes to the body. A label without a part takes a fifth of the largest
    part, from one end.
    """
    here = [0] + [k for k in range(1, 6) if (parts == k).any()]
    legs = [k for k, name in enumerate(problem.labels) if name.startswith("leg")]
    labels = np.zeros(len(parts), np.int64)
    for k, part in zip(legs, [k for k in here if 0 < k < 5], strict=False):
        labels[parts == part] = k
    if "tail" in problem.labels:
        labels[parts == 5] = problem.labels.index("tail")
    for k in range(1, len(problem.labels)):
        if not (labels == k).any():
            largest = np.flatnonzero(labels == np.bincount(labels).argmax())
            along = largest[np.argsort(shape.points[largest, 0], kind="stable")]
            labels[along[: len(along) // 5]] = k
    return labels


@pytest.mark.parametrize(("legs", "tail"), [*product((2, 3, 4), (False, True))])
def test_the_rule_chooses_the_labels_that_a_shape_has(legs, tail):
    shape, parts = beast(legs, tail)
    variants = Variants.of(Statement(labels=("body", "leg{2..4}", "tail{0..1}"), minimize=LIKE))
    typical = {}
    for task, text in zip(variants.tasks, variants.texts, strict=True):
        problem = task.problem
        labels = labelled(problem, shape, parts)
        evaluation = problem.evaluate(shape, labels)
        assert not evaluation.empty
        areas = np.bincount(labels, shape.areas)
        typical[text] = typical_cost(problem, evaluation, areas)
    right = f"body, leg{{{legs}}}" + (", tail" if tail else "")
    assert min(typical, key=lambda text: typical[text]) == right


def test_the_rule_does_not_favour_fewer_parts_as_the_total_does():
    """Four legs, each half a unit off; to leave one to the body costs less than half in all."""
    shape = Shape.from_mesh(*strip(10))
    stated = Statement(
        labels=("body", "leg{2..4}"),
        minimize="10*area_fraction(leg*, max=0.05) + 4*area_fraction(body, max=0.6)",
    )
    rules, totals = [], []
    for task in Variants.of(stated).tasks:
        legs = len(task.problem.labels) - 1
        labels = np.array([0] * (10 - legs) + [k + 1 for k in range(legs)])
        evaluation = task.problem.evaluate(shape, labels)
        rules.append(typical_cost(task.problem, evaluation, np.bincount(labels, shape.areas)))
        totals.append(evaluation.cost.value)
    assert rules == sorted(rules, reverse=True)  # all four legs are best
    assert totals == sorted(totals)  # the total would have had two
    assert totals == pytest.approx([1.8, 1.9, 2.0])


def test_parts_that_are_alike_cost_the_same_however_many_there_are():
    costs = []
    for n in (2, 3, 5):
        problem = Problem([f"a{k}" for k in range(n)], "2*narrow(a*) + area_fraction(a*, max=0.1)")
        shape = Shape.from_mesh(*strip(2 * n))
        evaluation = problem.evaluate(shape, np.repeat(np.arange(n), 2))
        only = problem.evaluate(shape, np.repeat(np.arange(n), 2)).terms[0].calls[0].value
        share = evaluation.terms[1].calls[0].value
        costs.append(typical_cost(problem, evaluation, np.full(n, 2.0)) - 2 * only - share)
    assert costs == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_the_rule_against_a_plain_sum():
    shape = Shape.from_mesh(*strip(9))
    problem = Problem(
        ["a", "b", "c", "d"],
        "2*narrow(a) - flat(a) + 3*area_fraction(a, b, max=0.01) + 5*touching(a, b)"
        " + perpendicular(a, b) + narrow(d)",
    )
    evaluation = problem.evaluate(shape, [0, 0, 0, 0, 1, 1, 2, 2, 2])  # d is empty
    areas = np.array([4.0, 2.0, 3.0, 0.0])
    value = {
        (term.objective, call.labels): call.value
        for term in evaluation.terms
        for call in term.calls
    }
    of_a = (
        2 * value["basic:narrow", ("a",)]
        - value["basic:flat", ("a",)]
        + 3 * value["basic:area_fraction", ("a",)]
    )
    of_b = 3 * value["basic:area_fraction", ("b",)]
    expected = (of_a * math.sqrt(4.0) + of_b * math.sqrt(2.0)) / (math.sqrt(4.0) + math.sqrt(2.0))
    assert typical_cost(problem, evaluation, areas) == pytest.approx(expected, rel=1e-12)


def test_without_unary_terms_nothing_can_be_compared():
    stated = Statement(labels=("a", "b{1..2}"), minimize="convex_parts")
    with pytest.raises(UsageError, match="says nothing of single parts, by which label sets"):
        check_variants(Variants.of(stated), SearchOptions())
    shape = Shape.from_mesh(*strip(4))
    problem = Problem(["a", "b"], "touching(a, b)")
    evaluation = problem.evaluate(shape, [0, 0, 1, 1])
    assert typical_cost(problem, evaluation, np.array([2.0, 2.0])) == 0.0


# --- searches


def row(count: int) -> Shape:
    """So many boxes of 3 by 3 by 3 cubes in a row, joined by bars of one cube."""
    cells = []
    for k in range(count):
        cells += [(4 * k + x, y, z) for x, y, z in product(range(3), (-1, 0, 1), (-1, 0, 1))]
        cells += [(4 * k + 3, 0, 0)] if k < count - 1 else []
    return Shape.from_mesh(*solid(cells), name="row")


BOXES = Statement(labels=("box{2..4}",), minimize="compact(box*) + 3*convex(box*)")


@pytest.mark.parametrize("count", [2, 3, 4])
def test_boxes_are_counted(count):
    reports = []
    result = segment_variants(row(count), BOXES, seeder="kmeans", report=reports.append)
    assert list(result.parts) == [f"box{k + 1}" for k in range(count)]
    tried = tried_sets(result.history)
    assert list(tried) == ["box{2}", "box{3}", "box{4}"]
    assert [record["parts"] for record in tried.values()] == [2, 3, 4]
    own = tried[f"box{{{count}}}"]
    assert (own["cost"], own["empty"]) == (result.cost, 0)
    assert (0, own["typical cost"]) == score(result)
    assert own["typical cost"] == min(record["typical cost"] for record in tried.values())
    assert {progress.stage.partition(": ")[0] for progress in reports} == set(tried)


def test_the_result_is_one_like_any_other(tmp_path):
    found = segment_variants(row(3), BOXES, **QUICK)
    alone = solve_hierarchy(
        row(3),
        Variants.of(BOXES, [found.problem.labels]).tasks[0],
        SearchOptions.of({**QUICK}),
    )
    assert found.labels.tolist() == alone.labels.tolist()
    assert found.cost == alone.cost
    save(found, tmp_path / "row.json")
    saved = read_result(tmp_path / "row.json")
    assert saved.statement == found.problem.statement
    assert tried_sets(saved.history) == tried_sets(found.history)


@pytest.mark.parametrize("more", [{}, {"resolution": 40}])
def test_processes_make_no_difference(more):
    one, two = (
        segment_variants(row(3), BOXES, workers=workers, **QUICK, **more) for workers in (1, 2)
    )
    assert one.labels.tolist() == two.labels.tolist()
    assert one.history == two.history
    assert (one.method, one.warnings) == (two.method, two.warnings)


@pytest.mark.parametrize("resolution", [40, "full"])
def test_of_many_the_better_half_goes_on(resolution):
    many = replace(BOXES, labels=("box{1..6}",))
    found = segment_variants(row(3), many, seeder="kmeans", resolution=resolution)
    assert len(found.parts) == 3
    tried = tried_sets(found.history)
    assert len(tried) == 6
    assert sum(record["finalist"] for record in tried.values()) == 3
    assert tried["box{3}"]["finalist"] == 1
    worst = max(r["typical cost"] for r in tried.values() if r["finalist"])
    assert all(r["typical cost"] >= worst for r in tried.values() if not r["finalist"])
    # As published there is nothing brief.
    few = {"optimizer": "pattern_search(max_evaluations=5)", "settings": "paper"}
    found = segment_variants(row(2), many, **few)
    assert not any("finalist" in record for record in tried_sets(found.history).values())


def test_the_coarse_shape_is_made_once(monkeypatch):
    made = []

    def counted(shape, *arguments, **more):
        made.append(shape)
        return coarsen(shape, *arguments, **more)

    coarsen = restarts.coarsen
    monkeypatch.setattr(restarts, "coarsen", counted)
    segment_variants(row(3), BOXES, resolution=40, **QUICK)
    assert len(made) == 1


def test_starts_are_shared_unless_somebody_says_how_many(monkeypatch):
    asked = spied(monkeypatch)
    segment_variants(row(2), BOXES)
    assert [defaults.restarts for _, _, defaults in asked] == [2, 2, 2]
    asked.clear()
    segment_variants(row(2), replace(BOXES, search=Method(restarts=5)))
    segment_variants(row(2), BOXES, restarts=4)
    assert [(o.restarts, d.restarts) for _, o, d in asked] == [(None, 5)] * 3 + [(4, None)] * 3


def test_the_seconds_are_shared(monkeypatch):
    asked = spied(monkeypatch)
    segment_variants(row(2), BOXES, max_seconds=60.0)
    seconds = [options.max_seconds for _, options, _ in asked]
    assert 19.0 < seconds[0] <= 20.0
    assert seconds[1] <= 30.0
    assert seconds[2] <= 60.0
    assert seconds == sorted(seconds)


def test_what_is_known_of_a_shape_leaves_out_label_sets(monkeypatch):
    asked = spied(monkeypatch)
    segment_variants(row(2), BOXES, pins={"box3": [0]})
    assert [labels[-1] for labels, _, _ in asked] == ["box3", "box4"]
    asked.clear()
    segment_variants(row(2), BOXES, freeze=["box2"])
    assert len(asked) == 3
    found = segment_variants(row(2), BOXES, **QUICK)
    again = segment_variants(row(2), BOXES, start=found, **QUICK)
    assert again.problem.labels == found.problem.labels
    assert not tried_sets(again.history)
    with pytest.raises(UsageError, match="freeze and pins: unknown label 'box5'"):
        segment_variants(row(2), BOXES, freeze=["box5"])


def test_parameters_about_a_label_go_to_the_label_sets_that_have_it(monkeypatch):
    asked = spied(monkeypatch)
    segment_variants(row(2), BOXES, parameterization='voronoi(centers="box1=2,box4=2")')
    centers = [options.parameterization.parameters["centers"] for _, options, _ in asked]
    assert centers == ["box1=2", "box1=2", "box1=2,box4=2"]


def test_more_labels_than_elements_are_not_tried():
    stated = Statement(labels=("a{1..9}",), minimize="narrow(a*)")
    found = segment_variants(Shape.from_mesh(*strip(3)), stated, **QUICK)
    assert [record["parts"] for record in tried_sets(found.history).values()] == [1, 2, 3]


def test_the_parts_of_the_winner_are_divided():
    inner = Statement(labels=("a", "b"), minimize="compact(a)")
    recipe = Recipe(name="boxes", statement=replace(BOXES, parts=(("box1", inner),)))
    found = segment_variants(row(3), recipe, max_seconds=100.0, **QUICK)
    assert list(found.parts) == ["box1/a", "box1/b", "box2", "box3"]
    assert list(tried_sets(found.history)) == ["box{2}", "box{3}", "box{4}"]
    assert any(stage.startswith("box1: ") for stage in found.history)


def test_no_counts_are_no_matter():
    plain = Statement(labels=("a", "b"), minimize="compact(a)")
    found = segment_variants(row(2), plain, **QUICK)
    assert list(found.parts) == ["a", "b"]
    assert not tried_sets(found.history)
    with pytest.raises(UsageError, match="takes a Recipe or a Statement, not Problem"):
        segment_variants(row(2), Problem(["a"], "narrow(a)"))


# --- ends


def spied(monkeypatch):
    """What each search is asked for: labels, options and defaults; with few evaluations."""
    asked = []

    def solve(shape, problem, options, *, defaults, **more):
        asked.append((problem.labels, options, defaults))
        quick = replace(options, optimizer="pattern_search(max_evaluations=9)", restarts=1)
        return real(shape, problem, quick, defaults=Method(), **more)

    real = module.solve
    monkeypatch.setattr(module, "solve", solve)
    return asked


def test_whoever_stops_has_the_best_by_then():
    found = segment_variants(
        row(3), BOXES, report=lambda progress: progress.stage.startswith("box{3}"), **QUICK
    )
    assert found.reason == "interrupted"
    assert found.warnings[0] == "the run was interrupted; this is the best that it had found"
    assert list(tried_sets(found.history)) == ["box{2}", "box{3}"]


@pytest.mark.parametrize("with_result", [True, False])
def test_a_search_that_fails_keeps_those_before_it(monkeypatch, with_result):
    def solve(shape, problem, options, **more):
        found = real(shape, problem, options, **more)
        if len(problem.labels) == 3:
            error = PluginError("broken")
            error.result = found if with_result else None
            raise error
        return found

    real = module.solve
    monkeypatch.setattr(module, "solve", solve)
    with pytest.raises(PluginError, match="broken") as caught:
        segment_variants(row(3), BOXES, **QUICK)
    found = caught.value.result
    assert found.reason == "failed"
    assert len(tried_sets(found.history)) == (2 if with_result else 1)


def test_a_search_that_fails_at_once_has_nothing(monkeypatch):
    def solve(shape, problem, options, **more):
        raise PluginError("broken")

    monkeypatch.setattr(module, "solve", solve)
    with pytest.raises(PluginError, match="broken") as caught:
        segment_variants(row(3), BOXES, **QUICK)
    assert caught.value.result is None


def test_names_looked_up_beforehand_come_to_the_same():
    direct = segment_variants(row(2), BOXES, **QUICK)
    seen: list[Progress] = []
    found = solve_variants(
        row(2), Variants.of(BOXES), SearchOptions.of({**QUICK}), report=seen.append
    )
    assert found.labels.tolist() == direct.labels.tolist()
    assert seen
