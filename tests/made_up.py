"""Problems made up at random, over a strip of eight squares, for tests of what evaluates them.

Objectives take arbitrary values that depend on nothing but which elements their parts have, few
different ones, so that costs tie. Labellings are listed, and a vector is the number of one.
"""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

from moseg_core.components.memo import Memo
from moseg_core.components.objectives import FunctionObjective, Traits, objective
from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import evaluate_segmentation
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import Listed

STRIP = Shape.from_mesh(*shapes.strip(8))
INF = math.inf
RANGES = [(0.0, 1.0), (-1.0, 2.0), (0.0, INF), (-INF, 0.5), (-INF, INF), (-3.0, -1.0)]


def number_of(parts, levels):
    """A number from 0 to levels - 1 that depends on which elements the parts have."""
    return sum((k + 1) * part.membership[0] for k, part in enumerate(parts)) % 2**64 % levels


def made(arity, range_, cost, *, levels=5, calls=None):
    """An objective of arbitrary values in its range, few of them, so that costs tie."""
    low, high = range_

    def arbitrary(subject):
        parts = {"unary": lambda: [subject], "nary": lambda: subject}.get(
            arity, lambda: subject.parts
        )()
        assert all(part.area > 0 and part.scales[0] > 0 for part in parts)
        if calls is not None:
            calls.append(tuple(part.membership for part in parts))
        share = number_of(parts, levels) / (levels - 1)
        if math.isfinite(low) and math.isfinite(high):
            return low + share * (high - low)
        if math.isfinite(low):
            return low + 100 * share
        return (high if math.isfinite(high) else 50.0) - 100 * share

    return FunctionObjective(arbitrary, Traits(arity=arity, range=range_, cost=cost))


def evaluator_of(problem, labellings, **options):
    bounds = np.zeros(1), np.full(1, INF), np.ones(1)
    listed = Listed(np.array(labellings), len(problem.labels), *bounds)
    return ProblemEvaluator(STRIP, problem, listed, **options)


def numbers(count):
    return np.arange(count, dtype=np.float64)[:, None]


def exact_costs(problem, labellings):
    """Every term of every candidate, one at a time, nothing remembered."""
    return [
        evaluate_segmentation(
            problem.terms,
            problem.labels,
            Segmentation.from_labels(STRIP, labels, len(problem.labels), memo=Memo(size=0)),
        ).cost
        for labels in labellings
    ]


@st.composite
def problems(draw):
    """A problem of 1 to 3 labels with terms of all kinds, and a batch of labellings for it."""
    n = draw(st.integers(1, 3))
    names = ["a", "b", "c"][:n]
    objectives, terms = {}, []
    for k in range(draw(st.integers(1, 5))):
        arity = draw(st.sampled_from(["unary", "nary", "global"]))
        name = f"f{k}"
        objectives[name] = made(
            arity,
            draw(st.sampled_from(RANGES)),
            draw(st.sampled_from(["cheap", "moderate", "expensive"])),
            levels=draw(st.sampled_from([2, 3, 1000])),
        )
        weight = draw(st.sampled_from(["- 3", "- 0.3", "+ 1", "+ 0.1", "+ 10"]))
        count = 0 if arity == "global" else draw(st.integers(2 if arity == "nary" else 1, 3))
        chosen = draw(st.permutations(names))[:count]
        if arity == "nary" and len(chosen) < 2:
            continue
        terms.append(f"{weight}*{name}({', '.join(chosen)})")
    if not terms:
        terms = ["f"]
        objectives["f"] = made("global", (0.0, 1.0), "cheap")
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    # Few distinct segments, so that candidates share parts, repeat, and lack some parts.
    labellings = rng.integers(
        0, n, (draw(st.integers(1, 10)), 8 // draw(st.sampled_from([1, 2, 4])))
    )
    labellings = np.repeat(labellings, 8 // labellings.shape[1], axis=1)
    return Problem(names, "".join(terms), objectives=objectives), labellings


# Two parts, the first of 1 to 7 squares; the cheap term prefers the first to be small.
GROWING = [[0] * k + [1] * (8 - k) for k in range(1, 8)]


@objective(range=(0, math.inf))
def area(part: Part) -> float:
    return part.area


def counted(low, high, value, cost="expensive"):
    calls = []

    def slow(part):
        calls.append(part.n_elements)
        return value(part)

    return FunctionObjective(slow, Traits(arity="unary", range=(low, high), cost=cost)), calls
