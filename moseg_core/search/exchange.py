"""Exchanges of labels: the same parts under other names, wherever that costs less.

A labeler sees single parts only (Sec. 6), and labels stay with their centres during the search
(Sec. 7). So a chair can end with its back called a leg and a leg called seat: every small move of a
centre makes it worse, and one exchange of two labels makes it much better. Exchanges are therefore
tried whenever a search pauses, and on what it has found: the best of all pairs of labels, and the
assignment that is best by the terms about single parts, is carried out as long as it lowers the
cost. What comes out no exchange of two labels improves. (Under ``--settings paper``, which is the
method as published, nothing is exchanged, and a warning says what would be.)

An exchange makes no new parts. Most values are remembered, and a pair that cannot be better is
dropped at the first term that says so (:meth:`ProblemEvaluator.order_costs`): all pairs of 18
labels take as long as a few polls.

Centres go with their labels. Labels that are frozen stay where they are; under constraints only
such labels are exchanged that obey them afterwards (Sec. 8).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.profile import stage
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.types import FloatArray, Int32Array, IntArray

#: What must be gained, as a share of the cost: alike labels that change places change its rounding.
_GAIN = 1e-9
#: How far centres may be from obeying the constraints, in diagonals: rounding only.
_STILL = 1e-9


def exchanged_vector(
    evaluator: ProblemEvaluator, vector: FloatArray, cost: Cost, *, frozen: Sequence[int] = ()
) -> tuple[FloatArray, Cost]:
    """The vector of least cost among those whose parts have exchanged their labels.

    Parameters
    ----------
    evaluator : ProblemEvaluator
    vector : (m,) float
    cost : Cost
        Of the vector.
    frozen : sequence of int
        Labels that keep their centres.

    Returns
    -------
    vector : (m,) float
        As given where no exchange of labels lowers the cost.
    cost : Cost
        Of this vector.
    """
    labels = evaluator.labels(vector)
    order = best_order(evaluator, vector, labels, frozen=frozen, whole=True)
    if (order == np.arange(len(order))).all():
        return vector, cost
    moved = _permuted(evaluator, vector, order)
    found = evaluator.evaluate(moved).cost
    return (moved, found) if found < cost else (vector, cost)


@stage("exchange of labels")
def best_order(
    evaluator: ProblemEvaluator,
    vector: FloatArray,
    labels: Int32Array,
    *,
    frozen: Sequence[int] = (),
    whole: bool = False,
) -> IntArray:
    """The order of the parts of a labelling after which no exchange of labels lowers its cost.

    Parameters
    ----------
    evaluator : ProblemEvaluator
    vector : (m,) float
        Whose centres go with the labels: they must obey the constraints afterwards.
    labels : (F,) int32
        Those of the vector, or what a refiner has made of them.
    frozen : sequence of int
        Labels that keep their parts.
    whole : bool
        Whether parts only change places with those that have as many centres, so that the vector
        keeps its partition.

    Returns
    -------
    (n,) int
        Label ``j`` goes to the part of label ``order[j]``.

    Examples
    --------
    >>> from moseg_core.builtin.voronoi import Voronoi
    >>> from moseg_core.components.objectives import objective
    >>> from moseg_core.components.part import Part
    >>> from moseg_core.components.protocols import Centers
    >>> from moseg_core.problem.problem import Problem
    >>> from moseg_core.shape.shape import Shape
    >>> shape = Shape.from_mesh([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
    ...                         [[0, 5, 4, 3], [5, 1, 2, 4]])
    >>> @objective(range=(0, 9))
    ... def size(part: Part) -> float: return part.area
    >>> problem = Problem(["small", "large"], "size(small)", objectives={"size": size})
    >>> evaluator = ProblemEvaluator(shape, problem, Voronoi(shape, 2))
    >>> vector = evaluator.parameterization.encode(
    ...     Centers(positions=np.array([[4., 0, 0], [0, 0, 0]]), weights=np.ones(2)))
    >>> best_order(evaluator, vector, evaluator.labels(vector)).tolist()
    [1, 0]
    """
    n = len(evaluator.problem.labels)
    segmentation = evaluator.segmentation(labels)
    total = np.arange(n)
    cost = evaluator.order_cost(segmentation, total)
    while True:
        tried = [
            order
            for order in _orders(evaluator, segmentation.level_labels, frozen)
            if _allowed(evaluator, vector, total[order], whole=whole)
        ]
        cutoff = Cost(cost.empty, cost.value - _GAIN * abs(cost.value))
        found = evaluator.order_costs(segmentation, tried, cutoff)
        if not found or min(found) >= cutoff:
            return total
        cost = min(found)
        order = tried[found.index(cost)]
        segmentation, total = segmentation.permuted(order), total[order]


def _orders(
    evaluator: ProblemEvaluator, labels: Int32Array, frozen: Sequence[int]
) -> list[IntArray]:
    """Exchanges of two labels, of two groups that constraints hold together, and an assignment."""
    n = len(evaluator.problem.labels)
    swaps: list[tuple[tuple[int, ...], tuple[int, ...]]] = [
        ((a,), (b,)) for a, b in combinations(range(n), 2)
    ]
    groups = evaluator.constraints.groups
    for first, second in combinations(groups, 2):
        if first.role == second.role and len(first.members) == len(second.members) > 1:
            swaps.append((first.members, second.members))
    orders = []
    for these, those in swaps:
        order = np.arange(n)
        order[[*these, *those]] = [*those, *these]
        orders.append(order)
    if n > 2:
        costs = evaluator.unary_costs_of(evaluator.segmentation(labels))
        orders.append(costs.assign(groups))
    still = list(frozen)
    return [order for order in orders if (order[still] == still).all()]


def _allowed(
    evaluator: ProblemEvaluator, vector: FloatArray, order: IntArray, *, whole: bool
) -> bool:
    """Whether centres may change places like this."""
    partition, constraints = evaluator.parameterization, evaluator.constraints
    counts = partition.centers_per_part
    if whole and (counts[order] != counts).any():
        return False
    if not constraints.active:
        return True
    moved = partition.permute(vector, order)
    return bool(np.abs(constraints.feasible(moved) - moved).max() <= _STILL)


def _permuted(evaluator: ProblemEvaluator, vector: FloatArray, order: IntArray) -> FloatArray:
    """(m,) float: the vector with its parts in another order, obeying the constraints."""
    moved = evaluator.parameterization.permute(vector, order)
    return evaluator.constraints.feasible(moved)
