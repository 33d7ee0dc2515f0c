"""Whether elements have an area, and vertices that are so far out that others are lost."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.errors import ShapeError
from moseg_core.shape.shape import Shape
from tests import shapes

TWO = [(0, 1, 2), (3, 4, 5)]


def apart(distance):
    triangle = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    return np.concatenate([triangle, triangle + np.array([distance, 0, 0])])


@pytest.mark.parametrize("distance", [10.0, 1e6, 1e12])
def test_triangles_far_apart_have_the_areas_that_they_have(distance):
    shape = Shape.from_mesh(apart(distance), TWO)
    assert shape.areas == pytest.approx([0.5, 0.5], rel=1e-3)
    assert not any("area" in note for note in shape.notes)


def test_spheres_far_apart_hang_together_each():
    ball = np.asarray(shapes.sphere(1)[0])
    both = shapes.joined(shapes.sphere(1), shapes.sphere(1))
    points = np.concatenate([ball, ball + np.array([1e11, 0, 0])])
    shape = Shape.from_mesh(points, both[1])
    assert shape.adjacency is not None
    assert shape.adjacency.components()[0] == 2


def test_a_needle_has_no_area_however_large_it_is():
    shape = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9e5, 0, 0], [1e6, 0, 0]],
                            [(0, 1, 2), (0, 3, 4)])  # fmt: skip
    assert "1 faces have no area; they take part and carry no weight" in shape.notes


def test_the_vertex_that_is_far_out_is_named():
    points, faces = shapes.sphere(1)
    points = np.array(points)
    points[7] = [0, -1e19, 0]
    with pytest.raises(ShapeError, match=r"vertex 7, at \[0.0, -1e\+19, 0.0\], is 1e\+19 away"):
        Shape.from_mesh(points, faces)
    with pytest.raises(ShapeError, match="point 7"):
        Shape.from_points(points)
