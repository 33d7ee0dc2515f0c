"""Parts as shapes: what they keep of the whole, and what they measure anew."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.errors import ShapeError
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from tests.shapes import bent_capsule, box, cube_without_lid, disc, joined, tee, two_boxes

TEE = Shape.from_mesh(*tee(6, 5), name="tee")
STEM = np.flatnonzero(TEE.points[:, 2] < 6)


def test_elements_keep_their_order_and_measures():
    part = subshape(TEE, STEM, name="tee/stem")
    assert (part.name, part.n_elements) == ("tee/stem", len(STEM))
    np.testing.assert_allclose(part.points, TEE.points[STEM], atol=1e-12)
    np.testing.assert_allclose(part.areas, TEE.areas[STEM])
    assert part.area == pytest.approx(TEE.areas[STEM].sum())
    assert part.geometry.vertices.max(axis=0).tolist() == [3, 1, 6]  # only what is used


def test_polygons_are_cut_into_the_same_triangles():
    shape = Shape.from_mesh(*bent_capsule())
    some = np.arange(3, shape.n_elements, 2)
    part = subshape(shape, some)
    whole = shape.geometry
    kept = np.isin(whole.triangle_polygon, some)
    np.testing.assert_array_equal(
        part.geometry.vertices[part.geometry.triangles], whole.vertices[whole.triangles[kept]]
    )
    np.testing.assert_array_equal(
        some[part.geometry.triangle_polygon], whole.triangle_polygon[kept]
    )


def test_neighbours_are_those_within_the_part():
    part = subshape(TEE, STEM)
    for k, element in enumerate(STEM):
        near = set(TEE.adjacency.neighbors(element).tolist()) & set(STEM.tolist())
        assert set(STEM[part.adjacency.neighbors(k)].tolist()) == near


@pytest.mark.parametrize("which", ["knn", "none"])
def test_neighbours_that_the_user_asked_for_are_kept(which):
    corners = TEE.geometry.vertices[TEE.geometry.corners]
    middle = np.repeat(TEE.points, 4, axis=0)
    loose = Shape.from_mesh(
        middle + 0.9 * (corners - middle), np.arange(len(corners)).reshape(-1, 4)
    ).with_adjacency(which)
    part = subshape(loose, STEM)
    if which == "none":
        assert part.adjacency is None
    else:
        assert part.adjacency.components()[0] == 1
        matrix = loose.adjacency.matrix[STEM][:, STEM]
        assert (part.adjacency.matrix != matrix).nnz == 0


def test_volumes_of_the_two_sides_of_a_plane_cut_add_up():
    rest = np.setdiff1d(np.arange(TEE.n_elements), STEM)
    stem, bar = subshape(TEE, STEM), subshape(TEE, rest)
    assert stem.volume == pytest.approx(6.0, rel=1e-12)
    assert bar.volume == pytest.approx(5.0, rel=1e-12)
    assert stem.notes == bar.notes == ()


def test_all_elements_are_the_whole():
    again = subshape(TEE, np.arange(TEE.n_elements))
    assert again.volume == TEE.volume
    assert again.fingerprint == TEE.fingerprint


def test_a_piece_that_is_closed_by_itself():
    shape = Shape.from_mesh(*two_boxes())
    left = subshape(shape, np.flatnonzero(shape.points[:, 0] < 2.5))
    assert left.volume == pytest.approx(2.0, rel=1e-12)


def test_parts_of_an_open_surface_have_a_volume_where_faces_are_oriented_alike():
    vertices, faces = cube_without_lid()
    assert subshape(Shape.from_mesh(vertices, faces), np.arange(5)).volume == pytest.approx(1.0)
    twisted = Shape.from_mesh(vertices, [faces[0][::-1], *faces[1:]])
    part = subshape(twisted, np.arange(5))
    assert part.volume is None
    assert part.volume_reason


def test_a_flat_part_has_no_volume():
    shape = Shape.from_mesh(*box())
    part = subshape(shape, np.array([0]))
    assert part.volume is None
    assert "flat" in part.volume_reason
    assert subshape(Shape.from_mesh(*disc()), np.arange(3)).volume is None


def test_a_deformed_part_keeps_its_volume():
    bowl = subshape(Shape.from_mesh(*box()), np.arange(5))
    bent = bowl.deformed(2.0 * bowl.geometry.vertices, space="twice")
    assert bent.volume == pytest.approx(8.0 * bowl.volume, rel=1e-12)


def test_nothing_is_no_shape():
    with pytest.raises(ShapeError, match="'tee/x' has no elements"):
        subshape(TEE, np.array([], np.int64), name="tee/x")
    flat = joined(box(), ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [(0, 1, 2)]))
    with pytest.raises(ShapeError, match="degenerate"):
        subshape(Shape.from_mesh(*flat), np.array([6]))


def test_points_keep_their_areas_and_the_neighbours_within():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(200, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    cloud = Shape.from_points(points, normals=points, adjacency="knn", name="ball")
    some = np.flatnonzero(points[:, 2] > 0.2)
    part = subshape(cloud, some, name="ball/cap")
    np.testing.assert_array_equal(part.points, cloud.points[some])
    np.testing.assert_array_equal(part.areas, cloud.areas[some])
    np.testing.assert_array_equal(part.geometry.normals, points[some])
    assert part.volume is None
    for k, element in enumerate(some):
        expected = [
            j for j, other in enumerate(some) if other in cloud.adjacency.neighbors(element)
        ]
        assert part.adjacency.neighbors(k).tolist() == expected
    assert subshape(cloud.with_adjacency("none"), some).adjacency is None


def test_cells_of_a_solid_are_a_solid():
    occupied = np.ones((4, 3, 2), bool)
    solid = Shape.from_voxels(occupied, pitch=0.5, origin=(1, 2, 3), name="block")
    some = np.flatnonzero(solid.points[:, 0] < 2.0)
    part = subshape(solid, some, name="block/left")
    np.testing.assert_allclose(part.points, solid.points[some])
    assert part.volume == pytest.approx(len(some) * 0.5**3)
    with pytest.raises(ShapeError, match="the surface of a voxel grid; read it as a solid"):
        subshape(solid.with_elements("surface"), np.arange(4))
