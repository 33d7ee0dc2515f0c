"""The rule by which results with different labels are compared (:mod:`moseg_core.search.variants`).

The total cost would not do: it is a sum over parts, so that it favours few. The mean over the parts
of what each costs, weighted by the root of its area, does not know how many there are. To it is
added what the terms about several parts, or about the whole, cost for each part: a part too many is
often joined to the others along a line that is long, or lies in no crease. On 55 models of eleven
categories whose recipes were learned from four others that named 85.0 % of the area right, the mean
alone 84.4 %, and the best of all label sets 86.5 %.
"""

from __future__ import annotations

import numpy as np

from moseg_core.problem.aggregate import Evaluation
from moseg_core.problem.problem import Problem
from moseg_core.search.result import Result
from moseg_core.types import FloatArray


def typical_cost(problem: Problem, evaluation: Evaluation, areas: FloatArray) -> float:
    """What a part of a result costs, on the mean.

    The mean over the parts of what the unary terms say of each, weight times value, summed over the
    terms; weighted by the root of the parts' areas, so that many small parts do not outweigh the
    body, nor the body all limbs. Parts of which no unary term says anything are left out, as are
    empty ones. In addition what all other terms cost, over the number of parts that are not empty.

    Parameters
    ----------
    problem : Problem
    evaluation : Evaluation
        Of a labelling under this problem.
    areas : (n,) float
        Of each label's part.

    Returns
    -------
    float
        Least is best; 0 where there is no part.

    Examples
    --------
    >>> from moseg_core.shape.shape import Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]],
    ...                         [[0, 1, 4, 3], [1, 2, 5, 4]])
    >>> problem = Problem(["a", "b"], "2*area_fraction(a, max=0.25) + flat(b)")
    >>> evaluation = problem.evaluate(strip, [0, 1])
    >>> [call.value for term in evaluation.terms for call in term.calls]
    [0.25, 0.0]
    >>> typical_cost(problem, evaluation, strip.areas)
    0.25
    """
    costs = np.full(len(problem.labels), np.nan)
    shared = 0.0
    for term, valued in zip(problem.terms, evaluation.terms, strict=True):
        if term.objective.traits.arity != "unary":
            shared += valued.weighted
            continue
        for (label,), call in zip(term.calls, valued.calls, strict=True):
            if call.value is not None:
                costs[label] = np.nan_to_num(costs[label]) + term.weight * call.value
    weights = np.where(np.isnan(costs), 0.0, np.sqrt(areas))
    own = float(np.average(np.nan_to_num(costs), weights=weights)) if weights.any() else 0.0
    n_parts = int((areas > 0).sum())
    return own + shared / n_parts if n_parts else 0.0


def score(result: Result) -> tuple[int, float]:
    """What label sets are compared by: empty parts and broken pins, then the typical cost."""
    problem = result.problem
    assert isinstance(problem, Problem)  # the first level alone
    areas = np.zeros(len(problem.labels))
    np.add.at(areas, result.labels, result.shape.areas)
    return result.evaluation.cost.empty, typical_cost(problem, result.evaluation, areas)
