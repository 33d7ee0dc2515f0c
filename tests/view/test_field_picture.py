"""The picture of a field: elements in the colours of their values, and a legend of them."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from moseg_core.errors import ShapeError, UsageError
from moseg_core.view.field_picture import render_field
from moseg_core.view.palette import linear_light
from moseg_core.view.ramp import ramp
from tests.view.test_picture import cone, hue

SIZE = (480, 240)


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def heights(mesh):
    return mesh.vertices[mesh.triangles].mean(axis=1)[:, 2]


def test_elements_have_the_colours_of_their_values():
    mesh = cone()
    step = (heights(mesh) > 1.3).astype(float)
    seen = pixels(render_field(mesh, step, size=SIZE))[10:170]
    lit = seen[(seen.sum(axis=2) < 700) & (seen.max(axis=2) > 60)]
    found = hue(lit)
    for color in (ramp()[0], ramp()[-1]):
        near = np.linalg.norm(found - hue(color), axis=1) < 0.05
        assert near.mean() > 0.2


def test_one_value_is_one_colour_without_lines_between_elements():
    mesh = cone()
    seen = pixels(render_field(mesh, np.full(mesh.n_elements, 3.0), size=SIZE))[10:170]
    inside = linear_light(seen.astype(np.uint8))[seen.sum(axis=2) < 700]
    middle = hue(ramp()[128])
    bright = inside[inside.sum(axis=1) > 0.1]
    directions = bright / np.linalg.norm(bright, axis=1, keepdims=True)
    assert (np.linalg.norm(directions - middle, axis=1) < 0.15).mean() > 0.9


def test_the_same_bytes_again_and_a_legend_with_the_mean():
    mesh = cone()
    values = heights(mesh)
    plain = render_field(mesh, values, size=SIZE)
    assert plain == render_field(mesh, values, size=SIZE)
    marked = pixels(render_field(mesh, values, mean=1.0, size=SIZE)) != pixels(plain)
    rows = np.flatnonzero(marked.any(axis=(1, 2)))
    assert rows.min() > 150  # nothing but the legend has changed


@pytest.mark.parametrize("values", [[1.0, 2.0], np.nan])
def test_values_that_are_none_are_refused(values):
    mesh = cone()
    given = np.full(mesh.n_elements, values) if np.isscalar(values) else values
    with pytest.raises(ShapeError, match="a finite number for each of"):
        render_field(mesh, given)


def test_a_size_that_cannot_be_drawn_is_refused():
    mesh = cone()
    with pytest.raises(UsageError, match="allowed are 240 x 160"):
        render_field(mesh, heights(mesh), size=(10, 10))
