"""From vectors to costs, in batches: labels, parts, terms (Sec. 4 and 7).

The search spends its time here. Four things keep it short, none of which changes a result:

- terms with a vectorised form are evaluated for all candidates of a batch in one call;
- other values of parts that were seen before are remembered (:mod:`moseg_core.components.memo`);
- equal labellings in a batch are evaluated once;
- where the optimizer promises that only the best of a batch matters, terms are evaluated from
  cheap to expensive, and a candidate is dropped as soon as what is known of its cost, with every
  missing term at the least value that it declares, is more than another candidate's cost. On a
  horse this leaves out nearly all surface distances of a poll. Where an objective bounds its values
  from below for this very shape, that stands in for the least value; with ``paper_horse`` this
  leaves out two of three hulls.

Where a record is kept (:mod:`moseg_core.search.answer_record`), answers that it has are taken from
there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_values
from moseg_core.components.labellings import Labellings
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Parameterization
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import (
    Evaluation,
    Values,
    evaluate_segmentation,
    evaluation_of,
    weighted_sum,
)
from moseg_core.problem.binding import BoundTerm
from moseg_core.problem.calls import (
    all_empty_parts,
    all_term_values,
    call_value,
    known_value,
    leaves_out,
)
from moseg_core.problem.problem import Problem
from moseg_core.search.answer_record import answers_about
from moseg_core.search.assignment import UnaryCosts, unary_values
from moseg_core.search.checked_partition import checked
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray, frozen

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
        self._answers = answers_about(shape, problem, self.parameterization, pins)
        self._lookup = Lookup(problem.registry)
        self._least: Values = [[_least(term)] * len(term.calls) for term in problem.terms]
        self._least_sum = weighted_sum(problem.terms, self._least)
        self._vectorized: list[tuple[int, BoundTerm]] = []
        self._bounded: list[tuple[int, BoundTerm]] = []
        self._by_rank: dict[int, list[tuple[int, BoundTerm]]] = {}
        for t, term in enumerate(problem.terms):
            if term.vectorized is not None:
                self._vectorized.append((t, term))
            else:
                self._by_rank.setdefault(term.cost_rank, []).append((t, term))
            if term.at_least is not None:
                self._bounded.append((t, term))
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
        found: Evaluation | None = None

        def numbers() -> FloatArray:
            nonlocal found
            found = self._evaluated(self.labels(vector), detailed=False)
            return self._numbers(found)

        answer = self._answers.numbers("evaluate", [vector], numbers)
        if found is None:
            found = self._evaluation(answer.tolist())
        self._keep(found.cost, vector)
        return found

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

    def _numbers(self, evaluation: Evaluation) -> FloatArray:
        """(k,) float: an evaluation as numbers; see :meth:`_evaluation`."""
        empty = [float(name in evaluation.empty) for name in self.problem.labels]
        values = [
            math.nan if call.value is None else call.value
            for term in evaluation.terms
            for call in term.calls
        ]
        return np.array([evaluation.broken_pins, *empty, *values])

    def _evaluation(self, numbers: list[float]) -> Evaluation:
        """The evaluation again: broken pins, which parts are empty, values, NaN for those left out.

        Values themselves are finite.
        """
        labels, terms = self.problem.labels, self.problem.terms
        broken, first = int(numbers[0]), 1 + len(labels)
        values = iter(None if math.isnan(value) else value for value in numbers[first:])
        return evaluation_of(
            terms,
            labels,
            [[next(values) for _ in term.calls] for term in terms],
            [number > 0 for number in numbers[1:first]],
            broken_pins=broken,
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
        cutoff = () if batch.cutoff is None else batch.cutoff
        given = [batch.vectors, cutoff, batch.best_only]
        costs = self._answers.costs("costs", given, lambda: self._costs(batch))
        if costs:
            least = min(costs)  # exact, by the batch's promises, unless it is beyond the cutoff
            if batch.cutoff is None or least < batch.cutoff:
                self._keep(least, batch.vectors[costs.index(least)])
        return costs

    def _costs(self, batch: Batch) -> list[Cost]:
        """The same, computed."""
        first_of: dict[bytes, int] = {}
        owner: list[int] = []
        distinct: list[int] = []
        labellings = self._labellings(batch.vectors)
        for row, hashes in enumerate(labellings.summary.hashes):
            owner.append(first_of.setdefault(hashes.tobytes(), len(distinct)))
            if owner[-1] == len(distinct):
                distinct.append(row)
        orders = np.tile(np.arange(labellings.n_parts), (len(distinct), 1))
        found = self._complete(
            _Candidates(self, labellings, np.array(distinct, np.int64), orders),
            cutoff=batch.cutoff,
            best_only=batch.best_only,
        )
        return [found[k] for k in owner]

    def unary_costs(self, vector: FloatArray) -> UnaryCosts:
        """The paper's cost matrix ``C`` for the parts of a vector (Sec. 6)."""
        return self.unary_costs_of(self.segmentation(self.labels(vector)))

    def unary_costs_of(self, segmentation: Segmentation) -> UnaryCosts:
        """The same for parts at hand, in any order."""
        return UnaryCosts(self.problem, segmentation, self.pins, answers=self._answers)

    def order_cost(self, segmentation: Segmentation, order: IntArray) -> Cost:
        """Cost of a segmentation when label ``j`` goes to its part ``order[j]``."""

        def compute() -> list[Cost]:
            labelling = segmentation.labelling
            return self._exact(_Candidates(self, labelling, np.zeros(1, np.int64), order[None]))

        return self._answers.costs("order", [segmentation.level_labels, order], compute)[0]

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
        if not orders:
            return []

        def compute() -> list[Cost]:
            rows = np.zeros(len(orders), np.int64)
            candidates = _Candidates(self, segmentation.labelling, rows, np.stack(orders))
            return self._complete(candidates, cutoff=cutoff, best_only=True)

        given = [segmentation.level_labels, np.stack(orders), cutoff]
        return self._answers.costs("orders", given, compute)

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
        n = len(self.problem.labels)

        def compute() -> FloatArray:
            found = self._labelled_costs(vectors)
            return np.array([[*order, *cost] for order, cost in found], np.float64)

        rows = self._answers.numbers("labelled", [vectors], compute).reshape(-1, n + 2)
        found = [(row[:n].astype(np.int64), Cost(int(row[n]), float(row[n + 1]))) for row in rows]
        for vector, (order, cost) in zip(vectors, found, strict=True):
            if self.best is None or cost < self.best[0]:
                self._keep(cost, self.parameterization.permute(vector, order))
        return found

    def _labelled_costs(self, vectors: FloatArray) -> list[tuple[IntArray, Cost]]:
        """The same, computed."""
        labellings = self._labellings(vectors)
        values = unary_values(self.problem, labellings)
        orders = [
            UnaryCosts(
                self.problem, self._segmentation(labellings, row), self.pins, vectorized=known
            ).assign(self.constraints.groups)
            for row, known in enumerate(values)
        ]
        if not orders:
            return []
        candidates = _Candidates(self, labellings, np.arange(len(orders)), np.stack(orders))
        return list(zip(orders, self._exact(candidates), strict=True))

    def _labellings(self, vectors: FloatArray) -> Labellings:
        """The partitions that vectors describe."""
        # A copy: a parameterization may write its next labels where it wrote these.
        labels = frozen(np.array(self.parameterization.labels(vectors), np.int32, order="C"))
        return Labellings.of(self.shape, labels, len(self.problem.labels), self._lookup)

    def _segmentation(self, labellings: Labellings, row: int) -> Segmentation:
        """One of several partitions, sharing this evaluator's memory."""
        return Segmentation(
            level=labellings.level,
            level_labels=labellings.labels[row],
            n_parts=labellings.n_parts,
            summary=labellings.summary.row(row),
            memo=self.memo,
            lookup=self._lookup,
        )

    def _keep(self, cost: Cost, vector: FloatArray) -> None:
        """Remember a candidate if it is the best so far."""
        if self.best is None or cost < self.best[0]:
            self.best = cost, vector.copy()

    def _exact(self, candidates: _Candidates) -> list[Cost]:
        """Costs of candidates, all terms evaluated."""
        everyone = range(len(candidates.costs))
        candidates.evaluate_vectorized(everyone)
        for c in everyone:
            for rank in sorted(self._by_rank):
                candidates.evaluate(c, rank)
        return candidates.costs

    def _complete(
        self, candidates: _Candidates, *, cutoff: Cost | None, best_only: bool
    ) -> list[Cost]:
        """Costs of distinct candidates, dropping those that cannot matter; see :class:`Batch`."""
        costs, ranks = candidates.costs, sorted(self._by_rank)
        hopeful = [c for c, cost in enumerate(costs) if cutoff is None or cost < cutoff]
        if not best_only:
            candidates.evaluate_vectorized(hopeful)
            if cutoff is not None:
                candidates.bound([c for c in hopeful if costs[c] < cutoff])
            for c in hopeful:
                for rank in ranks:
                    if cutoff is not None and costs[c] >= cutoff:
                        break
                    candidates.evaluate(c, rank)
            return costs
        # Cheapest terms of all first: the most promising candidate then sets the mark early.
        best: tuple[Cost, int] | None = None
        fewest = min((cost.empty for cost in costs), default=0)
        hopeful = [c for c in hopeful if costs[c].empty == fewest]
        candidates.evaluate_vectorized(hopeful)
        candidates.bound([c for c in hopeful if cutoff is None or costs[c] < cutoff])
        if not (self._vectorized or self._bounded) and ranks:
            cheapest = ranks.pop(0)
            for c in hopeful:
                candidates.evaluate(c, cheapest)
        for c in sorted(hopeful, key=lambda c: (costs[c], c)):
            for rank in ranks:
                if cutoff is not None and costs[c] >= cutoff:
                    break
                if best is not None and (costs[c], c) > best:
                    break
                candidates.evaluate(c, rank)
            else:
                if best is None or (costs[c], c) < best:
                    best = (costs[c], c)
        return costs


class _Candidates:
    """Segmentations some of whose terms are evaluated; the others stand at their least.

    Parameters
    ----------
    evaluator : ProblemEvaluator
    labellings : Labellings
    rows : (C,) int
        The labelling that each candidate is of.
    orders : (C, n) int
        Which of its parts bears each label.

    Attributes
    ----------
    costs : list of Cost
        Of each candidate, or a lower bound of it.
    """

    def __init__(
        self,
        evaluator: ProblemEvaluator,
        labellings: Labellings,
        rows: IntArray,
        orders: IntArray,
    ) -> None:
        self._evaluator = evaluator
        self._terms = terms = evaluator.problem.terms
        self._labellings, self._rows, self._orders = labellings, rows, orders
        self._made: dict[int, Segmentation] = {}
        self._empty = all_empty_parts(terms, labellings)[rows[:, None], orders]
        violations: list[int] = np.count_nonzero(self._empty, axis=1).tolist()
        self._some_empty = [count > 0 for count in violations]
        if len(evaluator.pins.elements):
            violations = [
                count + evaluator.pins.broken(self.segmentation(c).level_labels)
                for c, count in enumerate(violations)
            ]
        self.costs = [Cost(count, evaluator._least_sum) for count in violations]
        self._values: list[Values] = [evaluator._least.copy() for _ in violations]
        for c, some in enumerate(self._some_empty):
            if some:
                empty = self._empty[c].tolist()
                self._values[c] = [
                    [None if leaves_out(term, call, empty) else row[0] for call in term.calls]
                    for term, row in zip(terms, self._values[c], strict=True)
                ]
                self._add_up(c)

    def segmentation(self, c: int) -> Segmentation:
        """A candidate's parts, for terms that look at them one by one."""
        if c not in self._made:
            made = self._evaluator._segmentation(self._labellings, int(self._rows[c]))
            order = self._orders[c]
            moved = (order != np.arange(len(order))).any()
            self._made[c] = made.permuted(order) if moved else made
        return self._made[c]

    def _add_up(self, c: int) -> None:
        self.costs[c] = Cost(self.costs[c].empty, weighted_sum(self._terms, self._values[c]))

    def evaluate_vectorized(self, which: Sequence[int]) -> None:
        """Evaluate all terms with a vectorised form; costs become better lower bounds."""
        vectorized = self._evaluator._vectorized
        if not which or not vectorized:
            return
        self._evaluate_all(which, vectorized)

    def _evaluate_all(
        self,
        which: Sequence[int],
        terms: Sequence[tuple[int, BoundTerm]],
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

    def bound(self, which: Sequence[int]) -> None:
        """Bound terms from below that take long to evaluate; costs become better lower bounds."""
        bounded = self._evaluator._bounded
        if which and bounded:
            self._evaluate_all(which, bounded, bounded_by=self._evaluator.memo)

    def evaluate(self, c: int, rank: int) -> None:
        """Evaluate a candidate's other terms of one cost class; its cost becomes a better bound."""
        segmentation, some_empty = self.segmentation(c), self._some_empty[c]
        empty: list[bool] = self._empty[c].tolist()
        missing = []
        for t, term in self._evaluator._by_rank[rank]:
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
        names = self._evaluator.problem.labels
        for term, row in missing:
            for k, call in enumerate(term.calls):
                if row[k] is None:
                    row[k] = call_value(term, call, segmentation, empty, names)
        self._add_up(c)


def _least(term: BoundTerm) -> float:
    """The value of a call that adds the least to the cost."""
    low, high = term.objective.traits.range
    return low if term.weight > 0 else high
