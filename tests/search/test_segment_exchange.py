"""Results of whole searches: no exchange of labels lowers their cost, whatever made them."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import RefinerSpec
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.clipped_result import clip
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.number_of_parts import segment_parts
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import LETTERS, RANGES, STRIP, lower_by_exchange, made

TEE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")
CAPSULE = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(60, 24), 2, 0.005), name="capsule")
FEW = "pattern_search(threshold=0.02)"


@objective(range=(0, 1))
def share(part: Part) -> float:
    return part.area / part.shape.area


def smallest_first(names, **more):
    """A problem whose labels want to be of rising size."""
    weights = " + ".join(f"{len(names) - k}*share({name})" for k, name in enumerate(names))
    return Problem(names, weights, objectives={"share": share}, **more)


@st.composite
def arbitrary_problems(draw):
    """A problem of 2 to 5 labels, of arbitrary terms."""
    names = LETTERS[: draw(st.integers(2, 5))]
    objectives, terms = {}, []
    for k in range(draw(st.integers(1, 4))):
        arity = draw(st.sampled_from(["unary", "nary", "global"]))
        objectives[f"f{k}"] = made(
            arity, draw(st.sampled_from(RANGES)), "cheap", levels=draw(st.sampled_from([3, 1000]))
        )
        few = draw(st.integers(2 if arity == "nary" else 1, len(names)))
        chosen = [] if arity == "global" else draw(st.permutations(names))[:few]
        terms.append(f"{draw(st.sampled_from(['- 3', '+ 1', '+ 0.1']))}*f{k}({', '.join(chosen)})")
    return Problem(names, "".join(terms), objectives=objectives)


@given(arbitrary_problems(), st.integers(0, 9), st.sampled_from([1, 3]))
@settings(max_examples=40, deadline=None)
def test_no_exchange_lowers_the_cost_of_a_result(problem, seed, restarts):
    found = segment(STRIP, problem, seed=seed, restarts=restarts, finalists=1, optimizer=FEW)
    assert lower_by_exchange(problem, STRIP, found.labels) == []
    assert found.evaluation.cost == problem.evaluate(STRIP, found.labels).cost


@pytest.mark.parametrize(
    "options",
    [
        {"optimizer": "pattern_search(max_evaluations=1)"},
        {"restarts": 1},
        {"seeder": "evolution(population=6, iterations=2)", "restarts": 4},
        {"resolution": 200},
        {"resolution": 200, "restarts": 1, "optimizer": "pattern_search(max_evaluations=9)"},
        {"max_seconds": 0.0},
    ],
)
def test_nor_that_of_one_on_super_elements_or_cut_short(options):
    problem = smallest_first(["a", "b", "c", "d"])
    found = segment(CAPSULE, problem, **{"optimizer": FEW, **options})
    assert lower_by_exchange(problem, CAPSULE, found.labels) == []
    areas = [part.area for part in found.parts.values()]
    assert areas == sorted(areas)


def partition_of(result, **parameters):
    """The labels that a result's centres give."""
    voronoi = registry().find("parameterization", "core:voronoi").load()
    partition = voronoi(result.shape, len(result.problem.labels), **parameters)
    return partition.labels(partition.encode(result.centers)[None])[0]


def test_where_the_user_said_which_centre_is_whose_labels_may_still_change_places():
    problem = smallest_first(["small", "large"])
    apart = Centers(positions=TEE.points[[3, 40]], weights=np.array([3.0, 1.0]))
    for start in (apart, apart.ordered(np.array([1, 0]))):
        found = segment(TEE, problem, start=start, optimizer="pattern_search(max_evaluations=1)")
        assert found.parts["small"].area <= found.parts["large"].area
        assert found.labels.tolist() == partition_of(found).tolist()
    frozen = segment(TEE, problem, start=apart, freeze=["small", "large"])
    assert frozen.centers.weights.tolist() == [3.0, 1.0]


class Turn:
    """Gives each part the label of the next one: whatever the labels were, they are wrong."""

    def __call__(self, evaluator, labels, *, report):
        return (labels + 1) % evaluator.parameterization.n_parts


@pytest.fixture
def with_turn(monkeypatch):
    """A registry in which there is a refiner 'turn'."""
    module = types.ModuleType("turn_bundle")
    module.Turn = Turn
    monkeypatch.setitem(sys.modules, "turn_bundle", module)
    component = Component(
        "made", "moseg-made 1.0", RefinerSpec(name="turn", target="turn_bundle:Turn")
    )
    bundle = Bundle("made", "moseg-made", "1.0", "turn_bundle", (component,))
    return Registry([*registry().bundles, bundle])


def test_after_a_refiner_centres_go_with_the_labels_that_are_put_right(with_turn):
    problem = smallest_first(["a", "b", "c"], registry=with_turn)
    plain = segment(TEE, problem, optimizer=FEW)
    found = segment(TEE, problem, optimizer=FEW, refiner="turn")
    assert found.refined
    assert found.cost == pytest.approx(plain.cost, rel=1e-12)
    assert found.labels.tolist() == plain.labels.tolist()
    # The refiner's parts are those of the plain result under other labels; so are the centres.
    turned = plain.centers.ordered(np.array([1, 2, 0]))
    assert found.centers.positions.tolist() == turned.positions.tolist()


def test_under_the_papers_settings_nothing_is_exchanged_and_a_warning_says_what_would_be():
    problem = smallest_first(["a", "b", "c"])
    centers = Centers(positions=TEE.points[[3, 20, 40]], weights=np.array([3.0, 2.0, 1.0]))
    options = {"start": centers, "optimizer": "pattern_search(max_evaluations=1)"}
    literal = segment(TEE, problem, settings="paper", **options)
    better = segment(TEE, problem, **options)
    assert better.cost < literal.cost
    assert literal.centers.weights.tolist() == [3.0, 2.0, 1.0]
    (said,) = [warning for warning in literal.warnings if "exchanging" in warning]
    assert said.endswith(
        f"would lower the cost from {literal.cost:.4g} to {better.cost:.4g}; --settings default"
        " does so"
    )


def test_parts_of_different_numbers_of_centres_change_labels_too():
    problem = smallest_first(["small", "large"])
    options = {"parameterization": 'voronoi(centers="small=2")', "restarts": 1}
    start = Centers(
        positions=TEE.points[[3, 4, 40]], weights=np.array([3.0, 3, 1]), parts=np.array([0, 0, 1])
    )
    found = segment(
        TEE, problem, start=start, optimizer="pattern_search(max_evaluations=1)", **options
    )
    assert lower_by_exchange(problem, TEE, found.labels) == []
    assert found.centers.per_part.tolist() == [2, 1]
    if (found.labels != partition_of(found, centers="small=2", labels=problem.labels)).any():
        with pytest.raises(UsageError, match="cannot be clipped"):
            clip(found)
    on = segment(TEE, problem, start=found, **options)
    assert on.cost <= start_cost(found, problem)


def start_cost(result, problem):
    """What the partition of a result's centres costs."""
    labels = partition_of(result, centers="small=2", labels=problem.labels)
    return problem.evaluate(result.shape, labels).cost.value


def test_every_level_and_every_number_of_parts():
    problem = smallest_first(["a", "b", "c"])
    found = segment_hierarchy(
        CAPSULE, Hierarchy(problem, {"c": smallest_first(["d", "e"])}), optimizer=FEW, restarts=2
    )
    for level in found.levels.values():
        assert lower_by_exchange(level.problem, level.shape, level.labels) == []
    parts = segment_parts(TEE, 3, optimizer=FEW, restarts=1)
    assert lower_by_exchange(parts.problem, TEE, parts.labels) == []
