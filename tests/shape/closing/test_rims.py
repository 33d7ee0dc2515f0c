"""Rims: all of them, which way around, and which are holes in the cap of another."""

from __future__ import annotations

import numpy as np

from moseg_core.shape.closing.rims import caps_of, find_rims, inside_ring
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses
from tests import shapes


def rims_of(mesh):
    found = PolygonMesh.from_faces(*mesh)
    return found, find_rims(found, EdgeUses.of(found))


def turned(mesh):
    vertices, faces = mesh
    return vertices, [face[::-1] for face in faces]


def pipe(wall=0.3, n=16):
    """A piece of pipe with a wall, cut across at both ends: two surfaces, open along four rims."""
    return shapes.joined(shapes.tube(n, 1.0), turned(shapes.tube(n, 1.0 - wall)))


def test_a_closed_surface_has_none_and_a_tube_two():
    assert rims_of(shapes.box(2, 1, 1))[1] == []
    mesh, rims = rims_of(shapes.tube(8, length=4.0))
    assert [len(rim.ring) for rim in rims] == [8, 8]
    areas = np.array([rim.area for rim in rims])
    # Each cap looks away from the tube, and so does the surface where it ends.
    assert np.allclose(np.sort(areas[:, 2]), [-2 * 2**0.5, 2 * 2**0.5])
    for rim in rims:
        assert (
            np.sign(rim.beyond[2])
            == np.sign(rim.area[2])
            == np.sign(mesh.vertices[rim.ring, 2].mean() - 2.0)
        )
        assert not rim.inverted


def test_loops_that_touch_in_a_vertex_are_told_apart():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 1, 0], [2, 2, 0],
                         [1, 2, 0]])  # fmt: skip
    _, rims = rims_of((vertices, [[0, 1, 2, 3], [2, 4, 5, 6]]))
    assert sorted(len(rim.ring) for rim in rims) == [4, 4]


def test_the_wall_of_a_pipe_has_rings_for_caps():
    mesh, rims = rims_of(pipe())
    assert len(rims) == 4
    caps = caps_of(mesh.vertices, rims)
    assert [len(cap) for cap in caps] == [2, 2]
    for outer, inner in caps:
        assert np.linalg.norm(outer.area) > np.linalg.norm(inner.area)
        assert outer.area @ inner.area < 0
        assert inner.inverted


def test_the_ends_of_a_short_tube_are_no_holes_in_each_other():
    vertices, faces = shapes.tube(16, 1.0, length=0.1)
    vertices = np.where(vertices[:, 2:] > 0, vertices * [0.8, 0.8, 1.0], vertices)
    mesh, rims = rims_of((vertices, faces))
    assert [len(cap) for cap in caps_of(mesh.vertices, rims)] == [1, 1]


def test_points_inside_a_polygon_that_is_not_convex():
    horseshoe = np.array([[0.0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]])
    points = np.array([[0.5, 2.0], [1.5, 2.0], [2.5, 2.0], [1.5, 0.5], [4.0, 1.0]])
    assert inside_ring(points, horseshoe).tolist() == [True, False, True, True, False]
