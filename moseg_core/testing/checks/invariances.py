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

from moseg_core.components.objectives import Invariance, Traits
from moseg_core.components.protocols import Objective
from moseg_core.shape.shape import Shape
from moseg_core.testing.check import ContractFailure, Skip, Subject, check
from moseg_core.testing.fixtures.drivers import segmented, value_of, values_on
from moseg_core.testing.fixtures.shapes import Labelling, faces_of, labellings, rotation, specimen
from moseg_core.testing.fixtures.trial import Raised, Result, declared, required_values
from moseg_core.types import FloatArray, Int32Array

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

Change = Callable[[Shape, Int32Array], tuple[Shape, Int32Array]]
"""From a shape and labels to another shape with labels."""


def moved(shape: Shape, labels: Int32Array) -> tuple[Shape, Int32Array]:
    """Turned and shifted."""
    return _with_vertices(shape, shape.geometry.vertices @ rotation(3).T + [5.0, -2.0, 1.0], labels)


def scaled(shape: Shape, labels: Int32Array) -> tuple[Shape, Int32Array]:
    """7.3 times as large."""
    return _with_vertices(shape, 7.3 * shape.geometry.vertices, labels)


def reflected(shape: Shape, labels: Int32Array) -> tuple[Shape, Int32Array]:
    """Its mirror image, faces still oriented outward."""
    faces = [face[::-1] for face in faces_of(shape)]
    vertices = shape.geometry.vertices * [-1.0, 1.0, 1.0]
    return Shape.from_mesh(vertices, faces, name="the mirror image"), labels


def reordered(shape: Shape, labels: Int32Array) -> tuple[Shape, Int32Array]:
    """Vertices, faces and the corners within each face in another order."""
    rng = np.random.default_rng(2)
    vertices = shape.geometry.vertices
    places = rng.permutation(len(vertices))  # vertex v goes to places[v]
    shuffled = np.empty_like(vertices)
    shuffled[places] = vertices
    order = rng.permutation(shape.n_elements)
    faces = faces_of(shape)
    renamed = [np.roll(places[faces[f]], int(rng.integers(3))).tolist() for f in order]
    return Shape.from_mesh(shuffled, renamed, name="the reordered lump"), labels[order]


def retessellated(shape: Shape, labels: Int32Array) -> tuple[Shape, Int32Array]:
    """The same surface in three times as many triangles: each cut at a point inside of it."""
    vertices, faces = shape.geometry.vertices, faces_of(shape)
    share = np.random.default_rng(4).dirichlet([4.0, 4.0, 4.0], len(faces))
    inner = np.einsum("fk,fkd->fd", share, vertices[np.array(faces)])
    cut = [
        [a, b, len(vertices) + f]
        for f, (i, j, k) in enumerate(faces)
        for a, b in ((i, j), (j, k), (k, i))
    ]
    whole = np.concatenate([vertices, inner])
    return Shape.from_mesh(whole, cut, name="the lump in other triangles"), np.repeat(labels, 3)


def _with_vertices(
    shape: Shape, vertices: FloatArray, labels: Int32Array
) -> tuple[Shape, Int32Array]:
    return Shape.from_mesh(vertices, faces_of(shape), name="the changed lump"), labels


def _values(subject: Subject, change: Change | None = None) -> Result:
    """The values of an objective on the lump, in slices; after a change, if any."""
    target = subject.load()
    parameters = required_values(declared(subject))
    lump = specimen("lump")
    found: Result = {}
    for labelling in labellings(lump):
        if labelling.title == "scattered":
            continue
        shape, labels = (lump, labelling.labels)
        if change is not None:
            shape, labels = change(lump, labelling.labels)
        given = Labelling(title=labelling.title, labels=labels, n_parts=labelling.n_parts)
        segmentation = segmented(subject, shape, given)
        found |= values_on(target, segmentation, labelling.title, parameters)
    return found


def _must_hold(
    subject: Subject, invariance: Invariance, change: Change, did: str, tolerance: float
) -> None:
    traits: Traits = subject.load().traits
    if invariance not in traits.invariant_to:
        raise Skip(f"it does not declare that it is invariant to '{invariance}'")
    before, after = _values(subject), _values(subject, change)
    for title, value in before.items():
        _complain(title, value, after.get(title), traits, invariance, did, tolerance)


def _complain(
    title: str,
    before: object,
    after: object,
    traits: Traits,
    invariance: Invariance,
    did: str,
    tolerance: float,
) -> None:
    if isinstance(before, Raised) and isinstance(after, Raised):
        return  # that is for another check to say
    if isinstance(before, (int, float)) and isinstance(after, (int, float)):
        low, high = traits.range
        span = min(1.0, high - low)
        size = max(abs(before), abs(after), 0.01 * span)
        if abs(before - after) <= tolerance * size or before == after:
            return
    raise ContractFailure(
        did=f"the lump was {did} ({title})",
        got=f"{before} before and {after} after",
        expected=f"the same within {tolerance:g} of it",
        fix=f"take '{invariance}' out of invariant_to, or {_INSTEAD[invariance]}",
    )


@check(
    "objective-rigid",
    kinds=["objective"],
    why="shapes lie as they were scanned; turning one in its file must not change its parts",
)
def rigid(subject: Subject) -> None:
    """Turned and shifted, the value stays."""
    _must_hold(subject, "rigid", moved, "turned and shifted", _EXACT)


@check(
    "objective-scale",
    kinds=["objective"],
    why="shapes come in millimetres and in metres, and an expression should suit both",
)
def scale(subject: Subject) -> None:
    """Enlarged, the value stays."""
    _must_hold(subject, "scale", scaled, "enlarged 7.3 times", _EXACT)


@check(
    "objective-reflection",
    kinds=["objective"],
    why="a left and a right hand have the same parts",
)
def reflection(subject: Subject) -> None:
    """Reflected, the value stays."""
    _must_hold(subject, "reflection", reflected, "reflected", _EXACT)


@check(
    "objective-order",
    kinds=["objective"],
    why="the order of faces in a file means nothing, and programs change it when they save",
)
def order(subject: Subject) -> None:
    """With vertices and faces in another order, the value stays."""
    _must_hold(subject, "order", reordered, "given with vertices and faces reordered", _EXACT)


@check(
    "objective-tessellation",
    kinds=["objective"],
    why="one surface can be cut into triangles in many ways, and users simplify and refine it",
)
def tessellation(subject: Subject) -> None:
    """With the surface in other triangles, the value stays within a tolerance."""
    _must_hold(subject, "tessellation", retessellated, "cut into other triangles", _SAMPLED)


@check(
    "objective-symmetric",
    kinds=["objective"],
    why="who reads 'alike(a, b)' takes it for 'alike(b, a)'; so does the labeler",
)
def symmetric(subject: Subject) -> None:
    """Several parts may come in any order, where the objective declares it."""
    target = _declares_labels(subject, "nary")
    parameters = required_values(declared(subject))
    lump = specimen("lump")
    for labelling in labellings(lump):
        parts = segmented(subject, lump, labelling).parts
        most = len(parts) if target.traits.most is None else target.traits.most
        count = min(most, len(parts))
        if count < max(2, target.traits.least):
            continue
        for chosen in (parts[:count], parts[len(parts) - count :]):
            before, after = (
                value_of(target, given, parameters) for given in (chosen, chosen[::-1])
            )
            _complain(labelling.title, before, after, target.traits, "labels", _SWAPPED, _EXACT)


_SWAPPED = "cut into parts, which were then given in the opposite order"


@check(
    "objective-label-order",
    kinds=["objective"],
    why="what the whole costs should not depend on which part is called first",
)
def label_order(subject: Subject) -> None:
    """The labels of the whole may be exchanged, where the objective declares it."""
    target = _declares_labels(subject, "global")
    parameters = required_values(declared(subject))
    lump = specimen("lump")
    for labelling in labellings(lump):
        segmentation = segmented(subject, lump, labelling)
        backwards = np.arange(labelling.n_parts)[::-1]
        before, after = (
            value_of(target, given, parameters)
            for given in (segmentation, segmentation.permuted(backwards))
        )
        did = "cut into parts, whose labels were then exchanged"
        _complain(labelling.title, before, after, target.traits, "labels", did, _EXACT)


def _declares_labels(subject: Subject, arity: str) -> Objective:
    target: Objective = subject.load()
    if target.traits.arity != arity:
        raise Skip(f"it is {target.traits.arity}")
    if "labels" not in target.traits.invariant_to:
        raise Skip("it does not declare that it is invariant to 'labels'")
    return target
