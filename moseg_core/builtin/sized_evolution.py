"""Evolution of labelled places with sizes: a seeding that finds small parts.

The paper's seeder (:mod:`moseg_core.builtin.evolution`) chooses sets of elements, with weights of 1
and labels by assignment. Where parts differ in size, an ear and a torso, it seldom finds the small
ones. Five changes, each of which a parameter takes back:

- *sizes*: weights follow the sizes that labels are expected to have, or evolve where none are known
  (:mod:`moseg_core.builtin.sizes`);
- *places*: a few elements spread over the shape, its tips first (:mod:`moseg_core.builtin.places`);
- *informed*: where the problem says of places how well labels fit there, some of the first
  generation are drawn by that (:mod:`moseg_core.builtin.likely_places`), with their labels;
- *labelled*: labels are assigned to the others of the first generation, and then inherited
  (:mod:`moseg_core.builtin.inheritance`), so the fitness is the cost of an individual's own labels;
- *relocations*: the best individuals race in short pattern searches, then single centres of the
  best are moved elsewhere (:mod:`moseg_core.builtin.relocation`).

Survivors are the best of parents and children with different costs: two individuals that only
exchange alike labels are not both kept. ``benchmarks/search_study.py`` measures the changes one by
one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from moseg_core.builtin.genome import Genome
from moseg_core.builtin.inheritance import Individual, cross, mutate, without_repeats
from moseg_core.builtin.likely_places import LikelyPlaces
from moseg_core.builtin.places import Places
from moseg_core.builtin.relocation import Found, Relocation, candidates_of, different
from moseg_core.builtin.sizes import PLAIN, Sizes
from moseg_core.components.cost import Cost
from moseg_core.components.parameters import Interval
from moseg_core.components.protocols import Batch, Evaluator, Progress, Report, Seeding
from moseg_core.errors import UsageError, unknown

SIZES = ("expected", "evolved", "equal")
"""Where weights come from."""

#: How many individuals meet in a tournament, and how likely a child is one of two parents, and
#: changed.
_TOURNAMENT, _CROSSED, _MUTATED = 3, 0.5, 0.8
#: So many candidates are evaluated between two reports, at first.
_CHUNK = 20


@dataclass(frozen=True, eq=False, kw_only=True)
class _Member:
    """An individual, and what it costs."""

    cost: Cost
    individual: Individual


class SizedEvolution:
    """An evolutionary algorithm over labelled places, with weights that follow sizes.

    Parameters
    ----------
    population : int
        Individuals of a generation; twice as many are drawn for the first.
    generations : int
        How often children are born.
    places : int
        Among how many places, spread over the shape, centres are chosen; 0: all elements.
    sizes : {"expected", "evolved", "equal"}
        Where weights come from: the sizes that labels are expected to have, evolution where nothing
        is known; evolution for all; or all are 1.
    informed : float
        How many of the first generation are drawn by what the problem says of places, as a share;
        none where it says nothing, as most do.
    labelled : bool
        Whether labels are inherited; else they are assigned in each generation.
    relocations : int
        How often a centre of the best individual is moved elsewhere, after short pattern searches
        of a few; 0: neither.

    Raises
    ------
    UsageError
        Sizes of another kind.
    """

    searches = True

    #: Where there are several starts, these do what relocations do within one.
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {
        "default": {"population": 30, "generations": 12, "relocations": 0}
    }

    def __init__(
        self,
        *,
        population: Annotated[int, Interval(2)] = 50,
        generations: Annotated[int, Interval(0)] = 20,
        places: Annotated[int, Interval(0)] = 120,
        sizes: str = "expected",
        informed: Annotated[float, Interval(0, 1)] = 0.5,
        labelled: bool = True,
        relocations: Annotated[int, Interval(0)] = 20,
    ) -> None:
        if sizes not in SIZES:
            raise UsageError(unknown("kind of sizes", sizes, SIZES))
        self.population = population
        self.generations = generations
        self.places = places
        self.sizes = sizes
        self.informed = informed
        self.labelled = labelled
        self.relocations = relocations

    @staticmethod
    def example(evaluator: Evaluator) -> dict[str, int]:
        """Fewer of everything, to try it with: a short search in which each step occurs."""
        return {"population": 4, "generations": 3, "relocations": 2}

    def __call__(
        self, evaluator: Evaluator, *, rng: np.random.Generator, report: Report
    ) -> Seeding:
        """Evolve, relocate, and return the best that was found."""
        return _Search(self, evaluator, rng, report).run()


class _Search:
    """One run of the seeder."""

    def __init__(
        self,
        options: SizedEvolution,
        evaluator: Evaluator,
        rng: np.random.Generator,
        report: Report,
    ) -> None:
        shape = evaluator.shape
        self.options, self.evaluator, self.rng, self.report = options, evaluator, rng, report
        self.genome = Genome.of(evaluator)
        self.size = len(self.genome.labels)
        if options.places:
            self.places = Places.spread(shape, max(options.places, self.size))
        else:
            self.places = Places.everywhere(shape)
        self.points = shape.points[self.places.elements]
        shares = evaluator.problem.expected_shares[self.genome.labels]
        self.sizes = Sizes.of(shares, options.sizes)
        self.likely = (
            LikelyPlaces.of(evaluator.problem, shape, self.places.elements, self.genome.labels)
            if options.informed
            else None
        )
        self.relocation = Relocation(
            genome=self.genome,
            points=self.points,
            count=self._count,
            stopped=lambda: self.stopped,
        )
        self.history: list[dict[str, float]] = []
        born = options.population * (2 + options.generations)
        self.expected = born + candidates_of(options.relocations, self.size)
        self.known: set[bytes] = set()
        self.best: Cost | None = None
        self.done = 0
        self.stopped = False

    def run(self) -> Seeding:
        """The best individual, or what became of it."""
        population = self._first()
        for _ in range(self.options.generations):
            if self.stopped:
                break
            population = self._next(population)
        found = self._found(population[0])
        if self.options.relocations and not self.stopped:
            ranked = (self._found(member) for member in population)
            racers = different(ranked, self.evaluator.shape.frame.scale)
            for found in self.relocation.improved(racers, self.options.relocations, self.rng):
                self._note(found.cost)
        centers = self.genome.centers(found.rows[:, :3], found.rows[:, 3])
        return Seeding(
            centers=centers.positions,
            weights=centers.weights,
            history=tuple(self.history),
            labelled=True,
        )

    def _first(self) -> list[_Member]:
        """Likely places, and random ones labelled by assignment; the better half, best first."""
        members: list[_Member] = []
        left = 2 * self.options.population
        informed = 0 if self.likely is None else round(self.options.informed * left)
        while left and not self.stopped:
            count = min(left, _CHUNK, informed or left)
            drawn = [self._drawn(informed=informed > 0) for _ in range(count)]
            found = self._labelled(drawn) if informed else self._assigned(drawn)
            members = self._survivors([*members, *found])
            informed = max(0, informed - count)
            left -= count
            self.best = members[0].cost
            self._count(0)
        self._record(members)
        return members

    def _drawn(self, *, informed: bool) -> Individual:
        """Different places: for their labels where these are informed, else any."""
        if informed:
            assert self.likely is not None  # else none are
            places = self.likely.draw(self.rng)
        else:
            places = self.rng.choice(len(self.places), self.size, replace=False)
        return Individual(places=places, classes=np.full(self.size, PLAIN))

    def _labelled(self, individuals: Sequence[Individual]) -> list[_Member]:
        """Individuals with the labels that their places were drawn for."""
        self.known.update(i.key for i in individuals)
        return _members(self._costs(individuals), individuals)

    def _next(self, population: Sequence[_Member]) -> list[_Member]:
        """The best of a population and its children."""
        children = list(self._children(population))
        members = list(population)
        if children and self.options.labelled:
            # A child that is no better than the last of a full population does not survive.
            full = len(population) == self.options.population
            cutoff = population[-1].cost if full else None
            costs = self._costs(children, cutoff)
            members += _members(costs, children)
        elif children:
            members += self._assigned(children)
        members = self._survivors(members)
        self.best = members[0].cost
        self._count(0)
        self._record(members)
        return members

    def _children(self, population: Sequence[_Member]) -> Iterator[Individual]:
        """As many new individuals as a generation has, or fewer where few are to be found."""
        rng, born = self.rng, 0

        def winner() -> Individual:
            best = int(rng.integers(len(population), size=_TOURNAMENT).min())  # best first
            return population[best].individual

        for _ in range(2 * self.options.population):
            child = winner()
            if rng.random() < _CROSSED:
                child = cross(child, winner(), rng)
            if rng.random() < _MUTATED:
                child = mutate(child, self.places, self.sizes, self.genome.roles, rng)
            child = without_repeats(child, len(self.places), rng)
            if child.key in self.known:
                continue
            self.known.add(child.key)
            yield child
            born += 1
            if born == self.options.population:
                break

    def _survivors(self, members: Sequence[_Member]) -> list[_Member]:
        """The best of different costs, best first; of equal ones the first."""
        found: dict[tuple[int, str], _Member] = {}
        for member in sorted(members, key=lambda member: member.cost):
            found.setdefault((member.cost.empty, f"{member.cost.value:.9g}"), member)
        return list(found.values())[: self.options.population]

    def _assigned(self, individuals: Sequence[Individual]) -> list[_Member]:
        """Individuals whose places get the labels that are best by the unary terms."""
        genome = self.genome
        self.done += len(individuals)
        plain = np.stack([genome.vector(self.points[i.places]) for i in individuals])
        found = self.evaluator.labelled_costs(plain)
        labelled = [
            Individual(places=i.places[genome.places(order)], classes=i.classes)
            for i, (order, _) in zip(individuals, found, strict=True)
        ]
        costs = [cost for _, cost in found]
        # They were labelled with equal weights.
        other = [k for k, i in enumerate(labelled) if np.ptp(self.sizes.weights(i.classes)) > 0]
        if other:
            weighed = self._costs([labelled[k] for k in other])
            for k, cost in zip(other, weighed, strict=True):
                costs[k] = cost
        self.known.update(i.key for i in labelled)
        return _members(costs, labelled)

    def _costs(self, individuals: Sequence[Individual], cutoff: Cost | None = None) -> list[Cost]:
        """Costs of individuals under their own labels."""
        self.done += len(individuals)
        vectors = [
            self.genome.vector(self.points[i.places], self.sizes.weights(i.classes))
            for i in individuals
        ]
        return self.evaluator.costs(Batch(vectors=np.stack(vectors), cutoff=cutoff))

    def _found(self, member: _Member) -> Found:
        """The rows of an individual."""
        places, classes = member.individual.places, member.individual.classes
        rows = np.column_stack([self.points[places], self.sizes.weights(classes)])
        return Found(cost=member.cost, rows=rows)

    def _count(self, candidates: int) -> None:
        """Report so many candidates more, and remember whether somebody asks to stop."""
        self.done += candidates
        if not self.stopped:
            progress = Progress(
                stage="sized_evolution",
                done=self.done,
                best=self.best,
                fraction=min(1.0, self.done / self.expected),
            )
            self.stopped = bool(self.report(progress))

    def _record(self, members: Sequence[_Member]) -> None:
        """A line of the history; the mean is over the individuals without empty parts."""
        whole = [member.cost.value for member in members if member.cost.empty == 0]
        self._note(members[0].cost, **({"mean": float(np.mean(whole))} if whole else {}))

    def _note(self, best: Cost, **more: float) -> None:
        """A line of the history."""
        self.best = best
        self.history.append(
            {"evaluations": self.done, "best": best.value, "empty": best.empty, **more}
        )


def _members(costs: Sequence[Cost], individuals: Sequence[Individual]) -> list[_Member]:
    """Individuals with what each costs."""
    return [
        _Member(cost=cost, individual=individual)
        for cost, individual in zip(costs, individuals, strict=True)
    ]
