"""Foreign seeders, labelers and optimizers: they take part, and are named where they break."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest

from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import LabelerSpec, OptimizerSpec, SeederSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Seeding
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


@objective(range=(0, 100))
def area(part: Part) -> float:
    return part.area


@objective(range=(0, 1))
def worst(part: Part) -> float:
    return 1.0


@objective(range=(0, 1))
def broken(part: Part) -> float:
    raise ValueError("no idea")


OBJECTIVES = {"slim": slim, "area": area, "worst": worst, "broken": broken}


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

    def run(self, text="2*slim(stem) + slim(bar)", **options):
        problem = Problem(["stem", "bar"], text, objectives=OBJECTIVES, registry=self.registry)
        return segment(SHAPE, problem, **{"optimizer": "pattern_search(threshold=0.01)", **options})


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


def at(*numbers):
    return lambda evaluator: Seeding(centers=evaluator.shape.points[list(numbers)])


def test_foreign_components_take_part(foreign):
    class Walk(PatternSearch):
        pass

    foreign.module.seed, foreign.module.label = seeder(at(3, 40)), labeler(np.array([1, 0]))
    foreign.module.walk = Walk
    found = foreign.run(
        seeder="foreign:seed",
        labeler="label",
        optimizer="walk(max_evaluations=1)",
        settings="paper",
    )
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
    def look(evaluator):
        evaluator.evaluate(np.ones(8))

    foreign.module.seed = seeder(look)
    with pytest.raises(PluginError, match=r"objective 'python:broken' .* in 'broken\(stem\)'"):
        foreign.run("broken(stem)", seeder="seed")


def test_the_best_of_several_starts_is_returned_and_all_are_recorded(foreign):
    class Random:
        def __call__(self, evaluator, *, rng, report):
            return at(*rng.integers(0, SHAPE.n_elements, 2))(evaluator)

    foreign.module.seed = Random
    options = {"seeder": "seed", "optimizer": "pattern_search(max_evaluations=60)"}
    found = foreign.run(restarts=4, **options)
    values = [record["value"] for record in found.history["restarts"]]
    assert len(values) == 4
    assert len(set(values)) > 1
    assert found.cost == min(values)
    assert found.history["search"][-1]["evaluations"] <= 60 / 4
    assert any("4 starts ended at costs from" in warning for warning in found.warnings)
    again = foreign.run(restarts=4, **options)
    assert again.labels.tobytes() == found.labels.tobytes()
    # The first start is that of a run without restarts.
    alone = foreign.run(seeder="seed", optimizer="pattern_search(max_evaluations=15)")
    assert alone.cost == values[0]
    assert "restarts" not in alone.history
