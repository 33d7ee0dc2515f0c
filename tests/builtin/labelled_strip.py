"""A strip in four parts, with objectives whose values for each part and label are given."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes

N = 4
STRIP = Shape.from_mesh(*shapes.strip(10))
STARTS = np.array([[0.5, 0.5, 0], [2.0, 0.5, 0], [4.5, 0.5, 0], [8.0, 0.5, 0]])
NAMES = ("a", "b", "c", "d")
costs_of = st.lists(
    st.lists(st.integers(-9, 9).map(float), min_size=N, max_size=N), min_size=N, max_size=N
)


def evaluator_with(unary, pairs=None, overall=0.0):
    """A problem whose unary cost of part i as label j is unary[i][j], and so on."""
    voronoi = Voronoi(STRIP, N)
    vector = voronoi.encode(Centers(positions=STARTS, weights=np.ones(N)))
    number = {int(f): i for i, f in enumerate(_middles(voronoi.labels(vector[None])[0]))}

    def index(part: Part) -> int:
        return number[int(part.elements[len(part.elements) // 2])]

    own = {}
    text = []
    for j, name in enumerate(NAMES):

        @objective(range=(-99, 99))
        def single(part: Part, *, j: int = j) -> float:
            return unary[index(part)][j]

        own[f"u{j}"] = single
        text.append(f"u{j}({name})")
    if pairs is not None:

        @objective(range=(-99, 99))
        def pair(first: Part, second: Part) -> float:
            return pairs[index(first)][index(second)]

        @objective(range=(-99, 99))
        def whole(segmentation: Segmentation) -> float:
            return overall

        own |= {"pair": pair, "whole": whole}
        text += ["2*pair(a, c)", "pair(d, b)", "whole"]
    problem = Problem(NAMES, " + ".join(text), objectives=own)
    return ProblemEvaluator(STRIP, problem, voronoi), vector


def _middles(labels):
    return [np.flatnonzero(labels == k)[(labels == k).sum() // 2] for k in range(N)]


def value(order, unary, pairs):
    total = sum(unary[order[j]][j] for j in range(N))
    return total + 2 * pairs[order[0]][order[2]] + pairs[order[3]][order[1]]
