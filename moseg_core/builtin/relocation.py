"""Centres that are moved elsewhere, and the search that is tried from there.

A pattern search (Sec. 7) ends where no small step helps, and a small part is lost for good if its
centre began on the wrong side of the shape. So, after a race of a few candidates in short pattern
searches, single centres of the winner are relocated: one goes to another place, or is shaken, or
two labels are exchanged; a short pattern search of the centres that were moved follows, and what it
comes to is kept if it is better: *iterated local search* (Lourenço, Martin, Stützle 2003,
doi:10.1007/0-306-48056-5_11).

Only what a :class:`~moseg_core.components.protocols.Seeding` can say is searched: a row of position
and weight for each centre that no other follows. So nothing is lost when centres and weights are
handed on, whatever else the parameterization's vectors hold.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from moseg_core.builtin.genome import Genome
from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Batch
from moseg_core.types import FloatArray, IntArray

#: Rounds of the race: how many run, the first size of their patterns, and for how many polls.
_ROUNDS = ((6, 0.06, 8), (2, 0.03, 12))
#: How different racers are: some centre is so far from the other's, in diagonals.
_DIFFERENT = 0.08
#: After a relocation: first and last size of the pattern, and for how many polls.
_STEP, _THRESHOLD, _POLLS = 0.05, 0.02, 10

#: How far outside of the bounding box a centre may be, in diagonals; and its least weight.
_MARGIN, _LIGHTEST = 0.05, 0.02

#: Of relocations, those below the first go to any place, below the second are shaken; the rest
#: exchange two labels.
_ELSEWHERE, _SHAKEN = 0.5, 0.7


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """Centres, and what they cost.

    Parameters
    ----------
    cost : Cost
    rows : (g, 4) float
        Position in model units, and weight.
    """

    cost: Cost
    rows: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Relocation:
    """Moves of centres on one shape.

    Parameters
    ----------
    genome : Genome
    points : (s, 3) float
        Where a centre may go, model units.
    count : callable
        Called after each batch with the number of candidates in it.
    stopped : callable
        Whether to end with what is found.
    """

    genome: Genome
    points: FloatArray
    count: Callable[[int], None]
    stopped: Callable[[], bool]

    def improved(
        self, racers: Sequence[Found], times: int, rng: np.random.Generator
    ) -> Iterator[Found]:
        """The best so far: after the race, and after each relocation, until asked to stop.

        Parameters
        ----------
        racers : sequence of Found
            At least one, best first.
        times : int
            Number of relocations.
        rng : numpy.random.Generator
        """
        left = list(racers)
        everything = range(len(left[0].rows))
        for count, step, polls in _ROUNDS:
            left = [
                self.settle(found, everything, step=step, threshold=step / 3, polls=polls, rng=rng)
                for found in left[:count]
            ]
            left.sort(key=lambda found: found.cost)
        best = left[0]
        yield best
        for _ in range(times):
            if self.stopped():
                break
            rows, moved = self.relocated(best, rng)
            cost = self.genome.evaluator.costs(Batch(vectors=self.vector(rows)[None]))[0]
            self.count(1)
            tried = self.settle(
                Found(cost=cost, rows=rows),
                moved,
                step=_STEP,
                threshold=_THRESHOLD,
                polls=_POLLS,
                rng=rng,
            )
            best = min(best, tried, key=lambda found: found.cost)
            yield best

    def vector(self, rows: FloatArray) -> FloatArray:
        """(m,) float: the partition of some rows."""
        return self.genome.vector(rows[:, :3], rows[:, 3])

    def settle(
        self,
        found: Found,
        moved: Sequence[int],
        *,
        step: float,
        threshold: float,
        polls: int,
        rng: np.random.Generator,
    ) -> Found:
        """A pattern search of some rows, the others as they are.

        Parameters
        ----------
        found : Found
            Where it begins.
        moved : sequence of int
            The rows to search.
        step, threshold : float
            First and last size of the pattern.
        polls : int
            Most candidates to evaluate, in complete polls.
        rng : numpy.random.Generator
        """
        chosen = np.asarray(moved, np.int64)
        lower, upper = self._bounds(len(chosen))
        start = found.rows[chosen].reshape(-1).clip(lower, upper)
        search = PatternSearch(
            start,
            lower,
            upper,
            np.tile(np.append(np.full(3, self._diagonal), 1.0), len(chosen)),
            rng=rng,
            pattern_size=step,
            threshold=threshold,
            max_evaluations=1 + 2 * polls * len(start),
        )
        search.ask()
        search.tell([found.cost])  # it is known
        while not search.finished and not self.stopped():
            batch = search.ask()
            vectors = [self.vector(_with(found.rows, chosen, x)) for x in batch.vectors]
            whole = replace(batch, vectors=np.stack(vectors))
            search.tell(self.genome.evaluator.costs(whole))
            self.count(len(vectors))
        best, cost = search.best
        return Found(cost=cost, rows=_with(found.rows, chosen, best))

    def relocated(self, found: Found, rng: np.random.Generator) -> tuple[FloatArray, list[int]]:
        """(g, 4) rows with one change, and the numbers of the rows that it is about.

        Draws ``random()`` for what happens and ``integers(g)`` for the label; then, below 0.5:
        ``integers(s)`` for the place; below 0.7: ``normal(size=4)``; else ``integers`` for another
        label of the same role.
        """
        rows = found.rows.copy()
        what, label = rng.random(), int(rng.integers(len(rows)))
        roles = self.genome.roles
        others = np.flatnonzero((roles == roles[label]) & (np.arange(len(rows)) != label))
        if what >= _SHAKEN and len(others):
            other = int(others[rng.integers(len(others))])
            rows[[label, other]] = rows[[other, label]]
            return rows, [label, other]
        if _ELSEWHERE <= what < _SHAKEN:
            shift = rng.normal(size=4)
            rows[label, :3] += 0.05 * self._diagonal * shift[:3]
            rows[label, 3] *= np.exp(0.3 * shift[3])
            lower, upper = self._bounds(1)
            rows[label] = rows[label].clip(lower, upper)
        else:
            rows[label, :3] = self.points[rng.integers(len(self.points))]
        return rows, [label]

    @property
    def _diagonal(self) -> float:
        """Of the shape's box, model units."""
        return self.genome.evaluator.shape.frame.scale

    def _bounds(self, count: int) -> tuple[FloatArray, FloatArray]:
        """(4 count,) least and greatest values: near the shape's box, of some weight."""
        points, margin = self.genome.evaluator.shape.points, _MARGIN * self._diagonal
        lower = np.append(points.min(axis=0) - margin, _LIGHTEST)
        upper = np.append(points.max(axis=0) + margin, np.inf)
        return np.tile(lower, count), np.tile(upper, count)


def different(ranked: Iterable[Found], diagonal: float) -> list[Found]:
    """Those to race: the first that differ clearly in where some centre is.

    Parameters
    ----------
    ranked : iterable of Found
        Best first.
    diagonal : float
        Of the shape's box, model units.
    """
    chosen: list[Found] = []
    for found in ranked:
        apart = [np.linalg.norm((found.rows - o.rows)[:, :3], axis=1).max() for o in chosen]
        if all(far > _DIFFERENT * diagonal for far in apart):
            chosen.append(found)
        if len(chosen) == _ROUNDS[0][0]:
            break
    return chosen


def candidates_of(times: int, size: int) -> int:
    """About how many candidates :meth:`Relocation.improved` evaluates, for `size` centres."""
    if not times:
        return 0
    race = sum(count * polls for count, _, polls in _ROUNDS) * 8 * size
    return race + times * _POLLS * 8


def _with(rows: FloatArray, chosen: IntArray, values: FloatArray) -> FloatArray:
    """(g, 4) float: rows, some of them replaced."""
    filled = rows.copy()
    filled[chosen] = values.reshape(-1, 4)
    return filled
