"""Labels by the assignment that is optimal for the unary objectives (Sec. 6).

The cost matrix holds, for each part and label, the label's unary terms evaluated on the part.
The assignment problem is solved exactly in O(n^3); Kuhn 1955, doi:10.1002/nav.3800020109, in
scipy's implementation (Crouse 2016, doi:10.1109/TAES.2016.140952). Among assignments of equal
cost, four alike legs, the choice is the same every time.
"""

from __future__ import annotations

from moseg_core.components.protocols import Evaluator
from moseg_core.types import FloatArray, IntArray


class Hungarian:
    """The assignment problem on the matrix of unary costs, solved exactly."""

    optimal = "unary"

    def __call__(self, evaluator: Evaluator, vector: FloatArray) -> IntArray:
        """(n,) int: entry ``j`` is the centre that label ``j`` goes to."""
        order: IntArray = evaluator.unary_costs(vector).assign()
        return order
