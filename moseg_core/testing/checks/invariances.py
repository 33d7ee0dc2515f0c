"""What objectives promise to leave alone: motions, size, reflection, order, tessellation, labels.

Only what an objective declares is checked, on the lump of the zoo, which is in generic position. A
cube's principal axes are arbitrary, and so is what hangs on them; on the lump they are apart, and
a value that changes under a rotation changes for a reason.

An objective that declares an invariance it does not have misleads users, who move and scale their
shapes freely, and tests that compare one shape with another.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from moseg_core.components.discovery.specs import Invariance
from moseg_core.components.protocols import Objective
from moseg_core.components.real_number import real_number
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures import shapes
from moseg_core.testing.fixtures.comparison import precision
from moseg_core.testing.fixtures.objective_values import (
    SLICED,
    most_of,
    segmented,
    value_of,
    values_on,
)
from moseg_core.testing.fixtures.trial import Trial
from moseg_core.types import IntArray

#: Relative difference that rounding explains, after a detour through square roots and axes.
_EXACT = 1e-6

#: Relative difference that another tessellation explains, for surfaces integrated by samples.
_SAMPLED = 0.05

_INSTEAD: dict[Invariance, str] = {
    "rigid": "use distances within the part and angles between axes, no coordinates",
    "scale": "divide by a size of the same dimension: part.area, part.shape.box_diagonal",
    "reflection": "use no signs of cross products and of coordinates",
    "order": "use no element or vertex for its number; sum over all of them",
    "tessellation": "weight elements by part.areas, and count nothing",
    "labels": "treat all parts alike: sum, or take the mean, over them",
}
"""How to get what was declared."""

Change = Callable[[Shape], tuple[Shape, IntArray | None]]
"""From a shape to another, and which element of the first each of its elements is of, if others."""


def moved(shape: Shape) -> tuple[Shape, None]:
    """Turned, and shifted to where coordinates have other signs."""
    return shapes.mapped(
        shape, shapes.rotation(3), (-40.0, 40.0, -40.0), name="the moved lump"
    ), None


def scaled(shape: Shape) -> tuple[Shape, None]:
    """7.3 times as large."""
    return shapes.mapped(shape, 7.3 * np.eye(3), name="the large lump"), None


def reflected(shape: Shape) -> tuple[Shape, None]:
    """Its mirror image, faces still oriented outward."""
    return shapes.mapped(shape, np.diag([-1.0, 1.0, 1.0]), name="the mirror image"), None


def retessellated(shape: Shape) -> tuple[Shape, IntArray]:
    """The same surface in three times as many triangles: each cut at a point inside of it."""
    vertices, faces = shape.geometry.vertices, shapes.faces_of(shape)
    share = np.random.default_rng(4).dirichlet([4.0, 4.0, 4.0], len(faces))
    inner = np.einsum("fk,fkd->fd", share, vertices[np.array(faces)])
    cut = [
        [a, b, len(vertices) + f]
        for f, (i, j, k) in enumerate(faces)
        for a, b in ((i, j), (j, k), (k, i))
    ]
    other = Shape.from_mesh(np.concatenate([vertices, inner]), cut, name="the lump, cut finer")
    return other, np.repeat(np.arange(len(faces)), 3)


def _must_hold(
    subject: Subject, invariance: Invariance, change: Change, did: str, tolerance: float = _EXACT
) -> None:
    """Complain where an objective that declares an invariance has other values after a change."""
    _declares(subject, invariance)
    shape, trial = shapes.lump(), Trial(subject=subject)
    other, source = change(shape)
    before = values_on(trial, shape, among=SLICED)
    after = values_on(trial, other, among=SLICED, labelled=shape, source=source)
    for title, value in before.items():
        _compare(subject, invariance, value, after.get(title), f"{did} ({title})", tolerance)


def _declares(subject: Subject, invariance: Invariance, arity: str = "") -> Objective:
    """The objective; the check is skipped where it does not declare the invariance."""
    target: Objective = subject.load()
    if arity and target.traits.arity != arity:
        raise Skip(f"it is {target.traits.arity}")
    if invariance not in target.traits.invariant_to:
        raise Skip(f"it does not declare that it is invariant to '{invariance}'")
    return target


def _compare(
    subject: Subject,
    invariance: Invariance,
    before: object,
    after: object,
    did: str,
    tolerance: float = _EXACT,
) -> None:
    """Complain where two values differ by more than a share of them, or of the range."""
    first, second = real_number(before), real_number(after)
    if first is None and second is None:
        return  # that is for another check to say
    if first is not None and second is not None:
        low, high = subject.load().traits.range
        size = max(abs(first), abs(second), 0.01 * min(1.0, high - low))
        tolerance = max(tolerance, precision(before), precision(after))
        if abs(first - second) <= tolerance * size or first == second:
            return
    raise ContractFailure(
        did=f"the lump was {did}",
        got=f"{before} before and {after} after",
        expected=f"the same within {tolerance:g} of it",
        fix=f"take '{invariance}' out of invariant_to, or {_INSTEAD[invariance]}",
    )


@check("objective-rigid", kinds=["objective"])
def _rigid(subject: Subject) -> None:
    """Shapes lie as they were scanned; turning one in its file must not change its parts."""
    _must_hold(subject, "rigid", moved, "turned and shifted")


@check("objective-scale", kinds=["objective"])
def _scale(subject: Subject) -> None:
    """Shapes come in millimetres and in metres, and an expression should suit both."""
    _must_hold(subject, "scale", scaled, "enlarged 7.3 times")


@check("objective-reflection", kinds=["objective"])
def _reflection(subject: Subject) -> None:
    """A left and a right hand have the same parts."""
    _must_hold(subject, "reflection", reflected, "reflected")


@check("objective-order", kinds=["objective"])
def _order(subject: Subject) -> None:
    """The order of faces in a file means nothing, and programs change it when they save."""
    _must_hold(subject, "order", shapes.reordered, "given with vertices and faces reordered")


@check("objective-tessellation", kinds=["objective"])
def _tessellation(subject: Subject) -> None:
    """One surface can be cut into triangles in many ways, and users simplify and refine it."""
    _must_hold(subject, "tessellation", retessellated, "cut into other triangles", _SAMPLED)


@check("objective-symmetric", kinds=["objective"])
def _symmetric(subject: Subject) -> None:
    """Who reads 'alike(a, b)' takes it for 'alike(b, a)'; so does the labeler."""
    target = _declares(subject, "labels", "nary")
    shape = shapes.lump()
    for title, labels in shapes.slicings(shape).items():
        parts = segmented(subject, shape, labels).parts
        count = most_of(target, len(parts))
        if count < max(2, target.traits.least):
            continue
        for chosen in (parts[:count], parts[len(parts) - count :]):
            before, after = value_of(subject, chosen), value_of(subject, chosen[::-1])
            did = f"cut into parts, which were then given in the opposite order ({title})"
            _compare(subject, "labels", before, after, did)


@check("objective-label-order", kinds=["objective"])
def _label_order(subject: Subject) -> None:
    """What the whole costs should not depend on which part is called first."""
    _declares(subject, "labels", "global")
    shape = shapes.lump()
    for title, labels in shapes.slicings(shape).items():
        whole = segmented(subject, shape, labels)
        exchanged = whole.permuted(np.arange(len(whole.parts))[::-1])
        before, after = value_of(subject, whole), value_of(subject, exchanged)
        did = f"cut into parts, whose labels were then exchanged ({title})"
        _compare(subject, "labels", before, after, did)
