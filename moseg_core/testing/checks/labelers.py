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
from moseg_core.testing.fixtures.problems import evaluator, vectors
from moseg_core.testing.fixtures.trial import values_for
from moseg_core.types import FloatArray, IntArray

_ROUNDING = 1e-9


def _order(subject: Subject, stage: ProblemEvaluator, vector: FloatArray) -> IntArray:
    labeler = subject.load()(**values_for(subject, stage))
    return np.asarray(labeler(stage, vector))


@check(
    "labeler-permutation",
    kinds=["labeler"],
    why="each label goes to one centre and each centre to one label, or a part is lost",
)
def _permutation(subject: Subject) -> None:
    for n in (1, 2, 4):
        stage = evaluator(n)
        for vector in vectors(stage, 2):
            found = _order(subject, stage, vector)
            if np.issubdtype(found.dtype, np.integer) and sorted(found.tolist()) == list(range(n)):
                continue
            raise ContractFailure(
                did=f"it was asked which of {n} centres get {n} labels",
                got=f"{found.tolist()} of {found.dtype}",
                expected=f"a permutation of 0 to {n - 1} as an array of int",
                fix="return for each label, in the problem's order, the number of its centre",
            )


@check(
    "labeler-optimal",
    kinds=["labeler"],
    why="where it says that its labels are the best, nobody looks for better ones",
)
def _optimal(subject: Subject) -> None:
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
    stage = evaluator(4)
    for vector in vectors(stage, 6, seed=1):
        found = tuple(_order(subject, stage, vector).tolist())
        price = _unary(stage, vector) if claim == "unary" else _whole(stage, vector)
        best = min(itertools.permutations(range(4)), key=price)
        if sorted(found) == [0, 1, 2, 3] and price(found) > price(best) + _ROUNDING:
            raise ContractFailure(
                did="its labels of 4 parts were compared with all 24 ways to give them",
                got=f"{list(found)}, at {price(found):.6g}",
                expected=f"{list(best)}, at {price(best):.6g}: the best for "
                + ("the unary terms" if claim == "unary" else "all terms"),
                fix="mend it, or leave out the attribute 'optimal'",
            )


def _unary(stage: ProblemEvaluator, vector: FloatArray) -> Callable[[tuple[int, ...]], float]:
    """Sum of the unary terms under an order, from the whole matrix."""
    costs = stage.unary_costs(vector).all()
    return lambda order: float(sum(costs[part, label] for label, part in enumerate(order)))


def _whole(stage: ProblemEvaluator, vector: FloatArray) -> Callable[[tuple[int, ...]], float]:
    """The cost under an order, of a partition without empty parts."""
    segmentation = stage.segmentation(stage.labels(vector))
    return lambda order: stage.order_cost(segmentation, np.array(order)).value


@check(
    "labeler-equivariant",
    kinds=["labeler"],
    why="the order in which a seeder lists its centres means nothing, and must change nothing",
)
def _equivariant(subject: Subject) -> None:
    stage = evaluator(4)
    for seed, vector in enumerate(vectors(stage, 4, seed=2)):
        before = _order(subject, stage, vector)
        moved = np.random.default_rng(seed).permutation(4)
        turned = stage.parameterization.permute(vector, moved)
        after = _order(subject, stage, turned)
        if sorted(before.tolist()) != [0, 1, 2, 3] or sorted(after.tolist()) != [0, 1, 2, 3]:
            continue  # labeler-permutation says so
        if moved[after].tolist() != before.tolist():
            raise ContractFailure(
                did=f"it labelled 4 parts, and again with the parts listed as {moved.tolist()}",
                got=f"labels on the parts {before.tolist()}, then on {moved[after].tolist()}",
                expected="the same parts for the same labels, no two costs being equal",
                fix="decide by what parts are like, not by their numbers",
            )
