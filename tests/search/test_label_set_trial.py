"""Searches for all label sets in one budget."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest

from moseg_core.problem.settings import Method
from moseg_core.problem.statement import Statement
from moseg_core.search import label_set_trial as module
from moseg_core.search.variants import segment_variants, tried_sets
from moseg_core.shape import coarse
from moseg_core.shape.shape import Shape
from tests.shapes import solid

QUICK = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=60)", "restarts": 1}


def row(count: int) -> Shape:
    """So many boxes of 3 by 3 by 3 cubes in a row, joined by bars of one cube."""
    cells = []
    for k in range(count):
        cells += [(4 * k + x, y, z) for x, y, z in product(range(3), (-1, 0, 1), (-1, 0, 1))]
        cells += [(4 * k + 3, 0, 0)] if k < count - 1 else []
    return Shape.from_mesh(*solid(cells), name="row")


BOXES = Statement(labels=("box{2..4}",), minimize="compact(box*) + 3*convex(box*)")


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


EVOLVED = "sized_evolution(population=12, generations=6, relocations=0)"


@pytest.mark.parametrize("resolution", [40, "full"])
@pytest.mark.parametrize("workers", [1, 2])
def test_where_seeds_say_enough_the_search_goes_on_from_the_better_ones(resolution, workers):
    more = {"resolution": resolution, "restarts": 1, "seeder": EVOLVED}
    found = segment_variants(row(3), BOXES, workers=workers, **more)
    tried = tried_sets(found.history)
    assert {name: record["finalist"] for name, record in tried.items()} == {
        "box{2}": tried["box{2}"]["finalist"],
        "box{3}": 1,
        "box{4}": 1 - tried["box{2}"]["finalist"],
    }
    assert len(found.parts) == 3
    assert list(found.history)[:2] == ["seeding", "search"]
    assert found.incumbents[0].stage == "start"
    assert found.cost < found.incumbents[0].cost.value
    assert found.reason == "converged"
    assert found.method["seeder"].startswith("core:sized_evolution(")
    assert "max_evaluations" not in found.method["optimizer"]


@pytest.mark.parametrize(
    "more",
    [
        {"seeder": "kmeans", "restarts": 1},  # it knows nothing of costs
        {"seeder": EVOLVED, "restarts": 2},
        {"seeder": EVOLVED, "restarts": 1, "settings": "paper"},
    ],
)
def test_where_they_do_not_all_are_searched_for(more):
    found = segment_variants(row(3), BOXES, resolution=40, **more)
    tried = tried_sets(found.history).values()
    assert len(tried) == 3
    assert not any("finalist" in record for record in tried)


def test_the_coarse_shape_is_made_once(monkeypatch):
    made = []

    def counted(shape, members, resolution):
        made.append(resolution)
        return grouped(shape, members, resolution)

    grouped = coarse.grouped
    monkeypatch.setattr(coarse, "grouped", counted)
    segment_variants(row(3), BOXES, resolution=40, **QUICK)
    assert made == ["coarse40"]


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


@pytest.mark.parametrize(("labels", "here"), [("box{2..4}", [2]), ("box{2..3}", [])])
def test_what_is_left_over_for_one_process_has_all(monkeypatch, labels, here):
    asked = spied(monkeypatch)  # of other processes nothing is known here
    segment_variants(row(2), replace(BOXES, labels=(labels,)), workers=2)
    assert [options.workers for _, options, _ in asked] == here


def test_parameters_about_a_label_go_to_the_label_sets_that_have_it(monkeypatch):
    asked = spied(monkeypatch)
    segment_variants(row(2), BOXES, parameterization='voronoi(centers="box1=2,box4=2")')
    centers = [options.parameterization.parameters["centers"] for _, options, _ in asked]
    assert centers == ["box1=2", "box1=2", "box1=2,box4=2"]
