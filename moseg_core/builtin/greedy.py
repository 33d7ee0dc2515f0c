"""Labels one after the other, each to the part that raises the cost least (Sec. 6).

The cost of a partial assignment counts the terms whose labels are all assigned; global terms
are left out until the end, where they are the same for all. There is no guarantee of optimality,
but n-ary terms are heard, which the Hungarian algorithm cannot do, and many labels are no problem.
"""

from __future__ import annotations

import numpy as np

from moseg_core.components.protocols import Evaluator
from moseg_core.errors import UsageError, unknown
from moseg_core.problem.calls import call_value, empty_parts
from moseg_core.types import FloatArray, IntArray


class Greedy:
    """Each label goes to the part, of those left, that raises the cost least.

    Parameters
    ----------
    order : str or None
        Labels separated by commas, in the order of assignment, ``order="head,body"``; those left
        out follow in the problem's order. None is the problem's order.
    """

    def __init__(self, *, order: str | None = None) -> None:
        self.order = order

    def __call__(self, evaluator: Evaluator, vector: FloatArray) -> IntArray:
        """(n,) int: entry ``j`` is the centre that label ``j`` goes to.

        Raises
        ------
        UsageError
            The order names a label that the problem does not have, or one twice.
        """
        problem = evaluator.problem
        n = len(problem.labels)
        segmentation = evaluator.segmentation(evaluator.labels(vector))
        empty = empty_parts(problem.terms, segmentation)
        order = np.full(n, -1)
        unnamed = ["a part without a label yet"] * n
        for label in self._sequence(problem.labels):
            free = [part for part in range(n) if part not in order]
            increases = []
            for part in free:
                order[label] = part
                total = 0.0
                for term in problem.terms:
                    for call in term.calls:
                        if label in call and all(order[k] >= 0 for k in call):
                            parts = tuple(int(order[k]) for k in call)
                            value = call_value(term, parts, segmentation, empty, unnamed)
                            total += term.weight * (0.0 if value is None else value)
                increases.append(total)
            order[label] = free[int(np.argmin(increases))]
        return order

    def _sequence(self, labels: tuple[str, ...]) -> list[int]:
        """Indices of the labels in the order of assignment."""
        given = [name.strip() for name in self.order.split(",")] if self.order else []
        for name in given:
            if name not in labels:
                raise UsageError(f"labeler 'greedy': {unknown('label', name, labels)}")
            if given.count(name) > 1:
                raise UsageError(f"labeler 'greedy': label '{name}' is given twice")
        rest = [name for name in labels if name not in given]
        return [labels.index(name) for name in given + rest]
