"""How polygons look: shared values, runs of materials, and which meshes keep them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from moseg_core.shape.appearance import Appearance, CornerValues, material_runs
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.volume.capped import with_caps

LOOKS = Appearance(
    texture=CornerValues(values=np.array([[0.0, 1.0], [0.5, 0.5]]), corners=np.array([0, 1, -1])),
    materials=("skin",),
    polygon_materials=np.array([0]),
)


def test_arrays_are_shared_and_so_read_only():
    assert LOOKS.texture is not None
    assert LOOKS.polygon_materials is not None
    for array in (LOOKS.texture.values, LOOKS.texture.corners, LOOKS.polygon_materials):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_a_shape_keeps_it_as_long_as_its_polygons_are_the_same():
    mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    shape = Shape.from_polygon_mesh(replace(mesh, appearance=LOOKS))
    moved = shape.deformed(2.0 * mesh.vertices, space="twice")
    for kept in (shape, shape.with_weld(0.0), shape.with_adjacency("none"), moved):
        assert kept.geometry.appearance is LOOKS
    # Of other polygons it would say something wrong.
    assert with_caps(shape.geometry).appearance is None


@pytest.mark.parametrize(
    ("stated", "names", "materials"),
    [
        ([], (), None),
        ([(0, "")], (), None),
        ([(0, "a"), (0, "b")], ("b",), [0, 0, 0]),
        ([(1, "a"), (2, "")], ("a",), [-1, 0, -1]),
        ([(0, "b"), (1, "a"), (2, "b"), (3, "c")], ("b", "a"), [0, 1, 0]),
    ],
)
def test_runs_of_materials(stated, names, materials):
    found, numbers = material_runs(stated, 3)
    assert found == names
    assert (None if numbers is None else numbers.tolist()) == materials
