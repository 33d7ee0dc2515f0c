"""Which labels a shape has: the rule that chooses, and the searches that share a budget."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest

from moseg_core.components.protocols import Progress
from moseg_core.errors import PluginError, UsageError
from moseg_core.io import read_result, save
from moseg_core.problem.problem import Problem
from moseg_core.problem.recipe import Recipe
from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search import label_set_trial as module
from moseg_core.search.levels import solve_hierarchy
from moseg_core.search.typical_cost import score
from moseg_core.search.variants import (
    check_variants,
    segment_variants,
    solve_variants,
    tried_sets,
)
from moseg_core.shape.shape import Shape
from tests.shapes import solid, strip

QUICK = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=60)", "restarts": 1}


def test_without_unary_terms_nothing_can_be_compared():
    stated = Statement(labels=("a", "b{1..2}"), minimize="convex_parts")
    with pytest.raises(UsageError, match="says nothing of single parts, by which label sets"):
        check_variants(Variants.of(stated), SearchOptions())


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
