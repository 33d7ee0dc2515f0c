"""What objectives and callers receive is shared, so none of it can be changed by them."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.part import Part
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import PluginError
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))


@pytest.mark.parametrize(
    "name",
    ["scales", "axes", "centroid", "elements", "vertices", "triangles"],
)
def test_arrays_of_a_part(name):
    part = Segmentation.from_labels(SHAPE, np.zeros(SHAPE.n_elements, int), 1).parts[0]
    with pytest.raises(ValueError, match="read-only"):
        getattr(part, name)[0] = 0


def test_arrays_of_a_shape_and_of_a_result():
    result = segment(SHAPE, Problem(["stem", "bar"], "narrow(stem)"))
    geometry = SHAPE.geometry
    for array in (SHAPE.points, SHAPE.areas, SHAPE.unit_points, geometry.vertices, result.labels):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_an_objective_that_tries_is_named_and_the_others_are_unharmed():
    def evil(part: Part) -> float:
        scales = part.scales
        scales /= scales[0]
        return float(scales[1])

    problem = Problem(["a"], "evil(a)", objectives={"evil": evil})
    with pytest.raises(PluginError, match=r"objective 'python:evil' .* read-only"):
        problem.evaluate(SHAPE, np.zeros(SHAPE.n_elements, int))


def test_the_callers_labels_may_change_afterwards():
    labels = np.zeros(SHAPE.n_elements, np.int32)
    segmentation = Segmentation.from_labels(SHAPE, labels, 2)
    labels[:] = 1
    assert segmentation.parts[0].n_elements == len(segmentation.parts[0].elements) > 0


def test_the_callers_vertices_and_faces_may_change_afterwards():
    vertices, faces = (np.array(x) for x in shapes.cube())
    shape = Shape.from_mesh(vertices, faces)
    vertices *= 3
    faces[:] = 0
    assert shape.volume == pytest.approx(1.0)
    assert shape.geometry.corners.max() == 7
