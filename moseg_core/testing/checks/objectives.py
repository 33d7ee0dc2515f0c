"""What objectives promise: a number in their range, from their own parts, every time the same.

The search builds on each of these. It leaves out expensive terms by the least value that their
range admits, remembers values by which elements the parts have, and refuses shapes by what
objectives say they require. What an objective may moreover promise to leave alone is checked in
:mod:`moseg_core.testing.checks.invariances`.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.memo import Memo
from moseg_core.components.protocols import Batch, Objective
from moseg_core.errors import MosegError
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.drivers import LABELS, segmented, value_of, values_on, vectors_of
from moseg_core.testing.fixtures.problems import voronoi
from moseg_core.testing.fixtures.recording import watched
from moseg_core.testing.fixtures.shapes import ZOO, Labelling, faces_of, labellings, specimen
from moseg_core.testing.fixtures.trial import Raised, Result, declared, required_values, same
from moseg_core.types import FloatArray


def _zoo_values(subject: Subject) -> Result:
    """Values for everything in the zoo that the core may ask about."""

    def compute() -> Result:
        target = subject.load()
        parameters = required_values(declared(subject))
        found: Result = {}
        for name in ZOO:
            shape = specimen(name)
            for labelling in labellings(shape):
                if name == "sample" and labelling.title == "scattered":
                    continue  # no search comes by parts like these, and they take long
                segmentation = segmented(subject, shape, labelling)
                title = f"{name}, {labelling.title}"
                found |= values_on(target, segmentation, title, parameters)
        return found

    values: Result = subject.keep("zoo", compute)
    return values


@check(
    "objective-returns",
    kinds=["objective"],
    why="an error ends the search, however good the rest of the expression is",
)
def returns(subject: Subject) -> None:
    """It raises on no part that the core may pass to it, whatever the shape."""
    for title, value in _zoo_values(subject).items():
        if isinstance(value, Raised):
            raise ContractFailure(
                did=f"it was asked about {title}",
                got=str(value),
                expected="a number",
                fix="handle the case; where it cannot be handled, say in requires=(...) what a"
                " shape must have",
            )


@check(
    "objective-in-range",
    kinds=["objective"],
    why="the search leaves out expensive terms by the least value that the range admits",
)
def in_range(subject: Subject) -> None:
    """Values are finite numbers within the declared range."""
    low, high = subject.load().traits.range
    ends = [abs(end) for end in (low, high) if math.isfinite(end)]
    slack = 1e-9 * max([1.0, *ends])  # what the core takes for rounding
    for title, value in _zoo_values(subject).items():
        if isinstance(value, Raised):
            continue
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if not (math.isfinite(number) and low - slack <= number <= high + slack):
            raise ContractFailure(
                did=f"it was asked about {title}",
                got=repr(value),
                expected=f"a finite number from {low:g} to {high:g}, as it declares",
                fix="handle parts that are flat, thin or a single face; or declare the range that"
                " the values have",
            )


@check(
    "objective-sees-its-parts",
    kinds=["objective"],
    why="values are remembered by the elements of the parts, and wrong where more was looked at",
)
def sees_its_parts(subject: Subject) -> None:
    """The labels of all other elements, and the part's own number, make no difference."""
    target: Objective = subject.load()
    if target.traits.arity == "global":
        raise Skip("it sees the whole segmentation")
    parameters = required_values(declared(subject))
    lump = specimen("lump")
    # Two parts of which objectives may be asked, in a corner of the lump, whatever the rest.
    base = next(found for found in labellings(lump) if found.title == "thirds")
    least = target.traits.least
    if least > 2:
        raise Skip(f"it takes {least} parts")
    rest = np.flatnonzero(base.labels == 2)
    scrambled = base.labels.copy()
    scrambled[rest] = 2 + np.arange(len(rest), dtype=np.int32) % 4
    elsewhere = (scrambled + 1) % 6  # the parts have other numbers, the rest other labels
    values = []
    for labels, first, count in ((base.labels, 0, 3), (elsewhere, 1, 6)):
        given = Labelling(title=base.title, labels=labels.astype(np.int32), n_parts=count)
        parts = segmented(subject, lump, given).parts
        unary = target.traits.arity == "unary"
        chosen = parts[first] if unary else parts[first : first + least]
        values.append(value_of(target, chosen, parameters))
    if not same(values[0], values[1], tolerance=1e-9):
        raise ContractFailure(
            did="the lump's other elements got other labels, and the part another number",
            got=f"{values[0]} and then {values[1]}",
            expected="the same",
            fix="use nothing but the part's own elements and part.shape; what is about the whole"
            " segmentation takes a Segmentation",
        )


_ALTERNATIVES = {"points", "areas", "vertices"}


@check(
    "objective-requires-what-it-reads",
    kinds=["objective"],
    why="a shape that lacks something is refused before the search only if that was declared",
)
def requires_what_it_reads(subject: Subject) -> None:
    """It reads no volume, neighbours or triangles that it does not require."""
    target: Objective = subject.load()
    requires = target.traits.requires
    reads = _reads(subject, "lump")
    missing = sorted((reads & {"volume", "adjacency"}) - requires)
    if "surface" not in requires and reads & {"triangles", "to_mesh"}:
        # A cloud has no triangles; who looks at its points instead can do without.
        instead = _reads(subject, "cloud")
        if "to_mesh" in instead or ("triangles" in instead and not instead & _ALTERNATIVES):
            missing.append("surface")
    if missing:
        names = ", ".join(f'"{name}"' for name in sorted({*requires, *missing}))
        raise ContractFailure(
            did="it was asked about parts that note what is read of them",
            got=f"readings of the {' and the '.join(missing)}",
            expected=f"only what it requires: {', '.join(sorted(requires)) or 'nothing'}",
            fix=f"declare requires=({names},), or do without",
        )


def _reads(subject: Subject, name: str) -> set[str]:
    """What the objective reads of the parts of a specimen."""
    target: Objective = subject.load()
    parameters = required_values(declared(subject))
    found: set[str] = set()
    shape = specimen(name)
    for labelling in labellings(shape):
        seen, reads = watched(segmented(subject, shape, labelling))
        arity = target.traits.arity
        parts = seen.parts
        if arity == "global":
            value_of(target, seen, parameters)
        elif arity == "unary":
            for part in parts:
                value_of(target, part, parameters)
        else:
            most = len(parts) if target.traits.most is None else target.traits.most
            if len(parts) >= target.traits.least:
                value_of(target, parts[:most], parameters)
        found |= reads
    return found


@check(
    "objective-keeps-shapes-apart",
    kinds=["objective"],
    why="a cache of one's own that confuses two shapes gives the second the values of the first",
)
def keeps_shapes_apart(subject: Subject) -> None:
    """What it was asked about one shape makes no difference to another of the same name."""
    first, second = specimen("lump"), _stretched("lump")
    _values_of(subject, first)
    after = _values_of(subject, second)
    fresh = _values_of(subject, replace(second, name="a shape never seen before"))
    for title, value in fresh.items():
        if not same(value, after[title], tolerance=1e-9):
            raise ContractFailure(
                did=f"it was asked about two shapes of one name, one after the other ({title})",
                got=f"{after[title]} for the second",
                expected=f"{value}, as for the same shape under another name",
                fix="keep no values of your own; what is worth keeping is a measure, which the"
                " core remembers: part.measure('bundle:name')",
            )


def _stretched(name: str) -> Shape:
    shape = specimen("lump")
    vertices = shape.geometry.vertices * [1.7, 0.8, 1.2]
    return Shape.from_mesh(vertices, faces_of(shape), name=name)


def _values_of(subject: Subject, shape: Shape) -> Result:
    parameters = required_values(declared(subject))
    found: Result = {}
    for labelling in labellings(shape)[:3]:
        segmentation = segmented(subject, shape, labelling)
        found |= values_on(subject.load(), segmentation, labelling.title, parameters)
    return found


# -- Evaluated as the core does ---------------------------------------------------------------


def _evaluator(subject: Subject, *, remember: bool) -> ProblemEvaluator:
    """A problem of three labels whose only term is the objective, on the lump.

    Raises
    ------
    Skip
        The objective takes more parts.
    """
    target: Objective = subject.load()
    traits = target.traits
    most = 3 if traits.arity == "unary" or traits.most is None else traits.most
    if traits.least > 3:
        raise Skip(f"it takes {traits.least} parts")
    said = [f"{key}={float(value):g}" for key, value in required_values(declared(subject)).items()]
    labels = [] if traits.arity == "global" else list(LABELS[:most])
    inside = ", ".join([*labels, *said])
    problem = Problem(
        LABELS,
        f"tested({inside})" if inside else "tested",
        objectives={"tested": target},
        registry=subject.registry,
    )
    shape = specimen("lump")
    memo = Memo() if remember else Memo(size=0)
    return ProblemEvaluator(shape, problem, voronoi(shape, 3), memo=memo)


def _candidates(count: int) -> FloatArray:
    """(count, 12) float: vectors of three centres on the lump."""
    shape = specimen("lump")
    return vectors_of(voronoi(shape, 3), shape, count=count, seed=1)


def _one_by_one(evaluator: ProblemEvaluator, vectors: FloatArray) -> list[Cost]:
    """Costs of vectors, evaluated one after the other.

    Raises
    ------
    Skip
        The objective fails on one of them; other checks say how.
    """
    try:
        return [evaluator.evaluate(vector).cost for vector in vectors]
    except MosegError as error:
        raise Skip(f"it cannot be evaluated: {error}") from error


@check(
    "objective-memo-equals-fresh",
    kinds=["objective"],
    why="a value that was remembered must be the one that would be computed",
)
def memo_equals_fresh(subject: Subject) -> None:
    """Asked again, the value is the one of the first time, remembered or not."""
    vectors = np.tile(_candidates(3), (2, 1))
    fresh = _one_by_one(_evaluator(subject, remember=False), vectors)
    remembered = _one_by_one(_evaluator(subject, remember=True), vectors)
    _must_equal(fresh, remembered, "twice, with values remembered and without")


@check(
    "objective-batch-equals-loop",
    kinds=["objective"],
    why="optimizers ask for many candidates at a time, and must get what they get one by one",
)
def batch_equals_loop(subject: Subject) -> None:
    """Evaluated as a batch, candidates cost the same; the best is the best."""
    vectors = _candidates(8)
    alone = [_one_by_one(_evaluator(subject, remember=True), v[None])[0] for v in vectors]
    evaluator = _evaluator(subject, remember=True)
    together = evaluator.costs(Batch(vectors=np.concatenate([vectors, vectors[:3]])))
    _must_equal([*alone, *alone[:3]], together, "one by one, and as a batch")
    hurried = evaluator.costs(Batch(vectors=vectors, best_only=True))
    _must_equal([min(alone)], [min(hurried)], "one by one, and as a batch of which the best counts")


def _must_equal(first: list[Cost], second: list[Cost], how: str) -> None:
    for k, (a, b) in enumerate(zip(first, second, strict=True)):
        if a.empty != b.empty or not same(a.value, b.value, tolerance=1e-9):
            raise ContractFailure(
                did=f"segmentations of the lump were evaluated {how} (candidate {k})",
                got=f"{a.value} and then {b.value}",
                expected="the same",
                fix="let the value depend on the parts and the parameters alone: count no calls,"
                " keep nothing from one to the next",
            )
