"""Polygon meshes: what is accepted, what is refused, which corners and edges are one."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.mesh import PolygonMesh
from tests import shapes

TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def mesh_of(mesh):
    return PolygonMesh.from_faces(*mesh)


@pytest.mark.parametrize(
    ("vertices", "faces", "message"),
    [
        ([], [[0, 1, 2]], "no vertices"),
        (np.empty((0, 3)), [[0, 1, 2]], "no vertices"),
        ([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], r"shape \(V, 3\), not \(3, 2\)"),
        ([0.0, 1.0, 2.0], [[0, 1, 2]], r"shape \(V, 3\)"),
        ([["x", 0, 0], *TRIANGLE[1:]], [[0, 1, 2]], "array of numbers"),
        ([[0, 0], *TRIANGLE[1:]], [[0, 1, 2]], "array of numbers"),
        (TRIANGLE, [], "no faces"),
        (TRIANGLE, np.empty((0, 3), int), "no faces"),
        (TRIANGLE, [[0, 1, 2], [0, 1]], "face 1 has 2 corners"),
        (TRIANGLE, np.array([[0, 1]]), "face 0 has 2 corners"),
        (TRIANGLE, [[]], "face 0 has 0 corners"),
        (TRIANGLE, [[0, 1, 2], [0, 1, 3]], "face 1 names vertex 3, but there are 3"),
        (TRIANGLE, [[0, 1, -1]], "face 0 names vertex -1"),
        (TRIANGLE, [[0, 1, 2.0]], "integers"),
        (TRIANGLE, np.array([[0.0, 1, 2]]), "integers"),
        (TRIANGLE, np.array([0, 1, 2]), r"\(F, k\)"),
        ([[0, 0, np.nan], *TRIANGLE[1:]], [[0, 1, 2]], r"vertex 0 is not finite.*\(1 such"),
        ([*TRIANGLE, [np.inf, 0, 0], [0, -np.inf, 0]], [[0, 3, 4]], r"vertex 3 .*\(2 such"),
    ],
)
def test_malformed_meshes_are_refused_in_one_line(vertices, faces, message):
    with pytest.raises(ShapeError, match=message) as caught:
        PolygonMesh.from_faces(vertices, faces)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "faces",
    [
        [[0, 1, 2]],
        [(0, 1, 2)],
        ((0, 1, 2),),
        np.array([[0, 1, 2]], np.int32),
        np.array([[0, 1, 2]], np.uint8),
        [np.array([0, 1, 2])],
        iter([[0, 1, 2]]),
    ],
    ids=["lists", "tuples", "tuple", "int32", "uint8", "arrays", "iterator"],
)
def test_faces_may_come_in_any_form(faces):
    mesh = PolygonMesh.from_faces(TRIANGLE, faces)
    assert mesh.corners.tolist() == [0, 1, 2]
    assert mesh.corners.dtype == mesh.triangles.dtype == np.int64
    assert mesh.is_triangular


def test_polygons_stay_in_file_order_beside_their_triangles():
    vertices, faces = shapes.prism(5)
    mesh = mesh_of((vertices, [faces[6], faces[0], faces[5], *faces[1:5]]))
    assert mesh.n_polygons == 7
    assert np.diff(mesh.offsets).tolist() == [5, 4, 5, 4, 4, 4, 4]
    assert mesh.triangle_polygon.tolist() == [0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6]
    assert not mesh.is_triangular
    for triangle, polygon in zip(mesh.triangles, mesh.triangle_polygon, strict=True):
        own = mesh.corners[mesh.offsets[polygon] : mesh.offsets[polygon + 1]]
        assert set(triangle.tolist()) <= set(own.tolist())


def test_the_mesh_keeps_a_copy_of_what_it_is_given():
    vertices = np.array(TRIANGLE, dtype=np.float64)
    mesh = PolygonMesh.from_faces(vertices, [[0, 1, 2]])
    vertices[:] = 9.0
    assert mesh.vertices.tolist() == TRIANGLE


def test_vertices_are_one_where_their_positions_are():
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-0.0, -0.0, 0], [1, 0, 1e-7], [1, 0, 0]],
        [[0, 1, 2], [3, 4, 5]],
    )
    merged = mesh.merged.tolist()
    assert merged[0] == merged[3]
    assert merged[1] == merged[5] != merged[4]
    assert sorted(set(merged)) == list(range(4))


@given(st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_repeating_every_vertex_changes_no_edge(seed):
    vertices, faces = shapes.jitter(shapes.prism(5), seed)
    flat = [v for face in faces for v in face]
    starts = np.cumsum([0, *map(len, faces)])
    apart = [tuple(range(a, b)) for a, b in itertools.pairwise(starts)]
    one, two = mesh_of((vertices, faces)), mesh_of((vertices[flat], apart))
    for first, second in zip(one.edges, two.edges, strict=True):
        assert (first == second).all()


def test_the_edges_run_around_each_polygon():
    mesh = mesh_of(shapes.prism(3))
    ends, polygon = mesh.edges
    assert np.bincount(polygon).tolist() == [4, 4, 4, 3, 3]
    for f in range(mesh.n_polygons):
        own = ends[polygon == f]
        assert (own[:, 1] == np.roll(own[:, 0], -1)).all()
        corners = mesh.corners[mesh.offsets[f] : mesh.offsets[f + 1]]
        assert own[:, 0].tolist() == mesh.merged[corners].tolist()


def test_an_edge_of_no_length_is_left_out():
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0]], [[0, 1, 3, 2], [0, 0, 1]]
    )
    ends, polygon = mesh.edges
    assert polygon.tolist() == [0, 0, 0, 1, 1]
    assert (ends[:, 0] != ends[:, 1]).all()


@pytest.mark.parametrize("idle", [np.nan, np.inf, 1e300])
def test_vertices_that_no_face_uses_are_not_looked_at(idle):
    mesh = PolygonMesh.from_faces([[idle, 0, 0], *TRIANGLE, [0, 0, idle]], [[1, 2, 3]])
    assert np.isfinite(mesh.vertices).all()
    assert mesh.vertices[1:4].tolist() == TRIANGLE
    assert mesh.notes == ("vertices without a place, used by no face: 2; they are not looked at",)


def test_how_near_vertices_are_joined_is_a_share_of_the_diagonal():
    crack = [[0, 0, 0], [300, 0, 0], [0, 400, 0], [300, 3e-6, 0], [0, 400, 0], [300, 400, 0]]
    faces = [[0, 1, 2], [3, 5, 4]]
    mesh = PolygonMesh.from_faces(crack, faces)
    assert mesh.tolerance == pytest.approx(5e-6)
    assert mesh.merged[1] == mesh.merged[3]
    assert mesh.n_near == 1
    assert mesh.vertices.tolist() == crack  # none is moved
    exact = mesh.welded(0.0)
    assert exact.merged[1] != exact.merged[3]
    assert PolygonMesh.from_faces(crack, faces, weld=1e-9).n_near == 0
    for wrong in (-1e-9, 0.2, np.nan):
        with pytest.raises(UsageError, match="a share of the diagonal from 0 to"):
            mesh.welded(wrong)


def test_vertices_that_no_face_uses_join_no_others():
    between = [1, 5e-7, 0]  # near to the corners on either side, which are apart
    corners = [*TRIANGLE, [1, 1e-6, 0], [1, 1, 0], [0, 1, 0]]
    faces = [[0, 1, 2], [3, 4, 5]]
    plain = PolygonMesh.from_faces(corners, faces, weld=5e-7)
    idle = [between, between, TRIANGLE[0]]
    mesh = PolygonMesh.from_faces([*idle, *corners], np.array(faces) + len(idle), weld=5e-7)
    assert plain.n_near == mesh.n_near == 0
    assert mesh.merged[3:].tolist() == plain.merged.tolist()
    assert mesh.merged[:3].tolist() == [6, 6, 5]
    assert sorted(set(mesh.merged.tolist())) == list(range(7))
