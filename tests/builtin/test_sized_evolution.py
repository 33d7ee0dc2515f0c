"""The seeder that knows sizes: what it finds, and what its parameters take back."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from moseg_core.builtin.evolution import Evolution
from moseg_core.builtin.places import Places
from moseg_core.builtin.sized_evolution import SizedEvolution
from moseg_core.builtin.sizes import CLASSES
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Batch, Centers, Seeder, never_stop
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import on_strip
from tests.reflections import known

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
LABELS = ("stem", "bar", "rest")
TEXT = "2*narrow(stem) + compact(bar) - 0.5*flat(rest) + similar_proportions(stem, bar)"
SIZED = "area_fraction(stem, min=0.5, max=0.7) + area_fraction(bar, min=0.02, max=0.06) + " + TEXT
SMALL = {"population": 12, "generations": 5, "relocations": 4}
PARTS = (
    {},
    {"sizes": "evolved"},
    {"sizes": "equal"},
    {"places": 0},
    {"labelled": False},
    {"relocations": 0},
)


def evaluator_of(shape=SHAPE, text=TEXT, labels=LABELS, **more):
    return ProblemEvaluator(shape, Problem(labels, text, **more), Voronoi(shape, len(labels)))


def seeded(evaluator, *, seed=0, report=never_stop, **parameters):
    chosen = {**SMALL, **parameters}
    return SizedEvolution(**chosen)(evaluator, rng=np.random.default_rng(seed), report=report)


def cost_of(evaluator, found):
    at = Centers(positions=found.centers, weights=found.weights)
    return evaluator.evaluate(evaluator.parameterization.encode(at)).cost


@pytest.mark.parametrize("parameters", PARTS, ids=str)
@pytest.mark.parametrize("text", [TEXT, SIZED], ids=["no sizes", "sizes"])
def test_the_best_never_gets_worse_and_is_what_its_centres_and_weights_cost(parameters, text):
    evaluator = evaluator_of(text=text)
    found = seeded(evaluator, **parameters)
    values = [(record["empty"], record["best"]) for record in found.history]
    relocations = parameters.get("relocations", 4)
    assert len(values) == 1 + 5 + (1 + relocations if relocations else 0)
    assert values == sorted(values, reverse=True)
    assert cost_of(evaluator_of(text=text), found) == Cost(*values[-1])
    assert found.labelled
    assert found.history[-1]["evaluations"] == evaluator.evaluations


@pytest.mark.parametrize("parameters", PARTS, ids=str)
def test_the_same_seed_finds_the_same_with_or_without_promises(parameters):
    """Costs that need not be exact, since no such child survives, change nothing."""
    first = seeded(evaluator_of(), **parameters)
    exact = evaluator_of()
    costs = exact.costs
    exact.costs = lambda batch: costs(Batch(vectors=batch.vectors))
    second = seeded(exact, **parameters)
    assert first.centers.tobytes() == second.centers.tobytes()
    assert first.weights.tobytes() == second.weights.tobytes()
    assert first.history == second.history


def test_among_few_places_it_finds_the_best_there_is():
    """Against all ways to give three of six places, and a size, to three labels."""
    shape = Shape.from_mesh(*shapes.jitter(shapes.tee(3, 3), 2))
    evaluator = evaluator_of(shape)
    places = Places.spread(shape, 6)
    best = Cost(9, math.inf)
    for chosen in itertools.permutations(range(6), 3):
        for sizes in itertools.product(CLASSES, repeat=3):
            at = Centers(
                positions=shape.points[places.elements[list(chosen)]], weights=np.array(sizes)
            )
            vector = evaluator.parameterization.encode(at)
            best = min(best, evaluator.costs(Batch(vectors=vector[None]))[0])
    found = seeded(evaluator, population=60, generations=40, places=6, relocations=0)
    assert found.history[-1]["best"] == pytest.approx(best.value, rel=1e-9)


def test_known_sizes_give_the_weights():
    evaluator = evaluator_of(text=SIZED)
    expected = evaluator.problem.expected_shares
    assert np.isnan(expected[2])
    found = seeded(evaluator, relocations=0)
    assert found.weights[0] / found.weights[1] == pytest.approx(math.sqrt(0.6 / 0.04))
    equal = seeded(evaluator, relocations=0, sizes="equal")
    assert (equal.weights == 1.0).all()


@objective(range=(0, 100))
def central(part: Part) -> float:
    """How far a part is from the middle, in diagonals."""
    far = np.linalg.norm(part.centroid - part.shape.frame.center)
    return float(far / part.shape.frame.scale)


@pytest.mark.parametrize("parameters", [{}, {"sizes": "evolved"}], ids=str)
def test_a_small_part_is_found_where_equal_weights_cannot_make_it(parameters):
    """Of two half-planes none is a small spot in the middle of a square."""
    square = Shape.from_mesh(*shapes.rectangle(1, 1, 20, 20))
    text = "area_fraction(spot, min=0.04, max=0.08) + 10*central(spot)"
    evaluator = evaluator_of(square, text, ("spot", "rest"), objectives={"central": central})
    found = seeded(evaluator, population=20, generations=10, **parameters)
    equal = seeded(evaluator, population=20, generations=10, relocations=0, sizes="equal")
    paper = Evolution()(evaluator, rng=np.random.default_rng(0), report=never_stop)
    assert found.weights[0] < 0.6 * found.weights[1]
    for other in equal, paper:
        assert found.history[-1]["best"] < 0.5 * other.history[-1]["best"]


def test_relocation_improves_on_the_best_individual():
    with_, without = (seeded(evaluator_of(), relocations=n).history[-1]["best"] for n in (8, 0))
    assert with_ < without


def test_all_places_are_spread_ones_and_all_elements_where_none_are_asked_for():
    evaluator = evaluator_of()
    spread = SHAPE.points[Places.spread(SHAPE, 10).elements]
    for seed in range(3):
        found = seeded(evaluator, seed=seed, places=10, relocations=0)
        assert all((spread == center).all(axis=1).any() for center in found.centers)
    anywhere = [seeded(evaluator, seed=s, places=0, relocations=0).centers for s in range(3)]
    assert all((SHAPE.points == c).all(axis=1).any() for c in np.concatenate(anywhere))
    assert not all((spread == c).all(axis=1).any() for c in np.concatenate(anywhere))


@pytest.mark.parametrize("after", [1, 2, 5, 20])
def test_it_stops_when_asked_with_the_best_so_far(after):
    seen = []

    def stop(progress):
        seen.append(progress)
        return len(seen) == after

    evaluator = evaluator_of()
    found = seeded(evaluator, report=stop)
    assert len(seen) == after
    assert cost_of(evaluator_of(), found).value == found.history[-1]["best"]
    fractions = [progress.fraction for progress in seen]
    assert fractions == sorted(fractions)
    assert 0 < fractions[0] <= fractions[-1] <= 1


CLOUD = np.random.default_rng(0).random((40, 3)) * [3, 1, 1]


@pytest.mark.parametrize(
    "shape",
    [
        Shape.from_points(CLOUD),
        Shape.from_points(CLOUD).with_adjacency("knn"),
        Shape.from_voxels(np.ones((5, 2, 2), bool)),
        Shape.from_mesh(*shapes.two_boxes()),
        Shape.from_mesh(*shapes.strip(3)),
        Shape.from_mesh(*shapes.strip(4)),
    ],
    ids=["cloud", "linked cloud", "voxels", "two pieces", "3 elements", "4 elements"],
)
@pytest.mark.parametrize("parameters", PARTS, ids=str)
def test_shapes_of_every_kind(shape, parameters):
    found = seeded(evaluator_of(shape, "narrow(stem) + narrow(bar) - narrow(rest)"), **parameters)
    assert len(np.unique(found.centers, axis=0)) == 3
    assert found.history[-1]["empty"] == 0


@pytest.mark.parametrize("parameters", PARTS, ids=str)
def test_a_single_label(parameters):
    found = seeded(evaluator_of(text="narrow(stem)", labels=("stem",)), **parameters)
    assert found.centers.shape == (1, 3)
    assert found.weights.tolist() == pytest.approx([1.0], abs=1)


@pytest.mark.parametrize("parameters", PARTS, ids=str)
def test_centres_that_follow_others_are_where_the_constraints_put_them(parameters):
    evaluator = on_strip("area(a)", ("a", "b", "c"), constraints=["mirror(a, b)"], registry=known())
    found = seeded(evaluator, **parameters)
    middle = evaluator.shape.frame.center
    mirrored = (found.centers[1] - middle) * [-1, 1, 1] + middle
    assert found.centers[0] == pytest.approx(mirrored)
    assert found.weights[0] == pytest.approx(found.weights[1])
    assert cost_of(evaluator, found) == Cost(found.history[-1]["empty"], found.history[-1]["best"])


def test_pins_count():
    evaluator = on_strip("area(a)", pins={"a": [7], "b": [0]})
    found = seeded(evaluator, sizes="equal")
    assert found.history[-1]["empty"] == 0
    assert found.centers[0, 0] > found.centers[1, 0]


def test_a_partition_with_several_centres_for_a_label():
    partition = Voronoi(SHAPE, 3, centers="bar=3", labels=LABELS)
    evaluator = ProblemEvaluator(SHAPE, Problem(LABELS, TEXT), partition)
    found = seeded(evaluator)
    assert found.centers.shape == (3, 3)
    assert cost_of(evaluator, found).value == found.history[-1]["best"]


def test_it_is_a_seeder_that_refuses_other_kinds_of_sizes():
    assert isinstance(SizedEvolution(), Seeder)
    with pytest.raises(UsageError, match=r"'expcted'.*expected"):
        SizedEvolution(sizes="expcted")
