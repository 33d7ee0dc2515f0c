"""Evolutionary placement of the centres (Sec. 5.2, Algorithm 3).

An individual is a set of n different elements, the places of its centres; all weights are 1. Its
labels are the assignment that is optimal for the unary objectives, its fitness the cost of the
whole problem under these labels: here the lowest wins. A generation is replaced by children, most
of them by crossover of two parents whose centres are first aligned with each other, the rest by
mutation of one. Parents win tournaments. The best individual ever seen is returned.

Under constraints (Sec. 8) an individual holds only the centres that others do not follow. Those on
a plane are moved onto it, the others are expanded from these, before the shape is partitioned.
Labels, and centres of two parents, are matched only with those in the same role.

Random numbers are drawn in this order, so that the run can be followed by hand:

- an individual of the first generation: ``choice(F, n, replace=False)``;
- a tournament: ``choice(population, size, replace=False)``, of equal costs the first drawn wins;
- a crossover: two tournaments, then ``integers(0, 2, n)`` for the bits, then a new element,
  ``integers(F)`` until it is not in the child, for each centre that the child would have twice;
- a mutation: a tournament, ``integers(n)`` for the place, ``integers(F)`` until it is a new one.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import numpy as np
from scipy.spatial.distance import cdist

from moseg_core.builtin.genome import Genome
from moseg_core.components.cost import Cost
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Evaluator, Progress, Report, Seeding
from moseg_core.search.assignment import optimal_assignment
from moseg_core.types import FloatArray, IntArray


class Evolution:
    """An evolutionary algorithm over sets of elements.

    Parameters
    ----------
    population : int
        Individuals of a generation.
    iterations : int
        Generations, the first one included.
    crossover : float
        Share of a generation that comes from crossover.
    tournament : int
        How many individuals meet in a tournament.
    """

    searches = True

    #: What measurements recommend where there are several starts (benchmarks/speed_jobs/stages.py).
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "default": {"population": 20, "iterations": 6}
    }

    def __init__(
        self,
        *,
        population: Annotated[int, Interval(2)] = 50,
        iterations: Annotated[int, Interval(1)] = 20,
        crossover: Annotated[float, Interval(0, 1)] = 0.8,
        tournament: Annotated[int, Interval(1)] = 4,
    ) -> None:
        self.population = population
        self.iterations = iterations
        self.crossover = crossover
        self.tournament = min(tournament, population)

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """Evolve, and return the best individual ever seen, centre by label."""
        points = evaluator.shape.unit_points
        genome = Genome.of(evaluator)
        n = len(genome.labels)
        people = [rng.choice(len(points), n, replace=False) for _ in range(self.population)]
        known: dict[bytes, tuple[Cost, IntArray]] = {}
        history: list[dict[str, float]] = []
        best: tuple[Cost, IntArray] | None = None
        for generation in range(1, self.iterations + 1):
            costs = self._evaluate(people, evaluator, genome, known)
            for individual, cost in zip(people, costs, strict=True):
                if best is None or cost < best[0]:
                    best = cost, known[genome.key(individual)][1]
            assert best is not None  # a population is never empty
            history.append(_record(generation, len(known), costs, best[0]))
            stop = report(
                Progress(
                    stage="evolution",
                    done=len(known),
                    best=best[0],
                    fraction=generation / self.iterations,
                )
            )
            if stop or generation == self.iterations:
                break
            people = self._next(people, costs, points, rng, genome.roles)
        assert best is not None  # at least one generation
        centers = genome.centers(evaluator.shape.points[best[1]]).positions
        return Seeding(centers=centers, history=tuple(history), labelled=True)

    def _evaluate(
        self,
        people: list[IntArray],
        evaluator: Evaluator,
        genome: Genome,
        known: dict[bytes, tuple[Cost, IntArray]],
    ) -> list[Cost]:
        """Costs of a generation; sets of elements seen before are not evaluated again."""
        fresh = {key: genome.sorted(p) for p in people if (key := genome.key(p)) not in known}
        if fresh:
            sets = list(fresh.values())
            vectors = np.stack([genome.vector(evaluator.shape.points[s]) for s in sets])
            for key, s, (order, cost) in zip(
                fresh, sets, evaluator.labelled_costs(vectors), strict=True
            ):
                known[key] = cost, s[genome.places(order)]
        return [known[genome.key(individual)][0] for individual in people]

    def _next(
        self,
        people: list[IntArray],
        costs: list[Cost],
        points: FloatArray,
        rng: np.random.Generator,
        roles: IntArray,
    ) -> list[IntArray]:
        """The next generation: children by crossover first, then mutants."""

        def winner() -> IntArray:
            drawn: list[int] = rng.choice(len(people), self.tournament, replace=False).tolist()
            return people[min(drawn, key=lambda k: costs[k])]

        # Algorithm 3 counts i from 1 and crosses over while i <= fraction * size.
        crossed = int(np.floor(self.crossover * self.population + 1e-9))
        children = [cross(winner(), winner(), points, rng, roles) for _ in range(crossed)]
        while len(children) < self.population:
            children.append(mutate(winner(), len(points), rng))
        return children


def cross(
    first: IntArray,
    second: IntArray,
    points: FloatArray,
    rng: np.random.Generator,
    roles: IntArray | None = None,
) -> IntArray:
    """A child that has each centre from either parent, after aligning them.

    Parameters
    ----------
    first, second : (n,) int
        Elements of the parents.
    points : (F, 3) float
    rng : numpy.random.Generator
    roles : (n,) int, optional
        Centres are aligned only with those in an equal role; all with all by default.

    Returns
    -------
    (n,) int
        n different elements.
    """
    apart = cdist(points[first], points[second], "sqeuclidean")
    if roles is not None:
        apart[roles[:, None] != roles[None, :]] = np.inf
    # Rows are the second parent's centres: for each of the first parent's, its counterpart.
    aligned = second[optimal_assignment(apart.T)]
    bits = rng.integers(0, 2, len(first))
    child = np.where(bits == 0, first, aligned)
    for k in range(1, len(child)):
        if child[k] in child[:k]:
            child[k] = _new_element(child, len(points), rng)
    return child


def mutate(individual: IntArray, n_elements: int, rng: np.random.Generator) -> IntArray:
    """The individual with one of its elements replaced by a random new one.

    Parameters
    ----------
    individual : (n,) int
    n_elements : int
    rng : numpy.random.Generator

    Returns
    -------
    (n,) int
        n different elements; unchanged where there is no other element.
    """
    mutant = individual.copy()
    place = rng.integers(len(individual))
    if len(individual) < n_elements:
        mutant[place] = _new_element(individual, n_elements, rng)
    return mutant


def _new_element(individual: IntArray, n_elements: int, rng: np.random.Generator) -> int:
    while True:
        element = int(rng.integers(n_elements))
        if element not in individual:
            return element


def _record(generation: int, evaluations: int, costs: list[Cost], best: Cost) -> dict[str, float]:
    """A line of the history; the mean is over the individuals without empty parts."""
    whole = [cost.value for cost in costs if cost.empty == 0]
    record: dict[str, float] = {
        "generation": generation,
        "evaluations": evaluations,
        "best": best.value,
        "empty": best.empty,
    }
    if whole:
        record["mean"] = float(np.mean(whole))
    return record
