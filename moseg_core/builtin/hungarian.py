"""Labels by the assignment that is optimal for the unary objectives (Sec. 6).

The cost matrix holds, for each part and label, the label's unary terms evaluated on the part.
The assignment problem is solved exactly in O(n^3); Kuhn 1955, doi:10.1002/nav.3800020109, in
scipy's implementation (Crouse 2016, doi:10.1109/TAES.2016.140952). Among assignments of equal
cost, four alike legs, the choice is the same every time.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg_core.evaluation import Evaluator
from moseg_core.types import FloatArray, IntArray


class Hungarian:
    """The optimal assignment on unary objectives."""

    def __call__(self, evaluator: Evaluator, vector: FloatArray) -> IntArray:
        """(n,) int: entry ``j`` is the centre that label ``j`` goes to."""
        return optimal_assignment(evaluator.unary_costs(vector))


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
