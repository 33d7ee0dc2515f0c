"""How a search came to its result: the best candidate, each time that there was a better one.

In optimisation the best candidate so far is the *incumbent*. The succession of incumbents shows
what costs alone do not: where seeds lay (Sec. 5), which label went where (Sec. 6), and when parts
found their places (Sec. 7). A run notes the vector whenever the optimizer's best has become better
(:mod:`moseg_core.search.run`), which takes no evaluation and changes nothing in the search; of the
start that won the notes become part of the result, as centres, for the page
(:mod:`moseg_core.view.page.steps`) and for files.

A search improves hundreds of times, most of them late and little. So the succession is thinned to
a number that people look at, evenly on a logarithmic scale of evaluations, and numbers are rounded
to what can be seen: kept in a file it takes some ten kilobytes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Centers
from moseg_core.types import FloatArray, frozen

START, EXCHANGE, END = "start", "exchange", "end"
"""Stages beside "search" and "polish": what seeds and labels were; labels exchanged; the result."""

#: Incumbents that a result keeps at most, and numbers of centres in all of them together; but so
#: many are kept in any case.
_MOST, _NUMBERS, _LEAST = 40, 1000, 16
#: Those that a run under way keeps: more, since several stages are thinned together at the end.
_NOTED = 64
#: Decimal digits of a coordinate below the diagonal, of a weight, and of a cost.
_PLACES, _DIGITS = 4, 6


class Improvement(NamedTuple):
    """An incumbent as a run notes it.

    Parameters
    ----------
    stage : str
    evaluations : int
        Candidates evaluated in this run by then, this one's batch among them.
    cost : Cost
    vector : (m,) float
        In the coordinates that the constraints leave, those that are not free among them.
    """

    stage: str
    evaluations: int
    cost: Cost
    vector: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Incumbent:
    """The best candidate at a moment of the search.

    Parameters
    ----------
    stage : str
        "start" for what seeding and labelling gave, or the given start; "search", "polish", or
        "exchange" where labels had changed places; "end" for the result.
    evaluations : int
        Candidates that this start of the search had evaluated by then.
    cost : Cost
        On the elements that this stage searches on: super-elements of a large shape, of which
        "polish" has more. So it may rise from one stage to the next. To six digits.
    centers : Centers
        As in the result, but rounded to within a two-thousandth of the diagonal; weights to four
        digits.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> result = moseg.segment(shape, problem, optimizer="pattern_search(max_evaluations=200)")
    >>> result.incumbents[0].stage, result.incumbents[-1].stage
    ('start', 'end')
    """

    stage: str
    evaluations: int
    cost: Cost
    centers: Centers

    def __post_init__(self) -> None:
        for array in (self.centers.positions, self.centers.weights):
            frozen(array)


class _Step(Protocol):
    @property
    def evaluations(self) -> int: ...


_S = TypeVar("_S", bound=_Step)


def thinned(steps: Sequence[_S], most: int) -> list[_S]:
    """At most so many of the steps of a search, evenly on a logarithmic scale of evaluations.

    Parameters
    ----------
    steps : sequence
        With ``evaluations`` that never fall. The first and the last are kept.
    most : int
        2 or more.

    Examples
    --------
    >>> steps = [Improvement("search", n, Cost(0, 1 / n), np.zeros(1)) for n in range(1, 65)]
    >>> [step.evaluations for step in thinned(steps, 7)]
    [1, 2, 3, 6, 12, 24, 64]
    """
    kept = list(steps)
    while len(kept) > most:
        at = np.log([max(1, step.evaluations) for step in kept])
        del kept[1 + int(np.argmin(at[2:] - at[:-2]))]  # that whose neighbours are closest
    return kept


def note(noted: list[Improvement], new: Improvement) -> None:
    """Add an improvement to those of a run; now and then they are thinned."""
    noted.append(new)
    if len(noted) >= 2 * _NOTED:
        noted[:] = thinned(noted, _NOTED)


def followed(
    earlier: Sequence[Incumbent], later: Sequence[Incumbent], *, done: int = 0
) -> tuple[Incumbent, ...]:
    """The incumbents of one search after those of another, with `done` evaluations before."""
    counted = [replace(step, evaluations=step.evaluations + done) for step in later]
    if earlier and counted and _same(earlier[-1], counted[0]):
        del counted[0]
    return tuple(thinned([*earlier, *counted], _NOTED))


def kept_incumbents(
    found: Sequence[Incumbent], last: Incumbent, *, size: float
) -> tuple[Incumbent, ...]:
    """What a result keeps: thinned, rounded, with itself at the end.

    Parameters
    ----------
    found : sequence of Incumbent
        Of the start that won; without any there is nothing to keep.
    last : Incumbent
        The result.
    size : float
        The diagonal of the shape, model units.
    """
    if not found:
        return ()
    most = min(_MOST, max(_LEAST, _NUMBERS // (4 * len(last.centers.weights))))
    return tuple(_rounded(step, size) for step in thinned([*found, last], most))


def ended_with(
    kept: Sequence[Incumbent], *, cost: Cost, centers: Centers, size: float
) -> tuple[Incumbent, ...]:
    """What a result keeps, with another end: labels were changed after the search.

    Parameters
    ----------
    kept : sequence of Incumbent
        See :func:`kept_incumbents`.
    cost, centers
        Of the result as it is now.
    size : float
        The diagonal of the shape, model units.
    """
    if not kept:
        return ()
    return (*kept[:-1], _rounded(replace(kept[-1], cost=cost, centers=centers), size))


def _same(one: Incumbent, other: Incumbent) -> bool:
    """Whether two are the same candidate, on the same elements."""
    return (
        one.cost == other.cost
        and np.array_equal(one.centers.positions, other.centers.positions)
        and np.array_equal(one.centers.weights, other.centers.weights)
    )


def _rounded(step: Incumbent, size: float) -> Incumbent:
    """The same in numbers that are short to write."""
    centers = step.centers
    flat = centers.positions.reshape(-1).tolist()
    return replace(
        step,
        cost=Cost(step.cost.empty, _digits(step.cost.value, _DIGITS)),
        centers=replace(
            centers,
            positions=np.array([_places(x, size) for x in flat]).reshape(-1, 3),
            weights=np.array([_digits(w, _PLACES) for w in centers.weights.tolist()]),
        ),
    )


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _places(value: float, size: float) -> float:
    """A coordinate to within a two-thousandth of a size.

    Examples
    --------
    >>> _places(1234567.891, 10.0), _places(0.00012345, 10.0)
    (1234567.891, 0.0)
    """
    if value == 0.0 or size <= 0.0:
        return value
    digits = _PLACES + math.ceil(math.log10(abs(value)) - math.log10(size))
    return 0.0 if digits < 1 else _digits(value, min(digits, 17))
