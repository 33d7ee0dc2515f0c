"""Candidates of a batch: terms evaluated from cheap to expensive, as far as they matter (Sec. 7).

Each candidate has a value for every call of every term, which at first is the least that the
objective declares; so its cost is a lower bound from the beginning, and exact in the end. Terms
with a vectorised form are evaluated for all candidates at once. The others follow by cost class
(:class:`PlannedTerms`), of parts that were seen before from memory.

:meth:`Candidates.complete` leaves out what cannot matter. Where only the best of a batch counts, a
candidate is dropped as soon as what is known of its cost is more than another's: on a horse this
leaves out nearly all surface distances of a poll. Where an objective bounds its values from below
for this very shape, that stands in for the least value; with ``paper_horse`` this leaves out two of
three hulls. The winner and its cost are those of exact evaluation, always.

:mod:`moseg_core.search.evaluator` makes candidates of vectors, labellings and orders.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.labellings import Labellings
from moseg_core.components.memo import Memo
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import Values, weighted_sum
from moseg_core.problem.binding import BoundTerm
from moseg_core.problem.calls import (
    all_empty_parts,
    all_term_values,
    call_value,
    known_value,
    leaves_out,
)
from moseg_core.problem.problem import Problem
from moseg_core.shape.pins import Pins
from moseg_core.types import IntArray

NumberedTerm = tuple[int, BoundTerm]
"""A term of a problem, and its place among the terms."""


@dataclass(frozen=True, eq=False)
class PlannedTerms:
    """The terms of a problem, by when they are evaluated.

    Parameters
    ----------
    problem : Problem
    least : list of list of float
        For each call of each term the value that adds the least to the cost.
    least_sum : float
        The cost with all of these.
    vectorized : tuple of (int, BoundTerm)
        Those that are evaluated for all candidates at once.
    bounded : tuple of (int, BoundTerm)
        Those that can be bounded from below for all candidates at once.
    by_rank : dict of int to tuple of (int, BoundTerm)
        The others, by cost class, cheap ones first.
    """

    problem: Problem
    least: Values
    least_sum: float
    vectorized: tuple[NumberedTerm, ...]
    bounded: tuple[NumberedTerm, ...]
    by_rank: dict[int, tuple[NumberedTerm, ...]]

    @classmethod
    def of(cls, problem: Problem) -> PlannedTerms:
        """Those of a problem."""
        numbered = tuple(enumerate(problem.terms))
        single = [(t, term) for t, term in numbered if term.vectorized is None]
        least: Values = [[_least(term)] * len(term.calls) for term in problem.terms]
        return cls(
            problem=problem,
            least=least,
            least_sum=weighted_sum(problem.terms, least),
            vectorized=tuple((t, term) for t, term in numbered if term.vectorized is not None),
            bounded=tuple((t, term) for t, term in numbered if term.at_least is not None),
            by_rank={
                rank: tuple((t, term) for t, term in single if term.cost_rank == rank)
                for rank in sorted({term.cost_rank for _, term in single})
            },
        )


class Candidates:
    """Segmentations some of whose terms are evaluated; the others stand at their least.

    Parameters
    ----------
    planned : PlannedTerms
    labellings : Labellings
    rows : (C,) int
        The labelling that each candidate is of.
    orders : (C, n) int
        Which of its parts bears each label.
    pins : Pins
        Elements that must bear a label; each that does not counts like an empty part.
    memo : Memo
        Values of parts that were seen before.
    segmentation : callable
        Makes the segmentation of one of the labellings, by its number.

    Attributes
    ----------
    costs : list of Cost
        Of each candidate, or a lower bound of it.
    """

    def __init__(
        self,
        planned: PlannedTerms,
        labellings: Labellings,
        rows: IntArray,
        orders: IntArray,
        *,
        pins: Pins,
        memo: Memo,
        segmentation: Callable[[int], Segmentation],
    ) -> None:
        self._planned, self._memo, self._make = planned, memo, segmentation
        self._terms = terms = planned.problem.terms
        self._labellings, self._rows, self._orders = labellings, rows, orders
        self._made: dict[int, Segmentation] = {}
        self._empty = all_empty_parts(terms, labellings)[rows[:, None], orders]
        violations: list[int] = np.count_nonzero(self._empty, axis=1).tolist()
        self._some_empty = [count > 0 for count in violations]
        if len(pins.elements):
            violations = [
                count + pins.broken(self._segmentation(c).level_labels)
                for c, count in enumerate(violations)
            ]
        self.costs = [Cost(count, planned.least_sum) for count in violations]
        self._values: list[Values] = [planned.least.copy() for _ in violations]
        for c, some in enumerate(self._some_empty):
            if some:
                empty = self._empty[c].tolist()
                self._values[c] = [
                    [None if leaves_out(term, call, empty) else row[0] for call in term.calls]
                    for term, row in zip(terms, self._values[c], strict=True)
                ]
                self._add_up(c)

    def exact(self) -> list[Cost]:
        """Costs of all candidates, all terms evaluated."""
        everyone = range(len(self.costs))
        self._evaluate_vectorized(everyone)
        for c in everyone:
            for rank in self._planned.by_rank:
                self._evaluate(c, rank)
        return self.costs

    def complete(self, *, cutoff: Cost | None, best_only: bool) -> list[Cost]:
        """Costs of distinct candidates, exact as far as they matter.

        Parameters
        ----------
        cutoff : Cost or None
        best_only : bool
            What is promised of the costs, see :class:`moseg_core.components.protocols.Batch`.
        """
        costs, ranks = self.costs, list(self._planned.by_rank)
        hopeful = [c for c, cost in enumerate(costs) if cutoff is None or cost < cutoff]
        if not best_only:
            self._evaluate_vectorized(hopeful)
            if cutoff is not None:
                self._bound([c for c in hopeful if costs[c] < cutoff])
            for c in hopeful:
                for rank in ranks:
                    if cutoff is not None and costs[c] >= cutoff:
                        break
                    self._evaluate(c, rank)
            return costs
        # Cheapest terms of all first: the most promising candidate then sets the mark early.
        best: tuple[Cost, int] | None = None
        fewest = min((cost.empty for cost in costs), default=0)
        hopeful = [c for c in hopeful if costs[c].empty == fewest]
        self._evaluate_vectorized(hopeful)
        self._bound([c for c in hopeful if cutoff is None or costs[c] < cutoff])
        if not (self._planned.vectorized or self._planned.bounded) and ranks:
            cheapest = ranks.pop(0)
            for c in hopeful:
                self._evaluate(c, cheapest)
        for c in sorted(hopeful, key=lambda c: (costs[c], c)):
            for rank in ranks:
                if cutoff is not None and costs[c] >= cutoff:
                    break
                if best is not None and (costs[c], c) > best:
                    break
                self._evaluate(c, rank)
            else:
                if best is None or (costs[c], c) < best:
                    best = (costs[c], c)
        return costs

    def _segmentation(self, c: int) -> Segmentation:
        """A candidate's parts, for terms that look at them one by one."""
        if c not in self._made:
            made = self._make(int(self._rows[c]))
            order = self._orders[c]
            moved = (order != np.arange(len(order))).any()
            self._made[c] = made.permuted(order) if moved else made
        return self._made[c]

    def _add_up(self, c: int) -> None:
        self.costs[c] = Cost(self.costs[c].empty, weighted_sum(self._terms, self._values[c]))

    def _evaluate_vectorized(self, which: Sequence[int]) -> None:
        """Evaluate all terms with a vectorised form; costs become better lower bounds."""
        if which and self._planned.vectorized:
            self._evaluate_all(which, self._planned.vectorized)

    def _evaluate_all(
        self,
        which: Sequence[int],
        terms: Sequence[NumberedTerm],
        *,
        bounded_by: Memo | None = None,
    ) -> None:
        """Values, or lower bounds, of some terms of some candidates at once."""
        chosen = np.array(which)
        rows, orders, empty = self._rows[chosen], self._orders[chosen], self._empty[chosen]
        for t, term in terms:
            found = all_term_values(
                term, self._labellings, rows, orders, empty, bounded_by=bounded_by
            )
            for c, row in zip(which, found, strict=True):
                self._values[c][t] = row
        for c in which:
            self._add_up(c)

    def _bound(self, which: Sequence[int]) -> None:
        """Bound terms from below that take long to evaluate; costs become better lower bounds."""
        if which and self._planned.bounded:
            self._evaluate_all(which, self._planned.bounded, bounded_by=self._memo)

    def _evaluate(self, c: int, rank: int) -> None:
        """Evaluate a candidate's other terms of one cost class; its cost becomes a better bound."""
        segmentation, some_empty = self._segmentation(c), self._some_empty[c]
        empty: list[bool] = self._empty[c].tolist()
        missing = []
        for t, term in self._planned.by_rank[rank]:
            row = self._values[c][t] = [
                None
                if some_empty and leaves_out(term, call, empty)
                else known_value(term, call, segmentation)
                for call in term.calls
            ]
            if None in row:
                missing.append((term, row))
                # What is measured of a part is measured in one pass of all that have been made.
                if term.arity == "unary":
                    view = segmentation.view(term.space)
                    for call, value in zip(term.calls, row, strict=True):
                        if value is None:
                            view.part(call[0])
        names = self._planned.problem.labels
        for term, row in missing:
            for k, call in enumerate(term.calls):
                if row[k] is None:
                    row[k] = call_value(term, call, segmentation, empty, names)
        self._add_up(c)


def _least(term: BoundTerm) -> float:
    """The value of a call that adds the least to the cost."""
    low, high = term.objective.traits.range
    return low if term.weight > 0 else high
