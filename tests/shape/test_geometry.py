"""What every kind of geometry answers: positions of vertices, and what its elements are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.voxels import VoxelGrid
from tests import shapes

GRID = np.ones((3, 3, 3), bool)
KINDS = {
    "triangles": PolygonMesh.from_faces(*shapes.sphere(1)),
    "quads": PolygonMesh.from_faces(*shapes.cube()),
    "points": PointCloud.from_points(shapes.cube()[0]),
    "cells": VoxelGrid.from_occupied(GRID),
    "surface cells": VoxelGrid.from_occupied(GRID, elements="surface"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_elements_triangles_and_corners_belong_together(kind):
    geometry = KINDS[kind]
    assert geometry.offsets[0] == 0
    assert geometry.offsets[-1] == len(geometry.corners)
    assert len(geometry.triangle_polygon) == len(geometry.triangles)
    assert (np.diff(geometry.triangle_polygon) >= 0).all()
    for element in range(geometry.n_elements):
        first, last = geometry.offsets[element : element + 2]
        corners = set(geometry.corners[first:last].tolist())
        own = geometry.triangles[geometry.triangle_polygon == element]
        assert set(own.reshape(-1).tolist()) <= corners


def test_what_elements_are():
    assert [
        (kind, g.n_elements, g.noun, g.solid, g.is_triangular) for kind, g in KINDS.items()
    ] == [
        ("triangles", 80, "face", False, True),
        ("quads", 6, "face", False, False),
        ("points", 8, "point", False, False),
        ("cells", 27, "cell", True, False),
        ("surface cells", 26, "cell", False, False),
    ]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "name", ["vertices", "corners", "offsets", "triangles", "triangle_polygon"]
)
def test_arrays_are_read_only(kind, name):
    array = getattr(KINDS[kind], name)
    with pytest.raises(ValueError, match="read-only"):
        array[:] = 0


@given(st.lists(st.tuples(*[st.sampled_from([-0.0, 0.0, 1.0])] * 3), min_size=3, max_size=20))
@settings(deadline=None)
def test_equal_positions_have_equal_numbers(places):
    corners = np.arange(len(places))
    mesh = PolygonMesh(
        vertices=np.array(places),
        corners=corners,
        offsets=np.array([0, len(places)]),
        triangles=np.array([[0, 1, 2]]),
        triangle_polygon=np.array([0]),
    )
    numbers = mesh.merged.tolist()
    for a, first in enumerate(places):  # 0.0 == -0.0
        for b, second in enumerate(places):
            assert (numbers[a] == numbers[b]) == (first == second)
    assert set(numbers) == set(range(len(set(places))))


@pytest.mark.parametrize("kind", KINDS)
def test_vertices_of_some_elements(kind):
    geometry = KINDS[kind]
    elements = np.arange(0, geometry.n_elements, 3)
    own = {
        int(vertex)
        for element in elements
        for vertex in geometry.corners[geometry.offsets[element] : geometry.offsets[element + 1]]
    }
    assert set(np.flatnonzero(geometry.used_by(elements)).tolist()) == own
    assert np.concatenate([*geometry.corners_in_pieces()]).tolist() == geometry.corners.tolist()
    every = geometry.vertices[np.unique(geometry.corners)]
    np.testing.assert_array_equal(geometry.used_vertices, every)


@pytest.mark.parametrize("kind", KINDS)
def test_outer_corners_hold_those_farthest_out_of_each_group(kind):
    geometry = KINDS[kind]
    groups = np.arange(geometry.n_elements) % 3 - 1  # a third of them in no group
    owner, vertex = geometry.outer_corners(groups)
    assert set(owner.tolist()) == {0, 1}
    for group in (0, 1):
        few = geometry.vertices[np.unique(vertex[owner == group])]
        every = geometry.vertices[geometry.used_by(np.flatnonzero(groups == group))]
        assert {row.tobytes() for row in few} <= {row.tobytes() for row in every}
        for way in np.random.default_rng(0).normal(size=(50, 3)):
            assert (few @ way).max() == pytest.approx((every @ way).max(), rel=1e-12)
