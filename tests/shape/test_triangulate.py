"""Cutting polygons: right number, right area, right side up, nothing covered twice."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.shape.mesh import PolygonMesh
from tests import shapes


def cut(points):
    """The triangles of a single polygon, as (T, 3) corner numbers."""
    mesh = PolygonMesh.from_faces(points, [list(range(len(points)))])
    return mesh.triangles


def vector_areas(points, triangles):
    a, b, c = (np.asarray(points, np.float64)[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def vector_area(points):
    """Area of the polygon times its unit normal, by the shoelace formula about its own middle."""
    points = points - points.mean(axis=0)
    return np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0) / 2


def assert_cuts_once(points, triangles):
    """The triangles lie in the polygon's plane, face its way, and add up to its area."""
    whole = vector_area(points)
    pieces = vector_areas(points, triangles)
    size = np.linalg.norm(whole)
    assert len(triangles) == len(points) - 2
    assert (pieces @ whole >= -1e-9 * size**2).all()
    assert np.linalg.norm(pieces, axis=1).sum() == pytest.approx(size, rel=1e-9)


def star(seed, corners):
    """A simple polygon around the origin with corners at random distances, in the xy-plane."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0, 2 * np.pi, corners))
    angle = 2 * np.pi * np.arange(corners) / corners if np.diff(angle).max() > 3 else angle
    radius = rng.uniform(0.1, 1.0, corners)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros(corners)])


def is_star(points):
    """Whether consecutive corners all turn around the origin the same way, by less than pi."""
    following = np.roll(points, -1, axis=0)
    return (np.cross(points, following)[:, 2] > 1e-3).all()


@given(seed=st.integers(0, 2**32), corners=st.integers(5, 14), turned=st.booleans())
@settings(max_examples=150, deadline=None)
def test_simple_polygons_in_any_plane_are_cut_into_pieces_that_do_not_overlap(
    seed, corners, turned
):
    points = star(seed, corners)
    if not is_star(points):
        points = star(seed, corners) * 0 + shapes.disc(corners)[0][1:]
    if turned:
        points = points[::-1]
    points = points @ shapes.rotation(seed).T
    assert_cuts_once(points, cut(points))


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("corners", [5, 8])
def test_planes_across_each_axis_keep_their_side(axis, side, corners):
    ring = shapes.disc(corners)[0][1:, :2][::side]
    points = np.roll(np.column_stack([ring, np.zeros(corners)]), axis + 1, axis=1)
    whole = vector_area(points)
    assert abs(whole[axis]) > 1
    assert_cuts_once(points, cut(points))


@pytest.mark.parametrize("shift", [1e3, 1e5, 5e6])
def test_a_polygon_far_from_the_origin_is_cut_as_one_nearby(shift):
    # Faces of a centimetre in the coordinates of a map, in metres.
    arrow = 0.01 * np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0.5, 0.25, 0], [0, 1, 0]])
    for seed in range(8):
        # Whole multiples of 2**-20, so that the shift rounds nothing.
        points = np.rint(2**20 * arrow @ shapes.rotation(seed).T) / 2**20
        there = points + np.rint(shift * shapes.rotation(seed)[0])
        assert ((there - there[0]) == (points - points[0])).all()
        assert cut(there).tolist() == cut(points).tolist()


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0], [4, 0], [4, 4], [2, 1]],  # a dart: only one diagonal lies inside
        [[4, 0], [4, 4], [2, 1], [0, 0]],
        [[2, 1], [0, 0], [4, 0], [4, 4]],
        [[4, 4], [2, 1], [0, 0], [4, 0]],
        [[0, 0], [3, 0], [3, 1], [0, 1]],
        [[0, 0], [1, 0], [3, 0], [1, 1]],  # a straight corner
    ],
)
def test_quads_are_cut_along_the_diagonal_inside(points):
    flat = np.column_stack([np.array(points, np.float64), np.zeros(4)])
    for seed in range(3):
        turned = flat @ shapes.rotation(seed).T
        assert_cuts_once(turned, cut(turned))


def test_a_bent_quad_does_not_fold():
    # Raising one corner of a square: both diagonals are fine, the first is taken.
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0]])
    assert cut(points).tolist() == [[0, 1, 2], [0, 2, 3]]
    # A dart whose tip is raised: only one diagonal keeps both halves facing alike.
    dart = np.array([[0.0, 0, 0], [4, 0, 0.1], [1, 1, 0], [0, 4, 0.1]])
    normals = vector_areas(dart, cut(dart))
    assert normals[0] @ normals[1] > 0


@pytest.mark.parametrize(
    "points",
    [
        # straight corners on every side
        [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]],
        [[0, 0], [1, 0], [2, 0], [3, 0], [0, 3]],
        # a comb
        [[0, 0], [7, 0], [7, 3], [6, 1], [5, 3], [4, 1], [3, 3], [2, 1], [1, 3]],
        # a spiral
        [[0, 0], [5, 0], [5, 5], [1, 5], [1, 2], [3, 2], [3, 3], [2, 3], [2, 4], [4, 4], [4, 1],
         [0, 1]],
        # a square with a square hole, joined by a bridge that is run through twice
        [[0, 0], [3, 0], [3, 3], [0, 3], [0, 0], [1, 1], [1, 2], [2, 2], [2, 1], [1, 1]],
        # a corner given twice
        [[0, 0], [2, 0], [2, 0], [2, 2], [0, 2]],
    ],
    ids=["straight", "many straight", "comb", "spiral", "hole", "repeated"],
)  # fmt: skip
@pytest.mark.parametrize("start", [0, 1, 3])
def test_awkward_simple_polygons(points, start):
    flat = np.column_stack(
        [np.roll(np.array(points, np.float64), start, axis=0), np.zeros(len(points))]
    )
    for points_ in (flat, flat[::-1], flat @ shapes.rotation(5).T):
        assert_cuts_once(points_, cut(points_))


@pytest.mark.parametrize("corners", [4, 5, 7])
def test_what_crosses_itself_or_has_no_area_still_gives_all_its_triangles(corners):
    angle = 4 * np.pi * np.arange(corners) / corners  # runs round twice
    pentagram = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(corners)])
    for points in (pentagram, np.zeros((corners, 3)), np.arange(corners)[:, None] * np.ones(3)):
        triangles = cut(points)
        assert len(triangles) == corners - 2
        assert set(triangles.reshape(-1).tolist()) == set(range(corners))


def test_polygons_of_all_sizes_in_one_mesh_keep_their_order_and_area():
    mesh = shapes.joined(shapes.disc(3), shapes.prism(7), shapes.rectangle(2, 1, 2, 1))
    found = PolygonMesh.from_faces(*mesh)
    pieces = vector_areas(found.vertices, found.triangles)
    for f, face in enumerate(mesh[1]):
        own = pieces[found.triangle_polygon == f]
        assert len(own) == len(face) - 2
        assert own.sum(axis=0) == pytest.approx(vector_area(found.vertices[list(face)]), abs=1e-12)


def test_a_polygon_that_would_take_too_long_is_refused():
    saw = [[k, 5.0 * (k % 2), 0.0] for k in range(30000)]
    with pytest.raises(ShapeError, match=r"face 0, of 30002 corners, .* too often to be cut"):
        cut([*saw, [30000.0, -1.0, 0.0], [-1.0, -1.0, 0.0]])


def test_a_face_that_names_few_vertices_again_and_again_is_refused():
    with pytest.raises(ShapeError, match=r"face 0 has 15000 corners, but names no more than 3"):
        PolygonMesh.from_faces(np.eye(3), [[k % 3 for k in range(15000)]])
