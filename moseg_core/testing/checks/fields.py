"""What fields promise: a finite number for every element of every shape that they do not refuse.

A field is computed once, on the shape as the user gave it, and everything else follows from that
(:mod:`moseg_core.components.field`): the values on coarse and embedded versions, means of parts and
along boundaries. So what is wrong with it is wrong in every term that reads it. A shape is refused
before the search by what the field's spec requires; on all others the field has to answer, open
surfaces, clouds and single faces among them. That it does the same in every process, and changes
nothing, is checked for all kinds in :mod:`moseg_core.testing.checks.repeats`.

Of what a field may promise to leave alone only what it declares is checked, on the lump of the zoo,
by the changes that objectives are tried with (:mod:`moseg_core.testing.checks.invariances`). A
value belongs to its element and moves with it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from moseg_core.components.discovery.specs import Invariance
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.checks.invariances import Change, moved, reflected, retessellated, scaled
from moseg_core.testing.fixtures.comparison import (
    Answers,
    Raised,
    as_numbers,
    expect_no_error,
    expect_same,
)
from moseg_core.testing.fixtures.field_values import field_on, spec_of
from moseg_core.testing.fixtures.shapes import ZOO, lump, mapped, reordered, specimen
from moseg_core.testing.fixtures.trial import Trial, declared
from moseg_core.types import FloatArray, IntArray

#: Difference that rounding explains, after rays and paths; a share of the greatest value.
_EXACT = 1e-6

#: Difference that another tessellation explains, in the mean over the surface; a share likewise.
_SAMPLED = 0.05

_INSTEAD: dict[Invariance, str] = {
    "rigid": "use distances and angles within the shape, no coordinates",
    "scale": "divide by a size of the same dimension, such as shape.box_diagonal",
    "reflection": "use no signs of cross products and of coordinates",
    "order": "use no element or vertex for its number",
    "tessellation": "weight elements by shape.areas and links by their lengths, and count nothing",
}
"""How to get what was declared."""


def _zoo(subject: Subject) -> Answers:
    """Values on every shape of the zoo that has what the field requires."""

    def compute() -> Answers:
        trial = Trial(subject=subject)
        answers = {name: field_on(trial, specimen(name).input) for name in ZOO}
        return {name: answer for name, answer in answers.items() if answer is not None}

    found: Answers = subject.keep("zoo", compute)
    return found


@check("field-has-defaults", kinds=["field"])
def _has_defaults(subject: Subject) -> None:
    """Fields that objectives declare are computed before the search, by their names alone."""
    needed = [parameter.name for parameter in declared(subject) if parameter.required]
    if needed:
        raise ContractFailure(
            did="its parameters were looked at",
            got=f"'{needed[0]}', which must be given",
            expected="a default for every parameter",
            fix="give it a default that suits most shapes",
        )


@check("field-returns", kinds=["field"])
def _returns(subject: Subject) -> None:
    """A shape that has what a field requires is not refused, and must not end the search."""
    requires = ", ".join(spec_of(subject).requires) or "nothing"
    expect_no_error(
        _zoo(subject),
        did=f"it was computed on a shape of the zoo that has what it requires ({requires})",
        fix="handle the case; where it cannot be handled, say in requires=(...) of the FieldSpec"
        " what a shape must have",
    )


@check("field-per-element", kinds=["field"])
def _per_element(subject: Subject) -> None:
    """Values are read by the numbers of the elements, which are not those of the vertices."""
    for name, values in _zoo(subject).items():
        if isinstance(values, Raised):
            continue
        expected, numbers = specimen(name).input.n_elements, as_numbers(values)
        if numbers.shape != (expected,):
            raise ContractFailure(
                did=f"it was computed on '{name}', of {expected} elements",
                got=f"{_said(values)}",
                expected=f"an array of numbers of the shape ({expected},)",
                fix="return a number for each element, in the order of shape.points; from vertices"
                " take the mean over the corners of each element",
            )


def _said(values: Any) -> str:
    shape = getattr(values, "shape", None)
    return f"a {type(values).__name__}" + ("" if shape is None else f" of the shape {shape}")


@check("field-finite", kinds=["field"])
def _finite(subject: Subject) -> None:
    """The mean of a part with one value that is no number is no number either."""
    for name, values in _zoo(subject).items():
        wrong = int((~np.isfinite(as_numbers(values))).sum()) if not _raised(values) else 0
        if wrong:
            raise ContractFailure(
                did=f"it was computed on '{name}'",
                got=f"{wrong} values that are not finite",
                expected="finite numbers only",
                fix="look at elements without area, at rays that meet nothing and at elements that"
                " no path reaches, and give them the value that suits them best",
            )


@check("field-same-again", kinds=["field"])
def _same_again(subject: Subject) -> None:
    """Processes may each compute a field anew, and cost the same segmentation alike."""
    trial, shape = Trial(subject=subject), lump()
    first, second = (np.copy(field_on(trial, shape)) for _ in range(2))
    expect_same(
        {shape.name: first},
        {shape.name: second},
        did="it was computed twice on the same shape",
        fix="let it depend on the shape and the parameters alone: count no calls, keep nothing"
        " from one to the next; use np.random.default_rng(0) where it draws numbers",
    )


@check("field-keeps-shapes-apart", kinds=["field"])
def _keeps_shapes_apart(subject: Subject) -> None:
    """A cache of one's own that confuses two shapes gives the second the values of the first."""
    trial = Trial(subject=subject)
    second = mapped(lump(), np.diag([1.7, 0.8, 1.2]), name="lump")
    unseen = replace(second, name="a shape never seen before")
    _, after, fresh = ({"values": field_on(trial, shape)} for shape in (lump(), second, unseen))
    expect_same(
        fresh,
        after,
        did="it was computed on a shape, under a new name and under that of another shape",
        fix="keep no values of your own: the core keeps those of a field with the shape",
    )


# -- What is left alone -----------------------------------------------------------------------


def _must_hold(
    subject: Subject, invariance: Invariance, change: Change, did: str, *, exact: bool = True
) -> None:
    """Complain where a field that declares an invariance has other values after a change."""
    if invariance not in spec_of(subject).invariant_to:
        raise Skip(f"it does not declare that it is invariant to '{invariance}'")
    shape, trial = lump(), Trial(subject=subject)
    other, source = change(shape)
    before, after = (_numbers(field_on(trial, seen), seen) for seen in (shape, other))
    if not exact:
        assert source is not None  # a finer tessellation says what it was cut from
        after = _means(after, other.areas, source)
    elif source is not None:
        before = before[source]
    greatest = max(float(np.abs(before).max()), float(np.abs(after).max()))
    apart = np.abs(before - after)
    worst = float(apart.max() if exact else (apart @ shape.areas) / shape.area)
    tolerance = _EXACT if exact else _SAMPLED
    if worst > tolerance * greatest:
        where = "at the worst element" if exact else "in the mean over the surface"
        raise ContractFailure(
            did=f"the lump was {did}",
            got=f"values that differ by {worst:.3g} {where}, where the greatest is {greatest:.3g}",
            expected=f"the same within {tolerance:g} of the greatest",
            fix=f"take '{invariance}' out of invariant_to, or {_INSTEAD[invariance]}",
        )


def _numbers(values: Any, shape: Shape) -> FloatArray:
    """The values as an array.

    Raises
    ------
    Skip
        They are no numbers, one per element; other checks say so.
    """
    numbers = np.empty(0) if _raised(values) else as_numbers(values)
    if numbers.shape != (shape.n_elements,) or not np.isfinite(numbers).all():
        raise Skip("it has no value for each element")
    return numbers


def _means(values: FloatArray, areas: FloatArray, source: IntArray) -> FloatArray:
    """Of each element that was cut up the mean over its pieces, by area."""
    means: FloatArray = np.bincount(source, areas * values) / np.bincount(source, areas)
    return means


def _raised(values: Any) -> bool:
    return isinstance(values, Raised)


@check("field-rigid", kinds=["field"])
def _rigid(subject: Subject) -> None:
    """Shapes lie as they were scanned; a part is as thick in its file as when it was turned."""
    _must_hold(subject, "rigid", moved, "turned and shifted")


@check("field-scale", kinds=["field"])
def _scale(subject: Subject) -> None:
    """Shapes come in millimetres and in metres, and what was learnt of one should suit both."""
    _must_hold(subject, "scale", scaled, "enlarged 7.3 times")


@check("field-reflection", kinds=["field"])
def _reflection(subject: Subject) -> None:
    """The left hand has its values where the right hand has them."""
    _must_hold(subject, "reflection", reflected, "reflected")


@check("field-order", kinds=["field"])
def _order(subject: Subject) -> None:
    """The order of faces in a file means nothing; values have to stay with their elements."""
    _must_hold(subject, "order", reordered, "given with vertices and faces reordered")


@check("field-tessellation", kinds=["field"])
def _tessellation(subject: Subject) -> None:
    """One surface can be cut into triangles in many ways, and users simplify and refine it."""
    _must_hold(subject, "tessellation", retessellated, "cut into other triangles", exact=False)
