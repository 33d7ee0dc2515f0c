"""The evolutionary seeder against Algorithm 3 written out, on the same stream of random numbers."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.builtin.evolution import Evolution, cross, mutate
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Centers, Seeder, never_stop
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
LABELS = ("stem", "bar", "rest")
TEXT = "2*narrow(stem) + compact(bar) - 0.5*flat(rest) + similar_proportions(stem, bar)"


def evaluator_of(shape: Shape = SHAPE, text: str = TEXT) -> ProblemEvaluator:
    problem = Problem(LABELS, text)
    return ProblemEvaluator(shape, problem, Voronoi(shape, len(LABELS)))


def literal_fitness(individual):
    """Best labels by the unary terms, tried one by one, and the whole cost under them."""
    problem, voronoi = Problem(LABELS, TEXT), Voronoi(SHAPE, len(LABELS))
    at = Centers(positions=SHAPE.points[list(individual)], weights=np.ones(len(individual)))
    parts = voronoi.labels(voronoi.encode(at)[None])[0]
    unary = Problem(LABELS, "2*narrow(stem) + compact(bar) - 0.5*flat(rest)")
    best = None
    for order in itertools.permutations(range(len(LABELS))):
        labels = np.array([order.index(part) for part in range(len(LABELS))])[parts]
        cost = unary.evaluate(SHAPE, labels).cost.value
        if best is None or cost < best[0] - 1e-12:
            best = (cost, order, problem.evaluate(SHAPE, labels).cost)
    return best[2], [individual[part] for part in best[1]]


def literal_evolution(population, iterations, fraction, size, rng):
    """Algorithm 3, line by line, with the draws in the documented order."""
    n, count = len(LABELS), SHAPE.n_elements
    points = SHAPE.unit_points

    def tournament(individuals, fitness):
        drawn = rng.choice(len(individuals), size, replace=False).tolist()
        return individuals[min(drawn, key=lambda k: fitness[k])]

    def new(individual):
        while True:
            element = int(rng.integers(count))
            if element not in individual:
                return element

    individuals = [rng.choice(count, n, replace=False).tolist() for _ in range(population)]
    best = None
    history = []
    for iteration in range(iterations):
        fitness = []
        for individual in individuals:
            cost, ordered = literal_fitness(sorted(individual))
            fitness.append(cost)
            if best is None or cost < best[0]:
                best = (cost, ordered)
        history.append((best[0].value, fitness))
        if iteration == iterations - 1:
            break
        following = []
        i = 1
        while i <= fraction * population:
            first, second = tournament(individuals, fitness), tournament(individuals, fitness)
            aligned = min(
                itertools.permutations(second),
                key=lambda order: sum(
                    ((points[a] - points[b]) ** 2).sum()
                    for a, b in zip(first, order, strict=True)  # used at once
                ),
            )
            bits = rng.integers(0, 2, n)
            child = [first[k] if bits[k] == 0 else aligned[k] for k in range(n)]
            for k in range(1, n):
                if child[k] in child[:k]:
                    child[k] = new(child)
            following.append(child)
            i += 1
        while i <= population:
            mutant = list(tournament(individuals, fitness))
            place = int(rng.integers(n))
            mutant[place] = new(mutant)
            following.append(mutant)
            i += 1
        individuals = following
    return best, history


@pytest.mark.parametrize("seed", range(4))
def test_it_follows_the_literal_algorithm_step_by_step(seed):
    evolution = Evolution(population=10, iterations=6, crossover=0.7, tournament=3)
    found = evolution(evaluator_of(), rng=np.random.default_rng(seed), report=never_stop)
    best, history = literal_evolution(10, 6, 0.7, 3, np.random.default_rng(seed))
    assert [record["best"] for record in found.history] == pytest.approx(
        [value for value, _ in history], rel=1e-12
    )
    for record, (_, fitness) in zip(found.history, history, strict=True):
        whole = [cost.value for cost in fitness if cost.empty == 0]
        assert record["mean"] == pytest.approx(np.mean(whole), rel=1e-12)
    assert (found.centers == SHAPE.points[best[1]]).all()
    assert found.labelled


def test_the_best_never_gets_worse_and_is_what_its_centres_cost():
    evaluator = evaluator_of()
    found = Evolution()(evaluator, rng=np.random.default_rng(0), report=never_stop)
    values = [(record["empty"], record["best"]) for record in found.history]
    assert len(values) == 20
    assert values == sorted(values, reverse=True)
    vector = evaluator.parameterization.encode(
        Centers(positions=found.centers, weights=np.ones(len(LABELS)))
    )
    assert evaluator.evaluate(vector).cost == Cost(0, values[-1][1])


def test_individuals_seen_before_are_not_evaluated_again():
    evaluator = evaluator_of()
    asked = []
    costs = evaluator.labelled_costs

    def count(vectors):
        asked.extend(vectors.round(12).tolist())
        return costs(vectors)

    evaluator.labelled_costs = count
    found = Evolution(population=12, iterations=15)(
        evaluator, rng=np.random.default_rng(1), report=never_stop
    )
    assert len({tuple(vector) for vector in asked}) == len(asked) < 12 * 15
    assert found.history[-1]["evaluations"] == len(asked) == evaluator.evaluations


def test_it_stops_when_asked_with_the_best_so_far():
    seen = []

    def stop(progress):
        seen.append(progress)
        return len(seen) == 3

    found = Evolution(population=8)(evaluator_of(), rng=np.random.default_rng(0), report=stop)
    assert len(found.history) == len(seen) == 3
    assert seen[-1].fraction == pytest.approx(3 / 20)
    assert seen[-1].best.value == found.history[-1]["best"]


@pytest.mark.parametrize("n_faces", [3, 4])
def test_as_many_labels_as_elements_or_nearly(n_faces):
    shape = Shape.from_mesh(*shapes.strip(n_faces))
    found = Evolution(population=6, iterations=4)(
        evaluator_of(shape), rng=np.random.default_rng(0), report=never_stop
    )
    assert len(np.unique(found.centers, axis=0)) == 3


elements = st.lists(st.integers(0, 30), min_size=4, max_size=4, unique=True).map(np.array)


@given(first=elements, second=elements, seed=st.integers(0, 9))
def test_children_have_different_centres_from_their_parents_or_new(first, second, seed):
    points = np.random.default_rng(3).random((31, 3))
    child = cross(first, second, points, np.random.default_rng(seed))
    assert len(set(child.tolist())) == 4
    # An aligned pair gives one centre: what is not from the parents replaced a repeated one.
    assert len(set(child.tolist()) - set(first.tolist()) - set(second.tolist())) <= 2
    same = cross(first, first, points, np.random.default_rng(seed))
    assert same.tolist() == first.tolist()


@given(individual=elements, seed=st.integers(0, 9))
def test_a_mutant_differs_in_one_place(individual, seed):
    before = individual.copy()
    mutant = mutate(individual, 31, np.random.default_rng(seed))
    assert (individual == before).all()
    assert (mutant != individual).sum() == 1
    assert len(set(mutant.tolist())) == 4
    everything = np.arange(5)
    assert (mutate(everything, 5, np.random.default_rng(seed)) == everything).all()


def test_it_is_a_seeder():
    assert isinstance(Evolution(), Seeder)
