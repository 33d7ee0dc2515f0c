"""Labels by trying every assignment (Sec. 6): feasible while there are few labels.

All terms count, not only the unary ones. Of equal costs the first permutation wins, in
lexicographic order.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from moseg_core.components.protocols import Evaluator
from moseg_core.errors import UsageError
from moseg_core.types import FloatArray, IntArray

_MOST_LABELS = 8


class Exhaustive:
    """Each of the n! assignments is tried."""

    optimal = "all"

    def __call__(self, evaluator: Evaluator, vector: FloatArray) -> IntArray:
        """(n,) int: entry ``j`` is the centre that label ``j`` goes to.

        Raises
        ------
        UsageError
            More than 8 labels, with the number of assignments that it would take.
        """
        n = len(evaluator.problem.labels)
        if n > _MOST_LABELS:
            raise UsageError(
                f"labeler 'exhaustive' would try {math.factorial(n)} assignments of {n} labels;"
                f" it takes at most {_MOST_LABELS} labels; use 'hungarian' or 'greedy'"
            )
        segmentation = evaluator.segmentation(evaluator.labels(vector))
        orders = [np.array(order) for order in itertools.permutations(range(n))]
        return min(orders, key=lambda order: evaluator.order_cost(segmentation, order))
