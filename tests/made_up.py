"""Problems made up at random, over a strip of eight squares, for tests of what evaluates them.

Objectives take arbitrary values that depend on nothing but which elements their parts have, few
different ones, so that costs tie. Labellings are listed, and a vector is the number of one.

For tests of how a search goes on the same strip there are Voronoi partitions, and components that a
test writes down, as if a stranger had brought them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.chosen import PreparedComponent
from moseg_core.components.cost import Cost
from moseg_core.components.discovery.registry import Component
from moseg_core.components.discovery.specs import (
    LabelerSpec,
    OptimizerSpec,
    ParameterizationSpec,
    RefinerSpec,
    SeederSpec,
)
from moseg_core.components.memo import Memo
from moseg_core.components.objectives import FunctionObjective, Traits, objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Centers, Seeding
from moseg_core.components.segmentation import Segmentation
from moseg_core.problem.aggregate import evaluate_segmentation
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.pins import read_pins
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import Listed

STRIP = Shape.from_mesh(*shapes.strip(8))
INF = math.inf
LETTERS = list("abcdefgh")
RANGES = [(0.0, 1.0), (-1.0, 2.0), (0.0, INF), (-INF, 0.5), (-INF, INF), (-3.0, -1.0)]


def number_of(parts, levels):
    """A number from 0 to levels - 1 that depends on which elements the parts have."""
    return sum((k + 1) * part.membership[0] for k, part in enumerate(parts)) % 2**64 % levels


def numbers_of(parts, levels):
    """The same for several calls, of parts along a second axis."""
    hashes = parts._labellings.summary.hashes[..., 0][parts._at].reshape(len(parts), -1)
    times = np.arange(1, hashes.shape[1] + 1, dtype=np.uint64)
    return (hashes * times).sum(axis=1, dtype=np.uint64) % np.uint64(levels)


def made(arity, range_, cost, *, levels=5, calls=None, vectorized=False, bounded=False):
    """An objective of arbitrary values in its range, few of them, so that costs tie.

    Where it has lower bounds, some are the values, others below them and below the range.
    """
    low, high = range_

    def of_share(share):
        if math.isfinite(low) and math.isfinite(high):
            return low + share * (high - low)
        if math.isfinite(low):
            return low + 100 * share
        return (high if math.isfinite(high) else 50.0) - 100 * share

    def all_arbitrary(parts):
        assert (parts.areas > 0).all()
        assert (parts.scales[..., 0] > 0).all()
        return of_share(numbers_of(parts, levels).astype(np.float64) / (levels - 1))

    def arbitrary(subject):
        parts = {"unary": lambda: [subject], "nary": lambda: subject}.get(
            arity, lambda: subject.parts
        )()
        assert all(part.area > 0 and part.scales[0] > 0 for part in parts)
        if calls is not None:
            calls.append(tuple(part.membership for part in parts))
        return of_share(number_of(parts, levels) / (levels - 1))

    def all_at_least(parts):
        return all_arbitrary(parts) - numbers_of(parts, 3)

    form, bound = all_arbitrary if vectorized else None, all_at_least if bounded else None
    traits = Traits(arity=arity, range=range_, cost=cost, vectorized=form, at_least=bound)
    return FunctionObjective(arbitrary, traits)


def evaluator_of(problem, labellings, **options):
    bounds = np.zeros(1), np.full(1, INF), np.ones(1)
    listed = Listed(np.array(labellings), len(problem.labels), *bounds)
    return ProblemEvaluator(STRIP, problem, listed, **options)


def numbers(count):
    return np.arange(count, dtype=np.float64)[:, None]


def plain(objective):
    """An objective without its vectorised form."""
    return FunctionObjective(
        objective._function, replace(objective.traits, vectorized=None), spread=objective._spread
    )


def exact_costs(problem, labellings):
    """Every term of every candidate, one at a time by itself, nothing remembered."""
    return [
        evaluate_segmentation(
            [replace(term, objective=plain(term.objective)) for term in problem.terms],
            problem.labels,
            Segmentation.from_labels(STRIP, labels, len(problem.labels), memo=Memo(size=0)),
        ).cost
        for labels in labellings
    ]


def cost_of(problem, shape, labels):
    """Every term, nothing remembered."""
    parts = Segmentation.from_labels(shape, labels, len(problem.labels), memo=Memo(size=0))
    return evaluate_segmentation(problem.terms, problem.labels, parts).cost


def lower_by_exchange(problem, shape, labels):
    """Costs of all exchanges of two labels that are clearly lower, one at a time."""
    cost = cost_of(problem, shape, labels)
    clearly = Cost(cost.empty, cost.value - 2e-9 * abs(cost.value))
    found = []
    for a, b in itertools.combinations(range(len(problem.labels)), 2):
        swapped = np.where(labels == a, b, np.where(labels == b, a, labels))
        found.append(cost_of(problem, shape, swapped))
    return [other for other in found if other < clearly]


@st.composite
def problems(draw):
    """A problem of 1 to 3 labels with terms of all kinds, and a batch of labellings for it.

    Of the objectives some have a vectorised form, often all or none, and some lower bounds.
    """
    n = draw(st.integers(1, 3))
    names = ["a", "b", "c"][:n]
    objectives, terms = {}, []
    vectorized = draw(st.sampled_from([[False], [True], [False, True]]))
    for k in range(draw(st.integers(1, 5))):
        arity = draw(st.sampled_from(["unary", "nary", "global"]))
        name = f"f{k}"
        objectives[name] = made(
            arity,
            draw(st.sampled_from(RANGES)),
            draw(st.sampled_from(["cheap", "moderate", "expensive"])),
            levels=draw(st.sampled_from([2, 3, 1000])),
            vectorized=draw(st.sampled_from(vectorized)),
            bounded=draw(st.booleans()),
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


def on_strip(text="area(a)", names=("a", "b"), *, pins=None, partition=Voronoi, **more):
    """A problem's evaluator for partitions of the strip; square `k` has its middle at k + 0.5."""
    problem = Problem(list(names), text, objectives={"area": area}, **more)
    return ProblemEvaluator(
        STRIP,
        problem,
        partition(STRIP, len(names)),
        pins=read_pins(pins or {}, problem.labels, STRIP.n_elements),
    )


def centers_at(*squares, weights=None):
    """Centres in the middles of squares of the strip."""
    weights = np.ones(len(squares)) if weights is None else np.array(weights)
    return Centers(positions=STRIP.points[list(squares)], weights=weights)


def stranger(kind, made, **parameters):
    """A component of another bundle, found and prepared; `made` is the class behind it."""
    specs = {
        "parameterization": ParameterizationSpec,
        "seeder": SeederSpec,
        "labeler": LabelerSpec,
        "optimizer": OptimizerSpec,
        "refiner": RefinerSpec,
    }
    spec = specs[kind](name="made", target="strange_module:Made")
    component = Component("strange", "moseg-strange 2.0", spec)
    return PreparedComponent(component=component, factory=made, parameters=parameters)


def seeder(answer):
    """A seeder that returns what it is made of, or what that makes of evaluator and rng."""

    class Made:
        def __call__(self, evaluator, *, rng, report):
            return answer(evaluator, rng) if callable(answer) else answer

    return stranger("seeder", Made)


def seeding_at(*squares, **more):
    """A seeder's answer: centres in the middles of squares of the strip."""
    return Seeding(centers=STRIP.points[list(squares)], **more)


def labeler(answer):
    """A labeler that returns what it is made of, or what that makes of evaluator and vector."""

    class Made:
        def __call__(self, evaluator, vector):
            return answer(evaluator, vector) if callable(answer) else answer

    return stranger("labeler", Made)


def refiner(answer):
    """A refiner that returns what it is made of, or what that makes of evaluator and labels."""

    class Made:
        def __call__(self, evaluator, labels, *, report):
            return answer(evaluator, labels) if callable(answer) else answer

    return stranger("refiner", Made)


def fail(*given):
    """What a stranger's component does on a bad day."""
    raise ValueError("no idea")
