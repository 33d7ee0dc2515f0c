"""Checks of optimizers: asking and telling, on toys that need no shape (Sec. 7).

An optimizer sees vectors and costs and nothing else, so it can be tried on functions that are
known: a bowl, a valley askew to the coordinates, and stairs that are flat between steps, as a
cost is while no element changes its part. Costs are ordered by empty parts first, and some of
what it is told is NaN or infinite: a search that has run for an hour must not fall over that.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Batch, Optimizer
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.problems import as_numbers, clean, unlike
from moseg_core.testing.fixtures.trial import declared, values_for
from moseg_core.types import FloatArray

Toy = Callable[[FloatArray], Cost]

_BOTTOM = np.array([0.31, -0.87, 0.58, 1.23])
_START = np.array([-1.4, 1.1, -0.9, -1.2])
_REACH = 2.0
#: More than any check needs.
_ENOUGH = 600
_LIMIT = "max_evaluations"


def _bowl(x: FloatArray) -> Cost:
    return Cost(0, float(((x - _BOTTOM) ** 2).sum()))


def _valley(x: FloatArray) -> Cost:
    d = x - _BOTTOM
    steep = 10.0 * (d[0] + 0.6 * d[1]) ** 2 + 6.0 * (d[2] - 0.4 * d[3]) ** 2
    return Cost(0, float(steep + (d**2).sum()))


def _stairs(x: FloatArray) -> Cost:
    return Cost(0, float(np.floor(8.0 * np.abs(x - _BOTTOM)).sum()) / 8.0)


def _partly_empty(x: FloatArray) -> Cost:
    """Low where a part is empty, which counts for nothing."""
    return Cost(int(x[0] > 0.1), float(((x - _BOTTOM) ** 2).sum()) - 9.0 * int(x[0] > 0.1))


def _treacherous(x: FloatArray) -> Cost:
    """NaN here, infinite there; and all around the start, which has an empty part."""
    if np.array_equal(x, _START):
        return Cost(1, 5.0)
    spot = 0 if np.abs(x - _START).max() < 0.25 else int(np.floor(7.0 * x).sum()) % 5
    return Cost(0, {0: math.nan, 1: math.inf}.get(spot, float(((x - _BOTTOM) ** 2).sum())))


def _hopeless(x: FloatArray) -> Cost:
    return Cost(0, math.nan)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Trip:
    """What was asked and told, and the optimizer as it stood at the end."""

    search: Optimizer
    batches: list[FloatArray]
    costs: list[list[Cost]]

    @property
    def evaluations(self) -> int:
        return sum(map(len, self.batches))

    @property
    def vectors(self) -> FloatArray:
        return np.vstack(self.batches)

    @property
    def told(self) -> list[Cost]:
        return [cost for costs in self.costs for cost in costs]


def _made(
    subject: Subject,
    *,
    start: FloatArray = _START,
    lower: FloatArray | None = None,
    upper: FloatArray | None = None,
    seed: int = 0,
    limit: int | None = None,
) -> Optimizer:
    low = np.full(len(start), -_REACH) if lower is None else lower
    high = np.full(len(start), _REACH) if upper is None else upper
    scale = np.ones(len(start))
    given = values_for(subject, start)
    if limit is not None:
        given[_LIMIT] = limit
    rng = np.random.default_rng(seed)
    made: Optimizer = subject.load()(start.copy(), low, high, scale, rng=rng, **given)
    return made


def _limits(subject: Subject) -> bool:
    return any(p.name == _LIMIT for p in declared(subject))


def _asked(search: Optimizer, size: int) -> Batch:
    """The next batch, which must be one."""
    batch = search.ask()
    vectors = as_numbers(getattr(batch, "vectors", None))
    if (
        not isinstance(batch, Batch)
        or vectors.ndim != 2
        or vectors.shape[1] != size
        or len(vectors) == 0
        or not np.isfinite(vectors).all()
    ):
        raise ContractFailure(
            did="it was asked for candidates, and had not finished",
            got=f"a {type(batch).__name__} of vectors of shape {vectors.shape}",
            expected=f"a moseg_core.Batch of one or more finite vectors of {size} numbers",
            fix="set 'finished' in tell() where there is nothing left to ask",
        )
    return batch


def _steps(search: Optimizer, toy: Toy, *, size: int = 4) -> Iterator[tuple[Batch, list[Cost]]]:
    """Ask and tell until it has finished or was told enough."""
    count = 0
    while not search.finished and count < _ENOUGH:
        batch = _asked(search, size)
        costs = [toy(vector) for vector in batch.vectors]
        search.tell(costs)
        count += len(costs)
        yield batch, costs


def _trip(search: Optimizer, toy: Toy) -> _Trip:
    steps = list(_steps(search, toy, size=4))
    return _Trip(
        search=search,
        batches=[np.array(batch.vectors) for batch, _ in steps],
        costs=[costs for _, costs in steps],
    )


@check(
    "optimizer-start",
    kinds=["optimizer"],
    why="the first candidate is the start, so that a result is never worse than what was there",
)
def _start(subject: Subject) -> None:
    batch = _made(subject).ask()
    vectors = as_numbers(getattr(batch, "vectors", None))
    if vectors.ndim == 2 and vectors.shape[1] == 4 and (vectors == _START).all(axis=1).any():
        return
    raise ContractFailure(
        did=f"it was made with the start {_START.tolist()} and asked for its first batch",
        got=f"vectors of shape {vectors.shape} without the start",
        expected="a Batch in which the start is one of the vectors, to the bit",
        fix="begin with Batch(vectors=start[None])",
    )


@check(
    "optimizer-ask",
    kinds=["optimizer"],
    why="a batch of nothing, or of numbers that are none, ends the run",
)
def _ask(subject: Subject) -> None:
    for toy in (_bowl, _stairs, lambda x: Cost(0, 1.0)):
        _trip(_made(subject), toy)  # each batch is looked at
    # Where a single point is feasible, there is nothing to search.
    only = _made(subject, lower=_START.copy(), upper=_START.copy())
    _trip(only, _bowl)


@check(
    "optimizer-tell",
    kinds=["optimizer"],
    why="costs that belong to no batch would be taken for those of another, in silence",
)
def _tell(subject: Subject) -> None:
    def told_in_vain(search: Optimizer, when: str) -> None:
        try:
            search.tell([Cost(0, 1.0)])
        except Exception:  # noqa: BLE001  # any complaint will do
            return
        raise ContractFailure(
            did=f"tell() was called {when}",
            got="no complaint",
            expected="an error: there is no batch that the costs could belong to",
            fix="raise moseg_core.UsageError in tell() unless ask() came before it",
        )

    told_in_vain(_made(subject), "before the first ask()")
    search = _made(subject)
    search.tell([_bowl(vector) for vector in search.ask().vectors])
    told_in_vain(search, "twice for one ask()")


@check(
    "optimizer-in-bounds",
    kinds=["optimizer"],
    why="a weight of 0 or less is no weight; what is outside the bounds cannot be evaluated",
)
def _in_bounds(subject: Subject) -> None:
    tiny = np.finfo(np.float64).tiny
    lower = np.array([0.0, tiny, -math.inf, -0.5])
    upper = np.array([1.0, math.inf, 0.3, 0.5])
    beyond = np.array([1.7, -0.6, 2.0, -0.9])
    for start in (np.array([0.2, 1.0, -1.0, 0.1]), np.array([0.0, tiny, 0.3, 0.5])):
        search = _made(subject, start=start, lower=lower, upper=upper)
        for batch, _ in _steps(search, lambda x: Cost(0, float(np.abs(x - beyond).sum()))):
            outside = (batch.vectors < lower) | (batch.vectors > upper)
            if outside.any():
                raise ContractFailure(
                    did=f"it searched from {start.tolist()} between {lower.tolist()} and"
                    f" {upper.tolist()}",
                    got=f"the candidate {batch.vectors[outside.any(axis=1)][0].tolist()}",
                    expected="candidates within the bounds, which they may touch",
                    fix="leave out what is outside, or move it to the bound",
                )


@check(
    "optimizer-budget",
    kinds=["optimizer"],
    why="users compare methods at equal numbers of evaluations, and pay for each of them",
)
def _budget(subject: Subject) -> None:
    if not _limits(subject):
        raise Skip(f"it takes no parameter '{_LIMIT}'")
    for budget in (1, 2, 37, 150):
        search = _made(subject, limit=budget)
        trip = _trip(search, _bowl)
        kept = trip.evaluations == budget or (
            trip.evaluations < budget and search.finished == "converged"
        )
        if not (kept and search.finished):
            raise ContractFailure(
                did=f"it was made with {_LIMIT}={budget} and run until it had finished",
                got=f"{trip.evaluations} evaluations, finished: {search.finished!r}",
                expected=f"exactly {budget}, unless it has 'converged' before",
                fix="cut the last batch short, and set 'finished' when the budget is used up",
            )


@check(
    "optimizer-best",
    kinds=["optimizer"],
    why="what it has found once must not be lost; the result is its best",
)
def _best(subject: Subject) -> None:
    for toy in (_bowl, _valley, _stairs, _partly_empty):
        search = _made(subject)
        known: dict[bytes, Cost] = {}
        for batch, costs in _steps(search, toy):
            known.update((v.tobytes(), c) for v, c in zip(batch.vectors, costs, strict=True))
            vector, cost = search.best
            least = min(known.values())
            if cost != least or known.get(as_numbers(vector).tobytes()) != least:
                raise ContractFailure(
                    did=f"'best' was looked up after {len(known)} different candidates",
                    got=f"{tuple(cost)} at {as_numbers(vector).tolist()}",
                    expected=f"{tuple(least)}, the least told, fewer empty parts first, with the"
                    " vector that it was told of",
                    fix="keep a copy of the best vector and its Cost, whichever way the search"
                    " goes on; compare Costs, not their values",
                )


@check(
    "optimizer-survives-nan",
    kinds=["optimizer"],
    why="one objective that returns NaN must not cost the user the result of an hour",
)
def _survives(subject: Subject) -> None:
    for toy, what in ((_treacherous, "some costs"), (_hopeless, "all costs")):
        search = _made(subject)
        least: Cost | None = None
        for _, costs in _steps(search, toy):
            least = min([clean(cost) for cost in costs] + ([] if least is None else [least]))
            vector, cost = search.best
            lost = math.isfinite(least.value) and cost != least
            if lost or not np.isfinite(as_numbers(vector)).all():
                raise ContractFailure(
                    did=f"it was told NaN or infinity for {what}",
                    got=f"the best {tuple(cost)} at {as_numbers(vector).tolist()}",
                    expected=f"{tuple(least)}, the least of those that are numbers",
                    fix="take NaN for infinity before comparing: with NaN every comparison is"
                    " false",
                )


@check(
    "optimizer-resume",
    kinds=["optimizer"],
    why="a run that was stopped goes on from its checkpoint, and must end where it would have",
)
def _resume(subject: Subject) -> None:
    whole = _trip(_made(subject), _valley)
    search = _made(subject)
    asked: list[FloatArray] = []
    count = 0
    while not search.finished and count < _ENOUGH:
        batch = _asked(search, 4)
        search.tell([_valley(vector) for vector in batch.vectors])
        asked.append(np.array(batch.vectors))
        count += len(batch.vectors)
        search = pickle.loads(pickle.dumps(search))
    same = len(asked) == len(whole.batches) and all(
        unlike(a, b) is None for a, b in zip(asked, whole.batches, strict=True)
    )
    ends = [
        (as_numbers(s.best[0]).tobytes(), s.best[1], s.finished, s.history)
        for s in (search, whole.search)
    ]
    if not same or ends[0] != ends[1]:
        raise ContractFailure(
            did="it was pickled and unpickled after every tell()",
            got=f"{count} evaluations to {tuple(search.best[1])}",
            expected=f"the same candidates as without: {whole.evaluations} evaluations to"
            f" {tuple(whole.search.best[1])}",
            fix="keep all that it goes by in attributes, its rng too; leave __getstate__ alone",
        )


@check(
    "optimizer-promises",
    kinds=["optimizer"],
    why="costs that it says it does not need are not computed; it must not look at them",
)
def _promises(subject: Subject) -> None:
    whole = _trip(_made(subject), _valley)
    search = _made(subject)
    count = 0
    while not search.finished and count < _ENOUGH:
        batch = _asked(search, 4)
        costs = [_valley(vector) for vector in batch.vectors]
        search.tell(_as_little(batch, costs))
        count += len(costs)
    if count != whole.evaluations or unlike(search.best[0], whole.search.best[0]) is not None:
        raise ContractFailure(
            did="costs were answered by lower bounds where its batches' promises, 'cutoff' and"
            " 'best_only', allow it",
            got=f"{count} evaluations to {tuple(search.best[1])}",
            expected=f"the search that exact costs make: {whole.evaluations} evaluations to"
            f" {tuple(whole.search.best[1])}",
            fix="promise in ask() only what tell() does not look at",
        )


def _as_little(batch: Batch, costs: Sequence[Cost]) -> list[Cost]:
    """As little of the truth as the promises of a batch allow."""
    answers = list(costs)
    if batch.best_only:
        best = min(answers)
        answers = [Cost(c.empty, (c.value + best.value) / 2) for c in answers]
    if batch.cutoff is not None:
        answers = [
            a if c < batch.cutoff else batch.cutoff for a, c in zip(answers, costs, strict=True)
        ]
    return answers


@check(
    "optimizer-beats-random",
    kinds=["optimizer"],
    why="a search that is no better than throwing dice is not worth its name",
)
def _beats_random(subject: Subject) -> None:
    limit = 400 if _limits(subject) else None
    toys = {"a bowl": _bowl, "a valley": _valley, "stairs": _stairs}
    for name, toy in toys.items():
        found = sorted(
            min(_trip(_made(subject, seed=seed, limit=limit), toy).told[:400]) for seed in range(3)
        )[1]
        thrown = []
        for seed in range(5):
            rng = np.random.default_rng(seed)
            thrown.append(min(toy(x) for x in rng.uniform(-_REACH, _REACH, (400, 4))))
        if not found < sorted(thrown)[2]:
            raise ContractFailure(
                did=f"it searched {name} in four dimensions, 400 evaluations, with three seeds",
                got=f"a cost of {found.value:.4g} in the middle one",
                expected=f"less than {sorted(thrown)[2].value:.4g}, what random search finds",
                fix="look whether it moves on when told of something better, and how far it steps",
            )


@check(
    "optimizer-records",
    kinds=["optimizer"],
    why="progress bars and curves are drawn from what it says of itself",
)
def _records(subject: Subject) -> None:
    search = _made(subject)
    for _ in _steps(search, _bowl):
        share = search.progress
        if not (isinstance(share, int | float) and 0.0 <= share <= 1.0):
            raise ContractFailure(
                did="'progress' was looked up during a search",
                got=f"{share!r}",
                expected="a number from 0 to 1",
                fix="clip the estimate",
            )
    numbers = all(
        isinstance(key, str) and isinstance(value, int | float | np.number)
        for record in search.history
        for key, value in record.items()
    )
    if not (numbers and isinstance(search.finished, str)):
        raise ContractFailure(
            did="'history' and 'finished' were looked up after a search",
            got=f"{search.history[:1]!r} and {search.finished!r}",
            expected="dicts of numbers by name; and a text, empty while it goes on",
            fix="keep numbers only; say why it ended in 'finished'",
        )
