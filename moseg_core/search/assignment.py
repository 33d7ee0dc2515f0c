"""The unary objectives as an assignment problem, evaluated no further than needed (Sec. 6).

Entry ``i, j`` of the paper's cost matrix is what the unary terms of label ``j``, times their
weights, come to on part ``i``. Finding the best assignment seldom needs all n x n entries: cheap
terms are evaluated at once, for the others the least value that the objective declares stands in.
If the best assignment under these lower bounds uses only entries that are known, no other can be
better; if not, what it uses is evaluated and the assignment sought again. Terms that have a
vectorised form are evaluated for all parts of several labellings at once (:func:`unary_values`).
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg_core.components.labellings import Labellings
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.calls import all_empty_parts, call_value, empty_parts, vectorized_values
from moseg_core.problem.constraints import Group
from moseg_core.problem.problem import Problem
from moseg_core.search.answer_record import NO_RECORD, Answers
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.types import BoolArray, FloatArray, IntArray

TermValues = Mapping[int, Sequence[float]]
"""By the number of a unary term its values on all parts of a labelling; NaN for empty ones."""


def unary_values(problem: Problem, labellings: Labellings) -> list[TermValues]:
    """What the unary terms with a vectorised form come to on all parts of each labelling.

    Parameters
    ----------
    problem : Problem
    labellings : Labellings

    Returns
    -------
    list of mapping
        For each labelling, by the term's number in :attr:`Problem.unary_terms`.
    """
    terms = [(t, term) for t, term in enumerate(problem.unary_terms) if term.vectorized is not None]
    if not terms:
        return [{} for _ in range(len(labellings))]
    rows, parts = np.nonzero(~all_empty_parts(problem.terms, labellings))
    values = np.full((len(problem.unary_terms), *labellings.areas.shape), np.nan)
    for t, term in terms:
        values[t, rows, parts] = vectorized_values(term, labellings, rows, parts[:, None])
    lists: list[list[list[float]]] = values.swapaxes(0, 1).tolist()
    return [{t: of_one[t] for t, _ in terms} for of_one in lists]


class UnaryCosts:
    """The cost matrix of one segmentation, entries known or bounded from below.

    Parameters
    ----------
    problem : Problem
    segmentation : Segmentation
        Its parts may come in any order.
    pins : Pins
        An assignment that breaks fewer of them is better whatever it costs.
    vectorized : mapping, optional
        From :func:`unary_values`, where that was asked of several segmentations at once.
    answers : Answers
        Where entries may be known from.

    Attributes
    ----------
    lower : (n, n) float
        Lower bound of the cost of giving part ``i`` the label ``j``; 0 for an empty part, about
        which no objective is asked and which some label has to take.
    known : (n, n) bool
        Where the bound is the cost itself.
    """

    def __init__(
        self,
        problem: Problem,
        segmentation: Segmentation,
        pins: Pins = NO_PINS,
        *,
        vectorized: TermValues | None = None,
        answers: Answers = NO_RECORD,
    ) -> None:
        n = len(problem.labels)
        self._problem, self._given, self._answers = problem, vectorized, answers
        self._broken = pins.broken_by_part(segmentation.level_labels, n)
        self._segmentation = segmentation
        self._empty = empty_parts(problem.terms, segmentation)
        self._terms = [
            [(t, term) for t, term in enumerate(problem.unary_terms) if (label,) in term.calls]
            for label in range(n)
        ]
        # Should an objective fail: the part that it fails on has no label yet.
        self._names = ["a part without a label yet"] * n
        #: A digest of the labelling, which may be long.
        labels = hashlib.blake2b(segmentation.level_labels.tobytes(), digest_size=16)
        self._labels = np.frombuffer(labels.digest(), np.uint8)
        first = answers.numbers("unary", [self._labels], self._first)
        self.lower: FloatArray = first[: n * n].reshape(n, n).copy()
        self.known: BoolArray = first[n * n :].reshape(n, n) > 0

    @cached_property
    def _vectorized(self) -> TermValues:
        """Values of the terms that have a vectorised form."""
        if self._given is not None:
            return self._given
        return unary_values(self._problem, self._segmentation.labelling)[0]

    def _first(self) -> FloatArray:
        """(2, n, n) float: all entries with the cheap terms alone, and where those are all."""
        n = len(self._empty)
        return np.array(
            [[self._summed(part, j, everything=False) for j in range(n)] for part in range(n)],
            np.float64,
        ).transpose(2, 0, 1)

    def evaluate(self, part: int, label: int) -> float:
        """The cost of an entry, known from now on."""
        if not self.known[part, label]:

            def compute() -> FloatArray:
                return np.array(self._summed(part, label, everything=True)[:1])

            given = [self._labels, part, label]
            self.lower[part, label] = self._answers.numbers("unary entry", given, compute)[0]
            self.known[part, label] = True
        return float(self.lower[part, label])

    def all(self) -> FloatArray:
        """(n, n) float: the whole matrix."""
        n = len(self.lower)
        for part in range(n):
            for label in range(n):
                self.evaluate(part, label)
        return self.lower

    def assign(self, groups: Sequence[Group] = ()) -> IntArray:
        """(n,) int: for each label the part that it goes to, of least total cost.

        Parameters
        ----------
        groups : sequence of Group, optional
            Labels that go together, such as a leg and its mirror image: groups change places
            with others of the same role, and nothing else does. All labels may change places
            where every one is a group of its own without a role.
        """
        if any(group.role for group in groups):
            return self._assign_groups(groups)
        while True:
            order = optimal_assignment(self.lower + self._penalty())
            unknown = [(part, j) for j, part in enumerate(order) if not self.known[part, j]]
            if not unknown:
                return order
            for part, label in unknown:
                self.evaluate(part, label)

    def _assign_groups(self, groups: Sequence[Group]) -> IntArray:
        """The best exchange of groups, role by role."""
        order = np.arange(len(self.lower))
        for role in dict.fromkeys(group.role for group in groups):
            same = [group for group in groups if group.role == role]
            for group in same:
                for other in same:
                    for part, label in zip(group.members, other.members, strict=True):
                        self.evaluate(part, label)
            whole = self.lower + self._penalty()
            costs = np.array(
                [[whole[g.members, h.members].sum() for h in same] for g in same]
            ).reshape(len(same), len(same))
            for to, place in enumerate(optimal_assignment(costs)):
                order[list(same[to].members)] = same[place].members
        return order

    def _penalty(self) -> FloatArray:
        """(n, n) float: more for one broken pin than all costs together."""
        penalty: FloatArray = self._broken.astype(np.float64) * (
            1.0 + 2.0 * float(np.abs(self.lower).sum())
        )
        return penalty

    def _summed(self, part: int, label: int, *, everything: bool) -> tuple[float, bool]:
        """The sum of the terms of one entry, dear ones at their least unless everything is asked.

        And whether all of them are known.
        """
        total, complete = 0.0, True
        if not self._empty[part]:
            for t, term in self._terms[label]:
                if t in self._vectorized:
                    total += term.weight * self._vectorized[t][part]
                    continue
                low, high = term.objective.traits.range
                least = low if term.weight > 0 else high
                value: float | None = least
                if everything or term.cost_rank == 0 or not np.isfinite(least):
                    value = call_value(term, (part,), self._segmentation, self._empty, self._names)
                else:
                    complete = False
                total += term.weight * (0.0 if value is None else value)
        return total, complete


def optimal_assignment(costs: FloatArray) -> IntArray:
    """(n,) int: for each column of an (n, n) cost matrix its row, of least total cost.

    Examples
    --------
    >>> import numpy as np
    >>> optimal_assignment(np.array([[9., 1], [2, 9]])).tolist()
    [1, 0]
    """
    rows, columns = linear_sum_assignment(costs)
    order = np.empty(len(costs), np.int64)
    order[columns] = rows
    return order
