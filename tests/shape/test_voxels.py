"""Voxel grids: cells, corners and exposed faces, against the surface made cube by cube."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import VoxelGrid
from tests import shapes

grids = arrays.arrays(bool, st.tuples(*[st.integers(1, 4)] * 3)).filter(np.any)


def quads(geometry):
    """The distinct pairs of triangles as sets of corner positions, each with its cell."""
    pairs = geometry.triangles.reshape(-1, 6)
    owners = geometry.triangle_polygon.reshape(-1, 2)
    assert (owners[:, 0] == owners[:, 1]).all()
    return {
        (tuple(geometry.cells[cell]), frozenset(map(tuple, geometry.vertices[pair].tolist())))
        for pair, cell in zip(pairs, owners[:, 0], strict=True)
    }


@given(occupied=grids)
def test_exposed_faces_are_those_of_a_solid_made_of_cubes(occupied):
    vertices, faces = shapes.solid(np.argwhere(occupied))
    expected = {frozenset(map(tuple, vertices[list(face)].tolist())) for face in faces}
    grid = VoxelGrid.from_occupied(occupied)
    found = quads(grid)
    assert {corners for _, corners in found} == expected
    assert len(grid.triangles) == 2 * len(faces)
    for cell, corners in found:  # each face is one of its own cell's
        low, high = np.min(list(corners), axis=0), np.max(list(corners), axis=0)
        assert (low >= cell).all()
        assert (high <= np.array(cell) + 1).all()


@given(occupied=grids)
def test_triangles_show_their_outer_side(occupied):
    grid = VoxelGrid.from_occupied(occupied)
    corners = grid.vertices[grid.triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(occupied.sum())
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = corners.mean(axis=1) - grid.centers[grid.triangle_polygon]
    assert ((normals * outward).sum(axis=1) > 0).all()
    assert (np.diff(grid.triangle_polygon) >= 0).all()


@given(occupied=grids)
def test_cells_are_in_c_order_and_have_their_eight_corners(occupied):
    grid = VoxelGrid.from_occupied(occupied, pitch=0.5, origin=(1, 2, 3))
    np.testing.assert_array_equal(grid.cells, np.argwhere(occupied))
    corners = grid.vertices[grid.corners].reshape(-1, 8, 3)
    np.testing.assert_allclose(corners.mean(axis=1), grid.centers)
    np.testing.assert_allclose(corners.min(axis=1), [1, 2, 3] + 0.5 * grid.cells)
    np.testing.assert_allclose(corners.max(axis=1), [1, 2, 3] + 0.5 * (grid.cells + 1))
    assert len(np.unique(grid.vertices, axis=0)) == len(grid.vertices)
    assert grid.volume == pytest.approx(occupied.sum() / 8)


@given(occupied=grids)
def test_a_surface_has_the_cells_with_an_exposed_face(occupied):
    solid = VoxelGrid.from_occupied(occupied)
    surface = VoxelGrid.from_occupied(occupied, elements="surface")
    shown = np.unique(solid.triangle_polygon)
    np.testing.assert_array_equal(surface.cells, solid.cells[shown])
    assert quads(surface) == quads(solid)
    assert surface.volume == solid.volume
    assert (solid.solid, surface.solid) == (True, False)


#: Cells that are no cubes: along the axes, in other directions, mirrored, oblique.
STEPS = {
    "sides": (0.5, 0.25, 3.0),
    "turned axes": [[0, 0, 2.0], [-0.5, 0, 0], [0, 1.5, 0]],
    "mirrored": [[-1.0, 0, 0], [0, 0.5, 0], [0, 0, 2.0]],
    "tilted": [[0.5, 0, 0], [0, 0.4, 0.3], [0, -1.8, 2.4]],
    "sheared": [[1.0, 0, 0], [0.2, 1.0, 0], [0.3, -0.1, 2.0]],
}


def as_rows(pitch):
    given = np.array(pitch, float)
    return np.diag(given) if given.ndim == 1 else given


@pytest.mark.parametrize("pitch", STEPS.values(), ids=STEPS)
@given(occupied=grids)
def test_cells_that_are_no_cubes_are_those_of_a_grid_of_cubes_in_other_places(pitch, occupied):
    steps, origin = as_rows(pitch), np.array([3.0, -1.0, 0.5])
    cubes = VoxelGrid.from_occupied(occupied)
    grid = VoxelGrid.from_occupied(occupied, pitch=pitch, origin=origin)
    np.testing.assert_array_equal(grid.cells, cubes.cells)
    np.testing.assert_allclose(grid.vertices, origin + cubes.vertices @ steps, atol=1e-12)
    np.testing.assert_allclose(grid.centers, origin + cubes.centers @ steps, atol=1e-12)
    np.testing.assert_allclose(grid.pitch, [np.linalg.norm(step) for step in steps])
    assert grid.volume == pytest.approx(occupied.sum() * abs(np.linalg.det(steps)))
    # Triangles show their outer side, also in a mirror image: the volume that they enclose.
    corners = grid.vertices[grid.triangles] - origin
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(grid.volume)


def test_the_sides_of_a_cell_have_the_areas_of_parallelograms():
    grid = VoxelGrid.from_occupied(np.ones((1, 1, 1), bool), pitch=(2.0, 3.0, 5.0))
    assert grid.side_areas.tolist() == [15.0, 10.0, 6.0]
    assert grid.cell_volume == 30.0
    oblique = VoxelGrid.from_occupied(np.ones((1, 1, 1), bool), pitch=STEPS["sheared"])
    a, b, c = as_rows(STEPS["sheared"])
    expected = [np.linalg.norm(np.cross(u, v)) for u, v in ((b, c), (c, a), (a, b))]
    np.testing.assert_allclose(oblique.side_areas, expected)


def test_what_a_file_says_of_a_grid_is_kept_with_it():
    shape = Shape.from_voxels(np.ones((2, 2, 2), bool), header={"space": "x"}, notes=["seen"])
    assert shape.with_elements("surface").geometry.header == {"space": "x"}
    assert "seen" in shape.notes
    assert shape.with_pitch(2.0).geometry.header == {}  # it is another grid now


def test_values_are_spread_over_the_grid():
    occupied = np.zeros((2, 3, 2), bool)
    occupied[1, 2, 0] = occupied[0, 1, 1] = True
    grid = VoxelGrid.from_occupied(occupied)
    spread = grid.spread(np.array([5, 6]), -1)
    assert spread[0, 1, 1] == 5
    assert spread[1, 2, 0] == 6
    assert (spread == -1).sum() == 10


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"occupied": np.ones((2, 2), bool)}, ShapeError, "array of bool, not of bool of shape"),
        ({"occupied": np.ones((2, 2, 2))}, ShapeError, "not of float64"),
        ({"occupied": np.zeros((2, 2, 2), bool)}, ShapeError, "none of the 8 cells"),
        ({"pitch": 0.0}, ShapeError, "positive pitch"),
        ({"pitch": np.nan}, ShapeError, "positive pitch"),
        ({"pitch": (0.5, 0.5)}, ShapeError, "one number or three"),
        ({"pitch": (0.5, 0.5, 0.0)}, ShapeError, "positive pitch"),
        ({"pitch": (0.5, 0.5, -1.0)}, ShapeError, "positive pitch"),
        ({"pitch": "wide"}, ShapeError, "positive pitch"),
        ({"pitch": [[1, 0, 0], [0, 1, 0], [1, 1, 0]]}, ShapeError, "positive pitch"),
        ({"origin": "here"}, ShapeError, "three coordinates"),
        ({"origin": (0, 0)}, ShapeError, "three coordinates"),
        ({"elements": "surfac"}, UsageError, "did you mean 'surface'"),
    ],
)
def test_malformed_grids_are_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        Shape.from_voxels(**{"occupied": np.ones((1, 1, 1), bool), **arguments})
