"""Fields that are broken in one way each."""

from __future__ import annotations

from weakref import WeakKeyDictionary

import numpy as np

from moseg_core.components.discovery.specs import FieldSpec

_NAMES = {
    "field-has-defaults": "some_times_as_high",
    "field-returns": "steep",
    "field-per-element": "of_vertices",
    "field-finite": "divides_by_the_area",
    "field-same-again": "gets_tired",
    "field-keeps-shapes-apart": "goes_by_the_name",
    "field-rigid": "height",
    "field-scale": "size",
    "field-reflection": "to_one_side",
    "field-order": "place_in_the_file",
    "field-tessellation": "part_of_the_area",
}

_DECLARED = {
    "field-per-element": {"requires": ("surface",)},
    "field-rigid": {"invariant_to": ("rigid",)},
    "field-scale": {"invariant_to": ("scale",)},
    "field-reflection": {"invariant_to": ("reflection",)},
    "field-order": {"invariant_to": ("order",)},
    "field-tessellation": {"invariant_to": ("tessellation",)},
}

BROKEN = {
    id: FieldSpec(
        name="broken", target=f"tests.testing.broken.fields:{name}", **_DECLARED.get(id, {})
    )
    for id, name in _NAMES.items()
}


def some_times_as_high(shape, *, factor: float):
    """Nobody says how many times."""
    return factor * shape.points[:, 2]


def steep(shape):
    """A cloud has no triangles, and it did not ask for any."""
    corners = shape.geometry.vertices[shape.geometry.triangles]
    top = np.maximum.reduceat(corners[:, :, 2].max(axis=1), [0])
    return top - shape.points[:, 2]


def of_vertices(shape):
    """There are not as many vertices as elements."""
    return shape.geometry.vertices[:, 2]


def divides_by_the_area(shape):
    """Some elements have none."""
    with np.errstate(divide="ignore"):
        return 1.0 / shape.areas


calls: WeakKeyDictionary = WeakKeyDictionary()


def gets_tired(shape):
    """The second time that it is asked of a shape it says less."""
    calls[shape] = calls.get(shape, 0) + 1
    return shape.points[:, 2] / calls[shape]


cache: dict = {}


def goes_by_the_name(shape):
    """It remembers values under the name of the shape, which several have."""
    key = shape.name, shape.n_elements
    if key not in cache:
        cache[key] = np.array(shape.points[:, 2])
    return cache[key]


def height(shape):
    """Along the file's third axis."""
    return shape.points[:, 2]


def size(shape):
    """How large an element is, in the user's units."""
    return shape.areas


def to_one_side(shape):
    """On which side of the middle, along the file's first axis."""
    return shape.points[:, 0] - shape.points[:, 0].mean()


def place_in_the_file(shape):
    """How far down in the file."""
    return np.arange(shape.n_elements) / shape.n_elements


def part_of_the_area(shape):
    """How much of the whole an element is, which is less where it is cut finer."""
    return shape.areas / shape.area
