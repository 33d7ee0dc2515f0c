"""The whole method in one call: what comes out, what is told on the way, what is refused."""

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
from moseg_core.errors import ShapeError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import references, shapes

MESH = shapes.jitter(shapes.tee(), 5)
SHAPE = Shape.from_mesh(*MESH, name="tee")


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@objective(range=(0, math.inf))
def area(part: Part) -> float:
    return part.area


@objective(range=(0, 1), cost="expensive")
def uneven(segmentation: Segmentation) -> float:
    areas = [part.area for part in segmentation.parts]
    return (max(areas) - min(areas)) / sum(areas)


@objective(range=(0, 1))
def worst(part: Part) -> float:
    return 1.0


OBJECTIVES = {"slim": slim, "area": area, "uneven": uneven, "worst": worst}
QUICK = "pattern_search(threshold=0.01)"


def problem_of(text="slim(stem) + slim(bar) + uneven", names=("stem", "bar"), **more):
    return Problem(names, text, objectives=OBJECTIVES, **more)


def run(problem=None, **options):
    return segment(SHAPE, problem or problem_of(), **{"optimizer": QUICK, **options})


# --- what comes out ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def result():
    return run()


def test_the_labels_are_those_of_the_centres(result):
    neighbors = references.edge_neighbors(*MESH)
    expected = references.connected_partition(
        SHAPE.points.tolist(), neighbors, result.centers.positions, result.centers.weights
    )
    assert result.labels.tolist() == expected
    assert result.labels.dtype == np.int32
    assert (result.centers.weights > 0).all()


def test_the_cost_is_that_of_the_labels(result):
    fresh = result.problem.evaluate(SHAPE, result.labels)
    assert result.evaluation.cost == fresh.cost
    assert result.evaluation.terms == fresh.terms
    last = result.history["search"][-1]
    assert Cost(last["empty"], last["value"]) == fresh.cost


def test_the_search_ends_lower_than_it_starts_and_never_goes_up(result):
    values = [record["value"] for record in result.history["search"]]
    assert values == sorted(values, reverse=True)
    assert values[-1] < values[0]
    assert result.reason == "converged"
    assert result.history["seeding"][0]["round"] == 1


def test_the_result_says_how_it_was_made(result):
    assert result.shape is SHAPE
    assert result.seed == 0
    assert result.method == {
        "parameterization": "core:voronoi",
        "seeder": "core:kmeans(outliers=0.001)",
        "labeler": "core:hungarian",
        "optimizer": "core:pattern_search(threshold=0.01)",
        "settings": "default",
        "resolution": "2000",
        "restarts": "8",
        "finalists": "2",
        "polished": "2",
    }
    assert result.versions["python:slim"] == "the calling program"
    assert result.versions["core:kmeans"].startswith("moseg-core ")
    assert result.warnings == ()


def test_the_same_seed_gives_the_same_result(result):
    np.random.default_rng(9).random(100)
    again = run()
    assert again.labels.tobytes() == result.labels.tobytes()
    assert again.centers.positions.tobytes() == result.centers.positions.tobytes()
    assert again.centers.weights.tobytes() == result.centers.weights.tobytes()
    assert again.history == result.history
    assert again.evaluation == result.evaluation
    assert again.warnings == result.warnings
    assert run(seed=7).seed == 7


def test_labels_go_to_the_parts_that_suit_them():
    for names in (("stem", "bar"), ("bar", "stem")):
        found = run(
            problem_of("area(bar) + 5*slim(stem)", names),
            optimizer={"name": "pattern_search", "max_evaluations": 1},
        )
        assert found.parts["bar"].area < found.parts["stem"].area


def test_defaults_and_single_components_may_be_given():
    defaults = Method(
        seeder=Choice("kmeans", {"rounds": 1}),
        optimizer=Choice("pattern_search", {"max_evaluations": 3}),
    )
    one = segment(SHAPE, problem_of(), defaults=defaults)
    assert one.method["seeder"] == "core:kmeans(rounds=1)"
    assert one.history["search"][-1]["evaluations"] == 3
    two = segment(SHAPE, problem_of(), defaults=defaults, seeder="core:kmeans")
    assert two.history["search"][-1]["evaluations"] == 3
    assert two.method["seeder"] == "core:kmeans(outliers=0.001)"


def test_what_the_result_says_of_its_method_can_be_given_again():
    free = {"name": "voronoi", "connected": False}
    first = run(parameterization=free, seeder="kmeans(rounds=3)")
    again = segment(SHAPE, problem_of(), **first.method)
    assert again.method == first.method
    assert (again.labels == first.labels).all()


def test_plain_functions_can_be_objectives():
    def reach(part: Part, *, axis: int = 0) -> float:
        return float(np.ptp(part.points[:, axis]))

    problem = Problem(["a", "b"], "reach(a, axis=2) + reach(b)", objectives={"reach": reach})
    found = run(problem)
    expected = sum(np.ptp(SHAPE.points[found.labels == k, axis]) for k, axis in ((0, 2), (1, 0)))
    assert found.cost == pytest.approx(expected)


# --- limits, reports and warnings ----------------------------------------------------------------


@pytest.mark.parametrize("budget", [1, 2, 40])
def test_a_limit_on_evaluations_is_kept_and_said(budget):
    found = run(optimizer=f"pattern_search(max_evaluations={budget})")
    assert found.reason == "evaluations"
    assert found.history["search"][-1]["evaluations"] == budget
    assert "the search ended on its limit (evaluations)" in found.warnings[0]


def test_a_limit_on_seconds_is_looked_at_after_each_batch():
    found = run(max_seconds=0.0)
    assert found.reason == "seconds"
    assert len(found.history["search"]) == 1
    assert "(seconds)" in found.warnings[0]
    assert run(max_seconds=1e9).reason == "converged"


def test_progress_is_reported_stage_by_stage():
    seen = []
    found = run(report=lambda progress: seen.append(progress), restarts=1)
    stages = [progress.stage for progress in seen]
    rounds, iterations = len(found.history["seeding"]), len(found.history["search"])
    assert stages == ["k-means"] * rounds + ["pattern_search"] * iterations
    search = seen[rounds:]
    assert [p.done for p in search] == [r["evaluations"] for r in found.history["search"]]
    assert [p.best.value for p in search] == [r["value"] for r in found.history["search"]]
    assert all(0.0 <= p.fraction <= 1.0 for p in search)
    assert search[-1].fraction == 1.0


def test_progress_says_which_start_it_is():
    seen = []
    run(report=lambda progress: seen.append(progress), restarts=3, finalists=1)
    places = list(dict.fromkeys(progress.place for progress in seen))
    assert places[:3] == ["start 1 of 3", "start 2 of 3", "start 3 of 3"]
    run(report=lambda progress: seen.append(progress), restarts=1)
    assert seen[-1].place == ""


def test_a_report_can_end_the_search():
    seen = []

    def report(progress):
        seen.append(progress)
        return progress.stage == "pattern_search" and progress.done > 20

    found = run(report=report)
    assert found.reason == "interrupted"
    assert len(found.history["search"]) == 3
    assert found.cost == seen[-1].best.value
    assert any("interrupted" in warning for warning in found.warnings)


def test_terms_at_their_worst_are_warned_of():
    found = run(problem_of("slim(stem) + worst(bar)"))
    assert found.warnings == ("python:worst is at its worst value, 1 for bar",)


def test_parts_in_several_pieces_are_warned_of():
    shape = Shape.from_mesh(*shapes.two_boxes())
    found = segment(shape, Problem(["all"], "area(all)", objectives=OBJECTIVES), optimizer=QUICK)
    assert found.warnings == ("part 'all' is in 2 pieces",)


# --- starts, pins and frozen parts ---------------------------------------------------------------


def test_a_search_goes_on_from_given_centres(result):
    short = run(optimizer="pattern_search(max_evaluations=30)")
    first = run(start=short.centers, optimizer="pattern_search(max_evaluations=1)")
    assert first.history["seeding"] == ()
    assert (first.labels == short.labels).all()
    assert first.cost == short.cost
    more = run(start=short)
    assert more.history["search"][0]["value"] == short.cost
    assert more.cost <= short.cost


def test_the_centres_of_a_result_go_to_the_labels_of_the_same_name(result):
    turned = problem_of(names=("bar", "stem"))
    found = run(turned, start=result, optimizer="pattern_search(max_evaluations=1)")
    assert (found.labels == 1 - result.labels).all()
    assert found.cost == pytest.approx(result.cost)
    with pytest.raises(UsageError, match="labels stem, bar; the problem has a, b"):
        run(Problem(["a", "b"], "area(a)", objectives=OBJECTIVES), start=result)


@pytest.mark.parametrize(
    "start",
    [
        Centers(positions=np.zeros((3, 3)), weights=np.ones(3)),
        Centers(positions=np.zeros((2, 3)), weights=np.ones(3)),
        Centers(positions=np.eye(3)[:2], weights=np.array([1.0, 0.0])),
    ],
    ids=["3 centres", "3 weights", "weight 0"],
)
def test_a_start_that_cannot_be_used_is_the_fault_of_who_gave_it(start):
    with pytest.raises(UsageError, match="start"):
        run(start=start)


def test_a_frozen_centre_stays_where_it_starts(result):
    start = run(optimizer="pattern_search(max_evaluations=1)").centers
    found = run(freeze=["bar"])
    assert found.centers.positions[1] == pytest.approx(start.positions[1], rel=1e-12)
    assert found.centers.weights[1] == 1.0
    assert (found.centers.positions[0] != start.positions[0]).any()
    still = run(freeze=["bar", "stem"], start=result)
    assert (still.labels == result.labels).all()
    assert still.cost == result.cost
    assert still.reason == "converged"


def test_pinned_elements_bear_their_label(result):
    # Two elements that the free search gives to the stem.
    pinned = np.flatnonzero(result.labels == 0)[[0, -1]]
    found = run(pins={"bar": pinned[:1], "stem": pinned[1:]})
    assert found.labels[pinned].tolist() == [1, 0]
    assert found.evaluation.broken_pins == 0
    impossible = run(
        pins={"bar": [0, 1], "stem": [2]},
        optimizer="pattern_search(max_evaluations=1)",
        start=result,
    )
    broken = sum(int(result.labels[f] != k) for f, k in ((0, 1), (1, 1), (2, 0)))
    assert impossible.evaluation.broken_pins == broken > 0
    assert impossible.evaluation.cost.empty == broken
    assert any(f"{broken} pinned" in warning for warning in impossible.warnings)


# --- what is refused before the work begins ------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seeder": "kmean"}, "unknown seeder 'kmean'; did you mean 'kmeans'"),
        ({"labeler": "hungary"}, "unknown labeler 'hungary'"),
        ({"optimizer": "pattern_search(expand=2)"}, "unknown parameter 'expand'"),
        ({"optimizer": "pattern_search(expansion=0.5)"}, "expansion.* allowed is 1 or more"),
        ({"parameterization": {"connected": True}}, "a table with a name"),
        ({"seed": -1}, "seed must not be negative"),
        ({"restarts": 0}, "at least one start, not 0"),
        ({"freeze": ["stemm"]}, "unknown label 'stemm'; did you mean 'stem'"),
        ({"pins": {"stemm": [0]}}, "unknown label 'stemm'"),
        ({"pins": {"stem": [46]}}, "no element 46; elements are 0 to 45"),
        ({"pins": {"stem": [1], "bar": [1]}}, "element 1 is pinned to two labels"),
        ({"pins": {"stem": [0.5]}}, "must be integers"),
    ],
)
def test_malformed_requests_are_refused_at_once(options, message):
    reports = []
    with pytest.raises(UsageError, match=message):
        run(report=reports.append, **options)
    assert reports == []


def test_a_shape_that_does_not_fit_the_problem_is_refused_at_once():
    reports = []
    few = Shape.from_mesh(*shapes.rectangle(), name="few")
    with pytest.raises(ShapeError, match="'few' has 1 faces, too few for 2 labels"):
        segment(few, problem_of(), report=reports.append)
    assert reports == []
