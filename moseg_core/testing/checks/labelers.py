"""Checks of labelers: which centre gets which label, whatever the centres' numbers (Sec. 6).

The order in which a seeder lists its centres means nothing. A labeler returns a permutation,
decided by what the parts are like; one that says what it is optimal for is compared with all
permutations, one by one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np

from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.comparison import ROUNDING
from moseg_core.testing.fixtures.problems import evaluator_on, vectors
from moseg_core.testing.fixtures.shapes import lump
from moseg_core.testing.fixtures.trial import made
from moseg_core.types import FloatArray, IntArray


def _order(subject: Subject, evaluator: ProblemEvaluator, vector: FloatArray) -> IntArray:
    return np.asarray(made(subject, meets=(evaluator,))(evaluator, vector))


@check("labeler-permutation", kinds=["labeler"])
def _permutation(subject: Subject) -> None:
    """Each label goes to one centre and each centre to one label, or a part is lost."""
    for n in (1, 2, 3, 4):
        evaluator = evaluator_on(lump(), n)
        for vector in vectors(evaluator, 2):
            found = _order(subject, evaluator, vector)
            if np.issubdtype(found.dtype, np.integer) and sorted(found.tolist()) == list(range(n)):
                continue
            raise ContractFailure(
                did=f"it was asked which of {n} centres get {n} labels",
                got=f"{found.tolist()} of {found.dtype}",
                expected=f"a permutation of 0 to {n - 1} as an array of int",
                fix="return for each label, in the problem's order, the number of its centre",
            )


@check("labeler-optimal", kinds=["labeler"])
def _optimal(subject: Subject) -> None:
    """Where it says that its labels are the best, nobody looks for better ones."""
    claim = getattr(subject.load(), "optimal", None)
    if claim is None:
        raise Skip("it does not say that it is optimal")
    if claim not in ("unary", "all"):
        raise ContractFailure(
            did="its attribute 'optimal' was looked up",
            got=f"{claim!r}",
            expected="'unary' or 'all', the terms for which its labels are the best",
            fix="leave it out where there is no guarantee",
        )
    evaluator = evaluator_on(lump(), 4)
    for vector in vectors(evaluator, 6, seed=1):
        found = tuple(_order(subject, evaluator, vector).tolist())
        price = _price(claim, evaluator, vector)
        best = min(itertools.permutations(range(4)), key=price)
        if sorted(found) == [0, 1, 2, 3] and price(found) > price(best) + ROUNDING:
            raise ContractFailure(
                did="its labels of 4 parts were compared with all 24 ways to give them",
                got=f"{list(found)}, at {price(found):.6g}",
                expected=f"{list(best)}, at {price(best):.6g}: the best for "
                + ("the unary terms" if claim == "unary" else "all terms"),
                fix="mend it, or leave out the attribute 'optimal'",
            )


def _price(claim: str, evaluator: ProblemEvaluator, vector: FloatArray) -> Callable[..., float]:
    """What an order costs: the sum of the unary terms, or all of the cost."""
    if claim == "unary":
        costs = evaluator.unary_costs(vector).all()
        return lambda order: float(costs[order, range(4)].sum())
    segmentation = evaluator.segmentation(evaluator.labels(vector))
    return lambda order: evaluator.order_cost(segmentation, np.array(order)).value


@check("labeler-equivariant", kinds=["labeler"])
def _equivariant(subject: Subject) -> None:
    """The order in which a seeder lists its centres means nothing, and must change nothing."""
    evaluator = evaluator_on(lump(), 4)
    for seed, vector in enumerate(vectors(evaluator, 4, seed=2)):
        order = np.random.default_rng(seed).permutation(4)
        before = _order(subject, evaluator, vector)
        after = _order(subject, evaluator, evaluator.parameterization.permute(vector, order))
        if sorted(before.tolist()) != [0, 1, 2, 3] or sorted(after.tolist()) != [0, 1, 2, 3]:
            continue  # labeler-permutation says so
        if order[after].tolist() != before.tolist():
            raise ContractFailure(
                did=f"it labelled 4 parts, and again with the parts listed as {order.tolist()}",
                got=f"labels on the parts {before.tolist()}, then on {order[after].tolist()}",
                expected="the same parts for the same labels, no two costs being equal",
                fix="decide by what parts are like, not by their numbers",
            )
