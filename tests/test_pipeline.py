"""The whole method in one call: what comes out, what is told on the way, what is refused."""

from __future__ import annotations

import math
import sys
import types

import numpy as np
import pytest

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.cost import Cost
from moseg_core.errors import PluginError, ShapeError, UsageError
from moseg_core.method import Choice, Method
from moseg_core.objectives import objective
from moseg_core.part import Part
from moseg_core.pipeline import segment
from moseg_core.plugins import Bundle, Component, Registry, registry
from moseg_core.problem import Problem
from moseg_core.protocols import Batch, Seeding
from moseg_core.segmentation import Segmentation
from moseg_core.shape import Shape
from moseg_core.specs import LabelerSpec, OptimizerSpec, SeederSpec
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
        "seeder": "core:kmeans",
        "labeler": "core:hungarian",
        "optimizer": "core:pattern_search(threshold=0.01)",
        "settings": "default",
        "resolution": "2000",
        "restarts": "3",
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


def test_a_method_and_single_components_may_be_given():
    method = Method(
        seeder=Choice("kmeans", {"rounds": 1}),
        optimizer=Choice("pattern_search", {"max_evaluations": 3}),
    )
    one = segment(SHAPE, problem_of(), method=method)
    assert one.method["seeder"] == "core:kmeans(rounds=1)"
    assert one.history["search"][-1]["evaluations"] == 3
    two = segment(SHAPE, problem_of(), method=method, seeder="core:kmeans")
    assert two.history["search"][-1]["evaluations"] == 3
    assert two.method["seeder"] == "core:kmeans"


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
    found = run(report=lambda progress: seen.append(progress))
    stages = [progress.stage for progress in seen]
    rounds, iterations = len(found.history["seeding"]), len(found.history["search"])
    assert stages == ["k-means"] * rounds + ["pattern_search"] * iterations
    search = seen[rounds:]
    assert [p.done for p in search] == [r["evaluations"] for r in found.history["search"]]
    assert [p.best.value for p in search] == [r["value"] for r in found.history["search"]]
    assert all(0.0 <= p.fraction <= 1.0 for p in search)
    assert search[-1].fraction == 1.0


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


# --- foreign components --------------------------------------------------------------------------


class Foreign:
    """A bundle in a module of its own, whose components the test fills in."""

    def __init__(self, monkeypatch):
        self.module = types.ModuleType("foreign_bundle")
        monkeypatch.setitem(sys.modules, "foreign_bundle", self.module)
        specs = [
            kind(name=name, target=f"foreign_bundle:{name}")
            for name, kind in (
                ("seed", SeederSpec),
                ("label", LabelerSpec),
                ("walk", OptimizerSpec),
            )
        ]
        self.registry = Registry(
            [
                *registry().bundles,
                Bundle(
                    "foreign",
                    "moseg-foreign",
                    "2.0",
                    "foreign_bundle",
                    tuple(Component("foreign", "moseg-foreign 2.0", spec) for spec in specs),
                ),
            ]
        )

    def run(self, text="slim(stem) + uneven", **options):
        return run(problem_of(text, registry=self.registry), **options)


@pytest.fixture
def foreign(monkeypatch):
    return Foreign(monkeypatch)


def seeder(centers):
    class Made:
        def __call__(self, evaluator, *, rng, report):
            return centers(evaluator) if callable(centers) else centers

    return Made


def labeler(order):
    class Made:
        def __call__(self, evaluator, vector):
            return order(evaluator) if callable(order) else order

    return Made


def fail(evaluator):
    raise ValueError("no idea")


def at(*numbers):
    return lambda evaluator: Seeding(centers=evaluator.shape.points[list(numbers)])


def test_foreign_components_take_part(foreign):
    class Walk(PatternSearch):
        pass

    foreign.module.seed, foreign.module.label = seeder(at(3, 40)), labeler(np.array([1, 0]))
    foreign.module.walk = Walk
    found = foreign.run(seeder="foreign:seed", labeler="label", optimizer="walk(max_evaluations=1)")
    assert found.centers.positions == pytest.approx(SHAPE.points[[40, 3]], rel=1e-12)
    assert found.method["optimizer"] == "foreign:walk(max_evaluations=1)"
    assert found.versions["foreign:seed"] == "moseg-foreign 2.0"


def test_a_warning_of_the_seeder_comes_first(foreign):
    def warn(evaluator):
        return Seeding(centers=evaluator.shape.points[[3, 40]], warning="guessed")

    foreign.module.seed = seeder(warn)
    found = foreign.run("worst(stem)", seeder="seed")
    assert found.warnings == ("guessed", "python:worst is at its worst value, 1 for stem")


def test_empty_parts_are_warned_of_and_left_out(foreign):
    foreign.module.seed = seeder(at(3, 3))
    found = foreign.run(
        "area(stem, bar)", seeder="seed", optimizer="pattern_search(max_evaluations=1)"
    )
    assert found.evaluation.cost == Cost(1, pytest.approx(SHAPE.area))
    assert any("is empty" in warning for warning in found.warnings)
    # The search moves away from it all by itself.
    later = foreign.run("area(stem, bar)", seeder="seed")
    assert later.evaluation.cost.empty == 0


@pytest.mark.parametrize(
    "garbage",
    [
        None,
        "centres",
        fail,
        Seeding(centers=np.zeros((3, 3))),
        Seeding(centers=np.zeros((2, 2))),
        Seeding(centers=np.full((2, 3), np.nan)),
        Seeding(centers=np.array([[0.0, 0, 0], [0, 0, np.inf]])),
        Seeding(centers=None),
        Seeding(centers=[["a", "b", "c"]] * 2),
        Seeding(centers=np.full((2, 3), None)),
        Seeding(centers=[[0.0, 0.0, 0.0], [0.0]]),
    ],
    ids=[
        *["None", "text", "raises", "3 centres", "2 coordinates", "nan", "inf", "no centres"],
        *["words", "objects", "ragged"],
    ],
)
def test_a_seeder_that_returns_garbage_is_named(foreign, garbage):
    foreign.module.seed = seeder(garbage)
    with pytest.raises(PluginError, match=r"seeder 'foreign:seed' of moseg-foreign 2\.0"):
        foreign.run(seeder="seed")


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
def test_a_labeler_that_returns_garbage_is_named(foreign, garbage):
    foreign.module.label = labeler(garbage)
    with pytest.raises(PluginError, match=r"labeler 'foreign:label' of moseg-foreign 2\.0"):
        foreign.run(labeler="label")


class Broken(PatternSearch):
    """A search that breaks its word in the way that the test says, after the start."""

    how = ""

    def ask(self):
        batch = super().ask()
        if not self.history:
            return batch
        return {
            "raises": lambda: fail(None),
            "nothing": lambda: None,
            "narrow": lambda: Batch(vectors=batch.vectors[:, :5]),
            "flat": lambda: Batch(vectors=batch.vectors[0]),
        }[self.how]()


@pytest.mark.parametrize("how", ["raises", "nothing", "narrow", "flat"])
def test_an_optimizer_that_breaks_its_word_is_named(foreign, how):
    foreign.module.walk = type("Walk", (Broken,), {"how": how})
    with pytest.raises(PluginError, match=r"optimizer 'foreign:walk' of moseg-foreign 2\.0"):
        foreign.run(optimizer="walk")


@pytest.mark.parametrize("kind", ["seeder", "labeler", "optimizer"])
def test_a_component_that_cannot_be_made_is_named(foreign, kind):
    class Made:
        def __init__(self, *arguments, **more):
            raise RuntimeError("out of ideas")

    name = {"seeder": "seed", "labeler": "label", "optimizer": "walk"}[kind]
    setattr(foreign.module, name, Made)
    with pytest.raises(PluginError, match=f"{kind} 'foreign:{name}' .* RuntimeError: out of ideas"):
        foreign.run(**{kind: name})


def test_what_a_component_says_of_the_user_is_passed_on(foreign):
    def refuse(evaluator):
        raise UsageError("one centre more, please")

    foreign.module.seed = seeder(refuse)
    with pytest.raises(UsageError, match="one centre more, please"):
        foreign.run(seeder="seed")


def test_an_objective_that_fails_inside_a_component_is_the_one_that_is_named(foreign):
    def broken(part: Part) -> float:
        raise ValueError("no idea")

    problem = Problem(["a", "b"], "broken(a)", objectives={"broken": broken})
    with pytest.raises(PluginError, match=r"objective 'python:broken' .* in 'broken\(a\)'"):
        run(problem)


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
