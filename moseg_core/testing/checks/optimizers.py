"""Checks of optimizers: asking and telling, on costs that need no shape (Sec. 7).

An optimizer sees vectors and costs and nothing else, so it can be tried on functions that are
known (:mod:`moseg_core.testing.fixtures.toys`). Some of the costs that it is told of are NaN
or infinite: a search that has run for an hour must not fall over that.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Sequence
from typing import Any

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Batch, Optimizer
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures import toys
from moseg_core.testing.fixtures.comparison import as_numbers, unlike
from moseg_core.testing.fixtures.trial import Trial, declared

_LIMIT = "max_evaluations"


def _made(subject: Subject, *, limit: int | None = None, **options: Any) -> Optimizer:
    parameters = {} if limit is None else {_LIMIT: limit}
    return toys.optimizer_on(Trial(subject=subject, parameters=parameters), **options)


def _limits(subject: Subject) -> bool:
    return any(p.name == _LIMIT for p in declared(subject))


@check("optimizer-start", kinds=["optimizer"])
def _start(subject: Subject) -> None:
    """The first candidate is the start, so that a result is never worse than what was there."""
    vectors = as_numbers(getattr(_made(subject).ask(), "vectors", None))
    if vectors.ndim == 2 and vectors.shape[1] == 4 and (vectors == toys.START).all(axis=1).any():
        return
    raise ContractFailure(
        did=f"it was made with the start {toys.START.tolist()} and asked for its first batch",
        got=f"vectors of shape {vectors.shape} without the start",
        expected="a Batch in which the start is one of the vectors, to the bit",
        fix="begin with Batch(vectors=start[None])",
    )


@check("optimizer-ask", kinds=["optimizer"])
def _ask(subject: Subject) -> None:
    """A batch of nothing, or of numbers that are none, ends the run."""
    for toy in (toys.bowl, toys.stairs, lambda x: Cost(0, 1.0)):
        toys.run_search(_made(subject), toy)  # each batch is looked at
    # Where a single point is feasible, there is nothing to search.
    toys.run_search(_made(subject, lower=toys.START, upper=toys.START), toys.bowl)


@check("optimizer-tell", kinds=["optimizer"])
def _tell(subject: Subject) -> None:
    """Costs that belong to no batch would be taken for those of another, in silence."""

    def tell_in_vain(search: Optimizer, when: str) -> None:
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

    tell_in_vain(_made(subject), "before the first ask()")
    search = _made(subject)
    search.tell([toys.bowl(vector) for vector in search.ask().vectors])
    tell_in_vain(search, "twice for one ask()")


@check("optimizer-in-bounds", kinds=["optimizer"])
def _in_bounds(subject: Subject) -> None:
    """A weight of 0 or less is no weight; what is outside the bounds cannot be evaluated."""
    tiny = np.finfo(np.float64).tiny
    lower = np.array([0.0, tiny, -math.inf, -0.5])
    upper = np.array([1.0, math.inf, 0.3, 0.5])
    beyond = np.array([1.7, -0.6, 2.0, -0.9])
    for start in (np.array([0.2, 1.0, -1.0, 0.1]), np.array([0.0, tiny, 0.3, 0.5])):
        search = _made(subject, start=start, lower=lower, upper=upper)
        for batch, _ in toys.steps(search, lambda x: Cost(0, float(np.abs(x - beyond).sum()))):
            outside = ((batch.vectors < lower) | (batch.vectors > upper)).any(axis=1)
            if outside.any():
                raise ContractFailure(
                    did=f"it searched from {start.tolist()} between {lower.tolist()} and"
                    f" {upper.tolist()}",
                    got=f"the candidate {batch.vectors[outside][0].tolist()}",
                    expected="candidates within the bounds, which they may touch",
                    fix="leave out what is outside, or move it to the bound",
                )


@check("optimizer-budget", kinds=["optimizer"])
def _budget(subject: Subject) -> None:
    """Users compare methods at equal numbers of evaluations, and pay for each of them."""
    if not _limits(subject):
        raise Skip(f"it takes no parameter '{_LIMIT}'")
    for budget in (1, 2, 37, 150):
        search = _made(subject, limit=budget)
        count = len(toys.run_search(search, toys.bowl).costs)
        kept = count == budget or (count < budget and search.finished == "converged")
        if not (kept and search.finished):
            raise ContractFailure(
                did=f"it was made with {_LIMIT}={budget} and run until it had finished",
                got=f"{count} evaluations, finished: {search.finished!r}",
                expected=f"exactly {budget}, unless it has 'converged' before",
                fix="cut the last batch short, and set 'finished' when the budget is used up",
            )


@check("optimizer-ends", kinds=["optimizer"])
def _ends(subject: Subject) -> None:
    """While no element changes its part, costs are the same, and nobody else ends the search."""
    for toy, name in ((toys.plateau, "a plateau"), (toys.stairs, "stairs")):
        search, batches, count = _made(subject), 0, 0
        for batch, _ in toys.steps(search, toy, most=toys.PATIENCE):
            batches, count = batches + 1, count + len(batch.vectors)
        if not search.finished:
            raise ContractFailure(
                did=f"it searched {name} in four dimensions, costs that are constant but for steps",
                got=f"no end after {count} evaluations in {batches} batches",
                expected=f"'finished' within {toys.PATIENCE} evaluations",
                fix="end when the best has not become better for so many batches, or the step is"
                " small, whatever the costs are; or take max_evaluations with a default",
            )


@check("optimizer-best", kinds=["optimizer"])
def _best(subject: Subject) -> None:
    """What it has found once must not be lost; the result is its best."""
    for toy in (toys.bowl, toys.valley, toys.stairs, toys.partly_empty):
        search = _made(subject)
        known: dict[bytes, Cost] = {}
        for batch, costs in toys.steps(search, toy):
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


@check("optimizer-survives-nan", kinds=["optimizer"])
def _survives(subject: Subject) -> None:
    """One objective that returns NaN must not cost the user the result of an hour."""
    for toy, what in ((toys.treacherous, "some costs"), (toys.hopeless, "all costs")):
        search = _made(subject)
        known: list[Cost] = []
        for _, costs in toys.steps(search, toy):
            known += map(toys.without_nan, costs)
            least = min(known)
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


class _Wrapped:
    """An optimizer to which something is done between ask() and tell()."""

    def __init__(self, search: Optimizer) -> None:
        self.search = search

    def __getattr__(self, name: str) -> Any:
        return getattr(self.search, name)


class _Pickled(_Wrapped):
    """One that is pickled and unpickled after every tell()."""

    def tell(self, costs: Sequence[Cost]) -> None:
        self.search.tell(costs)
        self.search = pickle.loads(pickle.dumps(self.search))


class _LowerBounds(_Wrapped):
    """One that gets lower bounds for costs wherever the promises of its batches allow."""

    def ask(self) -> Batch:
        self.batch = self.search.ask()
        return self.batch

    def tell(self, costs: Sequence[Cost]) -> None:
        bounds, cutoff = list(costs), self.batch.cutoff
        if self.batch.best_only:
            best = min(costs)
            bounds = [Cost(c.empty, (c.value + best.value) / 2) for c in costs]
        if cutoff is not None:
            pairs = zip(bounds, costs, strict=True)
            bounds = [bound if cost < cutoff else cutoff for bound, cost in pairs]
        self.search.tell(bounds)


@check("optimizer-resume", kinds=["optimizer"])
def _resume(subject: Subject) -> None:
    """A run that was stopped goes on from its checkpoint, and must end where it would have."""
    whole, resumed = (
        toys.run_search(_made(subject), toys.valley),
        toys.run_search(_Pickled(_made(subject)), toys.valley),
    )
    if _end(whole) != _end(resumed) or unlike(whole.vectors, resumed.vectors) is not None:
        raise ContractFailure(
            did="it was pickled and unpickled after every tell()",
            got=str(resumed),
            expected=f"the same candidates as without: {whole}",
            fix="keep all that it goes by in attributes, its rng too; leave __getstate__ alone",
        )


def _end(run: toys.SearchRecord) -> tuple[Any, ...]:
    search, (vector, cost) = run.search, run.search.best
    return as_numbers(vector).tobytes(), cost, search.finished, search.history


@check("optimizer-promises", kinds=["optimizer"])
def _promises(subject: Subject) -> None:
    """Costs that it says it does not need are not computed; it must not look at them."""
    whole, other = (
        toys.run_search(_made(subject), toys.valley),
        toys.run_search(_LowerBounds(_made(subject)), toys.valley),
    )
    moved = unlike(other.search.best[0], whole.search.best[0]) is not None
    if len(other.costs) != len(whole.costs) or moved:
        raise ContractFailure(
            did="costs were answered by lower bounds where its batches' promises, 'cutoff' and"
            " 'best_only', allow it",
            got=str(other),
            expected=f"the search that exact costs make: {whole}",
            fix="promise in ask() only what tell() does not look at",
        )


@check("optimizer-beats-random", kinds=["optimizer"])
def _beats_random(subject: Subject) -> None:
    """A search that is no better than throwing dice is not worth its name."""
    limit = 400 if _limits(subject) else None
    for name, toy in toys.TOYS.items():
        searches = (_made(subject, seed=seed, limit=limit) for seed in range(3))
        found = sorted(min(toys.run_search(search, toy).costs[:400]) for search in searches)[1]
        thrown = (
            np.random.default_rng(seed).uniform(-toys.REACH, toys.REACH, (400, 4))
            for seed in range(5)
        )
        chance = sorted(min(map(toy, vectors)) for vectors in thrown)[2]
        if not found < chance:
            raise ContractFailure(
                did=f"it searched {name} in four dimensions, 400 evaluations, with three seeds",
                got=f"a cost of {found.value:.4g} in the middle one",
                expected=f"less than {chance.value:.4g}, what random search finds",
                fix="look whether it moves on when told of something better, and how far it steps",
            )


@check("optimizer-records", kinds=["optimizer"])
def _records(subject: Subject) -> None:
    """Progress bars and curves are drawn from what it says of itself."""
    search = _made(subject)
    for _ in toys.steps(search, toys.bowl):
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
