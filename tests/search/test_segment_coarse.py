"""Runs on a coarse shape: exact in the end, polished, interruptible, and equal to the paper's."""

from __future__ import annotations

import math

import numpy as np
import pytest

from moseg_core.components.chosen import Choice
from moseg_core.components.cost import Cost
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method
from moseg_core.search import restarts
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(60, 24), 2, 0.005), name="capsule")
SEEN: list[int] = []


@objective(range=(0, 1))
def slim(part: Part) -> float:
    SEEN.append(len(part.shape.areas))
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@objective(range=(0, math.inf))
def border(segmentation: Segmentation) -> float:
    """Number of neighbouring input elements in different parts."""
    graph = segmentation.shape.adjacency
    rows = np.repeat(np.arange(graph.n_elements), np.diff(graph.indptr))
    return float((segmentation.labels[rows] != segmentation.labels[graph.indices]).sum())


PROBLEM = Problem(
    ["one", "other"],
    "slim(one) + slim(other) + 0.001*border",
    objectives={"slim": slim, "border": border},
)
QUICK = "pattern_search(threshold=0.01)"


def run(**options):
    return segment(SHAPE, PROBLEM, **{"optimizer": QUICK, "resolution": 200, **options})


@pytest.fixture(scope="module")
def result():
    return run(seeder="evolution(population=8, iterations=3)")


def test_the_cost_is_that_of_input_elements(result):
    assert result.shape is SHAPE
    assert result.labels.shape == (SHAPE.n_elements,)
    fresh = PROBLEM.evaluate(SHAPE, result.labels)
    assert result.evaluation.cost == fresh.cost
    assert result.evaluation.terms == fresh.terms
    last = result.history["polish"][-1]
    assert Cost(last["empty"], last["value"]) == fresh.cost
    assert result.reason == "converged"
    assert result.warnings == ()


def test_objectives_see_the_users_shape_only(result):
    assert set(SEEN) == {SHAPE.n_elements}


def test_polishing_does_not_make_it_worse(result):
    values = [record["value"] for record in result.history["polish"]]
    assert values == sorted(values, reverse=True)
    records = result.history["restarts"]
    assert len(records) == 8
    assert sum(record["finalist"] for record in records) >= 2


def test_a_large_shape_is_polished_on_a_level_between(monkeypatch):
    options = {"seeder": "evolution(population=8, iterations=3)", "restarts": 1}
    exact = run(**options)
    monkeypatch.setattr(restarts, "FINER", 3)
    SEEN.clear()
    found = run(**options)
    fresh = PROBLEM.evaluate(SHAPE, found.labels)
    assert found.evaluation.cost == fresh.cost
    # What the polish saw are 600 super-elements, where borders are counted otherwise.
    polish = found.history["polish"]
    assert polish[-1]["value"] < polish[0]["value"]
    assert polish[-1]["value"] != fresh.cost.value
    # The choice is by what input elements cost: polished or not.
    assert found.cost < 1.1 * exact.cost


def test_a_polish_that_costs_more_on_input_elements_is_not_taken(monkeypatch):
    monkeypatch.setattr(restarts, "FINER", 3)
    rough = run(restarts=1, max_seconds=1e-9)  # nothing is polished
    found = run(restarts=1, start=rough)
    assert found.cost <= rough.cost


def test_the_result_says_how_it_was_made_and_that_can_be_given_again(result):
    assert result.method["resolution"] == "200"
    assert result.method["restarts"] == "8"
    assert result.method["settings"] == "default"
    again = segment(SHAPE, PROBLEM, **result.method)
    assert again.labels.tobytes() == result.labels.tobytes()
    assert again.method == result.method
    assert again.history == result.history


def test_a_small_shape_is_searched_as_it_is():
    found = run(resolution=1000)  # 1440 elements are less than 1.5 times as many
    assert "polish" not in found.history
    full = run(resolution="full")
    assert (found.labels == full.labels).all()
    assert found.history == full.history


def test_a_run_without_random_numbers_is_not_repeated():
    spread = [40, 900]
    centers = Centers(positions=SHAPE.points[spread], weights=np.ones(2))
    assert "restarts" not in run(start=centers).history
    assert len(run(start=centers, restarts=2).history["restarts"]) == 2


def test_starts_of_k_means_differ():
    costs = {record["value"] for record in run(restarts=4).history["restarts"]}
    assert len(costs) > 2


def test_settings_of_the_paper():
    defaults = Method(
        seeder=Choice("kmeans", {"rounds": 3}), optimizer=Choice("pattern_search"), restarts=5
    )
    found = segment(
        SHAPE,
        PROBLEM,
        defaults=defaults,
        settings="paper",
        optimizer="pattern_search(threshold=0.01)",
    )
    assert found.method == {
        "parameterization": "core:voronoi",
        "seeder": "core:kmeans",
        "labeler": "core:hungarian",
        "optimizer": "core:pattern_search(threshold=0.01)",
        "settings": "paper",
        "resolution": "full",
        "restarts": "1",
        "finalists": "1",
        "polished": "2",
    }
    assert set(found.history) == {"seeding", "search"}


def test_default_settings_shorten_the_evolution_unless_it_is_described():
    plain = {"optimizer": "pattern_search(max_evaluations=1)", "resolution": 60}
    short = run(seeder="evolution", **plain)
    assert short.method["seeder"] == "core:evolution(population=20, iterations=6)"
    assert short.method["restarts"] == "1"
    own = run(seeder="evolution(population=3, iterations=2)", **plain)
    assert own.method["seeder"] == "core:evolution(population=3, iterations=2)"


@pytest.mark.parametrize("stage", ["k-means", "evolution", "pattern_search", "polish"])
def test_a_report_can_end_every_stage(stage):
    stages = []

    def report(progress):
        stages.append(progress.stage)
        return progress.stage == stage

    found = run(
        seeder="kmeans" if stage == "k-means" else "evolution(population=4, iterations=3)",
        report=report,
        restarts=3,
    )
    assert found.reason == "interrupted"
    assert stages.count(stage) == 1
    assert ("polish" in stages) == (stage == "polish")
    assert found.evaluation.cost == PROBLEM.evaluate(SHAPE, found.labels).cost
    assert any("interrupted" in warning for warning in found.warnings)


def test_no_time_left_means_no_polish():
    found = run(max_seconds=0.0)
    assert found.reason == "seconds"
    assert "polish" not in found.history
    assert found.evaluation.cost == PROBLEM.evaluate(SHAPE, found.labels).cost


def test_pins_hold_for_input_elements():
    free = run()
    moved = np.flatnonzero(free.labels == 0)[:40:8]
    found = run(pins={"other": moved, "one": [int(np.flatnonzero(free.labels == 1)[-1])]})
    assert found.evaluation.broken_pins == int((found.labels[moved] != 1).sum()) + int(
        found.labels[np.flatnonzero(free.labels == 1)[-1]] != 0
    )
    assert found.evaluation.broken_pins == 0


def test_frozen_labels_and_starts_hold_on_both_levels():
    start = Centers(positions=SHAPE.points[[100, 1200]], weights=np.array([1.0, 1.5]))
    found = run(start=start, freeze=["other"])
    np.testing.assert_allclose(found.centers.positions[1], start.positions[1], rtol=1e-12)
    assert found.centers.weights[1] == 1.5
    assert not np.allclose(found.centers.positions[0], start.positions[0])
    still = run(start=start, freeze=["one", "other"])
    np.testing.assert_allclose(still.centers.positions, start.positions, rtol=1e-12)
    onward = run(start=found)
    assert onward.cost <= found.cost + 0.05


def test_centres_given_by_hand_may_make_parts_smaller_than_a_super_element():
    near = SHAPE.points[700]
    beside = SHAPE.points[SHAPE.adjacency.neighbors(700)[0]]
    words = ",".join(
        f"{name}={x},{y},{z}" for name, (x, y, z) in (("one", near), ("other", beside))
    )
    found = run(seeder=Choice("given", {"centers": words}), resolution=20)
    assert found.evaluation.empty == ()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": 0}, "resolution must be 'full' or a number"),
        ({"resolution": "fine"}, "resolution must be 'full' or a number"),
        ({"resolution": 1}, "a resolution of 1 is too low for the 2 labels"),
        ({"restarts": 0}, "at least one start, not 0"),
        ({"finalists": 0}, "at least one finalist, not 0"),
        ({"finalists": "two"}, "number of finalists must be a whole number, not 'two'"),
        ({"workers": 0}, "at least one worker, not 0"),
        ({"workers": "2"}, "number of workers must be a whole number, not '2'"),
        ({"restarts": "two"}, "number of starts must be a whole number, not 'two'"),
        ({"settings": "papers"}, "unknown settings 'papers'; did you mean 'paper'?"),
    ],
)
def test_malformed_requests_are_refused(options, message):
    with pytest.raises(UsageError, match=message):
        run(**options)


def everything(result):
    return (
        result.labels.tobytes(),
        result.evaluation.cost,
        result.history,
        result.method,
        result.centers.positions.tobytes(),
        result.warnings,
    )


@pytest.mark.parametrize("resolution", [200, "full"])
def test_the_number_of_processes_makes_no_difference(resolution):
    options = {
        "seeder": "evolution(population=4, iterations=2)",
        "optimizer": "pattern_search",
        "resolution": resolution,
        "restarts": 5,
    }
    assert everything(run(workers=2, **options)) == everything(run(**options))


def test_a_run_without_random_numbers_is_alone_with_several_processes_too():
    assert everything(run(workers=3)) == everything(run())


@pytest.mark.parametrize("stage", ["evolution", "pattern_search", "polish"])
def test_a_report_can_end_every_stage_in_processes(stage):
    found = run(
        seeder="evolution(population=4, iterations=3)",
        report=lambda progress: progress.stage == stage,
        restarts=3,
        workers=2,
    )
    assert found.reason == "interrupted"
    assert found.evaluation.cost == PROBLEM.evaluate(SHAPE, found.labels).cost


def test_the_better_half_goes_on():
    options = {
        "seeder": "evolution(population=2, iterations=1)",
        "optimizer": "pattern_search(threshold=0.0001)",
        "restarts": 8,
    }
    race = run(finalists=2, **options)
    records = race.history["restarts"]
    assert [record["finalist"] for record in records].count(1) < 8
    every = run(finalists=8, **options)
    assert all(record["finalist"] for record in every.history["restarts"])
    # Each start is the same as when all go on to the end; the others only stopped earlier.
    for cut, whole in zip(records, every.history["restarts"], strict=True):
        if cut["finalist"]:
            assert cut == whole
        else:
            assert cut["value"] >= whole["value"]
    assert every.evaluation.cost <= race.evaluation.cost


def test_several_centres_are_carried_from_super_elements_to_elements():
    found = run(parameterization='voronoi(centers="o*=2")', seeder="kmeans", restarts=1)
    assert found.centers.parts.tolist() == [0, 0, 1, 1]
    assert found.evaluation.cost == PROBLEM.evaluate(SHAPE, found.labels).cost
    assert found.history["polish"]
    assert [part.n_components for part in found.segmentation.parts] == [1, 1]
    single = run(seeder="kmeans", restarts=1)
    assert found.history["search"][0]["value"] == single.history["search"][0]["value"]
