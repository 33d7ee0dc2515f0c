"""From vectors to costs, in batches: labels, parts, terms (Sec. 4 and 7).

The search spends its time here. Four things keep it short, none of which changes a result:

- terms with a vectorised form are evaluated for all candidates of a batch in one call;
- other values of parts that were seen before are remembered (:mod:`moseg_core.components.memo`);
- equal labellings in a batch are evaluated once;
- where the optimizer promises that only the best of a batch matters, what cannot matter is left out
  (:mod:`moseg_core.search.candidates`).

Where a record is kept (:mod:`moseg_core.search.answer_record`), answers that it has are taken from
there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.discovery.lookup import Lookup
from moseg_core.components.field import field_values
from moseg_core.components.labellings import Labellings
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Parameterization
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import Evaluation, evaluate_segmentation, evaluation_of
from moseg_core.problem.problem import Problem
from moseg_core.search.answer_record import answers_about
from moseg_core.search.assignment import UnaryCosts, unary_values
from moseg_core.search.candidates import Candidates, PlannedTerms
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
        self._planned = PlannedTerms.of(problem)
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
        candidates = self._candidates(labellings, np.array(distinct, np.int64), orders)
        found = candidates.complete(cutoff=batch.cutoff, best_only=batch.best_only)
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
            row = np.zeros(1, np.int64)
            return self._candidates(segmentation.labelling, row, order[None]).exact()

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
            candidates = self._candidates(segmentation.labelling, rows, np.stack(orders))
            return candidates.complete(cutoff=cutoff, best_only=True)

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
        candidates = self._candidates(labellings, np.arange(len(orders)), np.stack(orders))
        return list(zip(orders, candidates.exact(), strict=True))

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

    def _candidates(self, labellings: Labellings, rows: IntArray, orders: IntArray) -> Candidates:
        """Some of several partitions, their parts in some orders."""
        return Candidates(
            self._planned,
            labellings,
            rows,
            orders,
            pins=self.pins,
            memo=self.memo,
            segmentation=partial(self._segmentation, labellings),
        )
