"""From vectors to costs, in batches: labels, parts, terms (Sec. 4 and 7).

The search spends its time here. Three things keep it short, none of which changes a result:

- values of parts that were seen before are remembered (:mod:`moseg_core.components.memo`);
- equal labellings in a batch are evaluated once;
- where the optimizer promises that only the best of a batch matters, terms are evaluated from
  cheap to expensive, and a candidate is dropped as soon as what is known of its cost, with every
  missing term at the least value that it declares, is more than another candidate's cost. On a
  horse this leaves out nearly all surface distances of a poll.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_values
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Parameterization
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import (
    Evaluation,
    Values,
    call_value,
    empty_parts,
    evaluate_segmentation,
    known_value,
    leaves_out,
    weighted_sum,
)
from moseg_core.problem.binding import BoundTerm
from moseg_core.problem.problem import Problem
from moseg_core.search.assignment import UnaryCosts
from moseg_core.search.checked_partition import checked
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen

#: Up to so many labels of candidates are held at a time, when parts only change their labels.
_TOGETHER = 4_000_000

Found = tuple[Cost, FloatArray]
"""A cost, and the (m,) vector that has it."""


class ProblemEvaluator:
    """The aggregate objective as a function of the parameterization's vectors.

    Parameters
    ----------
    shape : Shape
        The one that the partition is of: embedded, where the problem has an embedding.
    problem : Problem
    parameterization : Parameterization
    pins : Pins, optional
        Elements that must bear a label; each that does not counts like an empty part.
    memo : Memo, optional
        Shared values; a memory of its own by default.
    input : ProblemEvaluator, optional
        Where `shape` is a coarse one, the same on the shape of input elements.

    Attributes
    ----------
    constraints : Constraints
        What the problem asks of the parameterization's vectors.
    evaluations : int
        Number of candidates whose costs were asked for so far.
    best : (Cost, (m,) float) or None
        The least cost among them with its vector, to fall back on where something fails.
    """

    def __init__(
        self,
        shape: Shape,
        problem: Problem,
        parameterization: Parameterization,
        *,
        pins: Pins = NO_PINS,
        memo: Memo | None = None,
        input: ProblemEvaluator | None = None,
    ) -> None:
        problem.check(shape)
        self.shape = shape
        self.problem = problem
        self.parameterization = checked(parameterization, shape)
        self.constraints = problem.constrain(self.parameterization, shape)
        self.pins = pins
        self.memo = Memo() if memo is None else memo
        self.evaluations = 0
        self.best: Found | None = None
        self.input = self if input is None else input
        self._lookup = Lookup(problem.registry)
        self._least: Values = [[_least(term)] * len(term.calls) for term in problem.terms]
        self._least_sum = weighted_sum(problem.terms, self._least)
        self._by_rank: dict[int, list[tuple[int, BoundTerm]]] = {}
        for t, term in enumerate(problem.terms):
            self._by_rank.setdefault(term.cost_rank, []).append((t, term))
        # Before the search, so that a field that fails is known at once, and processes share it.
        for name in problem.fields:
            field_values(shape, name, lookup=self._lookup)

    def labels(self, vector: FloatArray) -> Int32Array:
        """(F,) int32: the labelling that a vector describes."""
        labels: Int32Array = self.parameterization.labels(vector[None])[0]
        return labels

    def segmentation(self, labels: Int32Array) -> Segmentation:
        """The parts of a labelling, sharing this evaluator's memory."""
        return Segmentation.from_labels(
            self.shape,
            labels,
            len(self.problem.labels),
            memo=self.memo,
            lookup=self._lookup,
        )

    def evaluate(self, vector: FloatArray) -> Evaluation:
        """Cost by term and part of one vector."""
        evaluation = self._evaluated(self.labels(vector), detailed=False)
        self._keep(evaluation.cost, vector)
        return evaluation

    def evaluate_labels(self, labels: Int32Array) -> Evaluation:
        """Cost by term and part of one labelling, with what objectives tell of their values."""
        return self._evaluated(labels, detailed=True)

    def _evaluated(self, labels: Int32Array, *, detailed: bool) -> Evaluation:
        return evaluate_segmentation(
            self.problem.terms,
            self.problem.labels,
            self.segmentation(labels),
            broken_pins=self.pins.broken(labels),
            detailed=detailed,
        )

    def costs(self, batch: Batch) -> list[Cost]:
        """Costs of a batch, exact where its promises do not allow otherwise.

        Parameters
        ----------
        batch : Batch

        Returns
        -------
        list of Cost
            In the batch's order. A cost that cannot be the batch's best, or is not below its
            cutoff, may be a lower bound that is not so either.
        """
        self.evaluations += len(batch.vectors)
        first_of: dict[bytes, int] = {}
        owner: list[int] = []
        candidates: list[_Candidate] = []
        for segmentation in self._segmentations(batch.vectors):
            key = segmentation.summary.hashes.tobytes()
            owner.append(first_of.setdefault(key, len(candidates)))
            if owner[-1] == len(candidates):
                candidates.append(_Candidate(self, segmentation))
        found = self._complete(candidates, cutoff=batch.cutoff, best_only=batch.best_only)
        costs = [found[k] for k in owner]
        if costs:
            least = min(costs)  # exact, by the batch's promises, unless it is beyond the cutoff
            if batch.cutoff is None or least < batch.cutoff:
                self._keep(least, batch.vectors[costs.index(least)])
        return costs

    def unary_costs(self, vector: FloatArray) -> UnaryCosts:
        """The paper's cost matrix ``C`` for the parts of a vector (Sec. 6)."""
        return self.unary_costs_of(self.segmentation(self.labels(vector)))

    def unary_costs_of(self, segmentation: Segmentation) -> UnaryCosts:
        """The same for parts at hand, in any order."""
        return UnaryCosts(self.problem, segmentation, self.pins)

    def order_cost(self, segmentation: Segmentation, order: IntArray) -> Cost:
        """Cost of a segmentation when label ``j`` goes to its part ``order[j]``."""
        candidate = _Candidate(self, segmentation.permuted(order))
        for rank in self._by_rank:
            candidate.evaluate(rank)
        return candidate.cost

    def order_costs(
        self, segmentation: Segmentation, orders: Sequence[IntArray], cutoff: Cost
    ) -> list[Cost]:
        """Costs of a segmentation under several orders, of which only the best matters.

        Parameters
        ----------
        segmentation : Segmentation
        orders : sequence of (n,) int
            See :meth:`order_cost`.
        cutoff : Cost
            A cost that is not below it, or not the least, may be a lower bound that is not so
            either.
        """
        self.evaluations += len(orders)
        costs: list[Cost] = []
        together = max(1, _TOGETHER // max(1, segmentation.level.n_elements))
        for first in range(0, len(orders), together):
            some = orders[first : first + together]
            candidates = [_Candidate(self, segmentation.permuted(order)) for order in some]
            costs += self._complete(candidates, cutoff=min([cutoff, *costs]), best_only=True)
        return costs

    def labelled_costs(self, vectors: FloatArray) -> list[tuple[IntArray, Cost]]:
        """For each vector the best labels by the unary objectives, and the cost under them.

        Labels that are in different roles of the constraints are not exchanged.

        Parameters
        ----------
        vectors : (B, m) float
            Their parts are taken to have no labels yet.

        Returns
        -------
        list of (order, Cost)
            ``order[j]`` is the part that label ``j`` goes to; the cost counts all terms.
        """
        self.evaluations += len(vectors)
        found = []
        for vector, segmentation in zip(vectors, self._segmentations(vectors), strict=True):
            order = self.unary_costs_of(segmentation).assign(self.constraints.groups)
            cost = self.order_cost(segmentation, order)
            if self.best is None or cost < self.best[0]:
                self._keep(cost, self.parameterization.permute(vector, order))
            found.append((order, cost))
        return found

    def _segmentations(self, vectors: FloatArray) -> Iterator[Segmentation]:
        """The parts of the partitions that vectors describe."""
        n = len(self.problem.labels)
        # A copy: a parameterization may write its next labels where it wrote these.
        labels = frozen(np.array(self.parameterization.labels(vectors), np.int32, order="C"))
        for row in labels:
            yield Segmentation.from_checked(self.shape, row, n, memo=self.memo, lookup=self._lookup)

    def _keep(self, cost: Cost, vector: FloatArray) -> None:
        """Remember a candidate if it is the best so far."""
        if self.best is None or cost < self.best[0]:
            self.best = cost, vector.copy()

    def _complete(
        self, candidates: list[_Candidate], *, cutoff: Cost | None, best_only: bool
    ) -> list[Cost]:
        """Costs of distinct candidates, dropping those that cannot matter; see :class:`Batch`."""
        limit = cutoff
        ranks = sorted(self._by_rank)
        if not best_only:
            for candidate in candidates:
                for rank in ranks:
                    if limit is not None and candidate.cost >= limit:
                        break
                    candidate.evaluate(rank)
            return [candidate.cost for candidate in candidates]
        # Cheapest terms of all first: the most promising candidate then sets the mark early.
        best: tuple[Cost, int] | None = None
        fewest = min((candidate.violations for candidate in candidates), default=0)
        hopeful = [k for k, c in enumerate(candidates) if c.violations == fewest]
        for k in hopeful:
            candidates[k].evaluate(ranks[0])
        for k in sorted(hopeful, key=lambda k: (candidates[k].cost, k)):
            candidate = candidates[k]
            for rank in ranks[1:]:
                if limit is not None and candidate.cost >= limit:
                    break
                if best is not None and (candidate.cost, k) > best:
                    break
                candidate.evaluate(rank)
            else:
                if best is None or (candidate.cost, k) < best:
                    best = (candidate.cost, k)
        return [candidate.cost for candidate in candidates]


class _Candidate:
    """A segmentation some of whose terms are evaluated; the others stand at their least."""

    def __init__(self, evaluator: ProblemEvaluator, segmentation: Segmentation) -> None:
        self.evaluator = evaluator
        self.terms = terms = evaluator.problem.terms
        self.segmentation = segmentation
        self.empty = empty_parts(terms, segmentation)
        self.violations = sum(self.empty) + evaluator.pins.broken(segmentation.level_labels)
        self.values: Values = evaluator._least.copy()
        least = evaluator._least_sum
        if True in self.empty:
            self.values = [
                [None if leaves_out(term, call, self.empty) else row[0] for call in term.calls]
                for term, row in zip(terms, self.values, strict=True)
            ]
            least = weighted_sum(terms, self.values)
        self.cost = Cost(self.violations, least)

    def evaluate(self, rank: int) -> None:
        """Evaluate the terms of one cost class; `cost` becomes a better lower bound."""
        segmentation, empty = self.segmentation, self.empty
        some_empty, missing = True in empty, []
        for t, term in self.evaluator._by_rank[rank]:
            row = self.values[t] = [
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
        names = self.evaluator.problem.labels
        for term, row in missing:
            for c, call in enumerate(term.calls):
                if row[c] is None:
                    row[c] = call_value(term, call, segmentation, empty, names)
        self.cost = Cost(self.violations, weighted_sum(self.terms, self.values))


def _least(term: BoundTerm) -> float:
    """The value of a call that adds the least to the cost."""
    low, high = term.objective.traits.range
    return low if term.weight > 0 else high
