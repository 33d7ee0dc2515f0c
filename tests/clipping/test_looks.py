"""Textures lie on the pieces of cut polygons as they lay on the polygons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from moseg_core.clipping.clip import clip_boundaries
from moseg_core.clipping.looks import looks_of_pieces
from moseg_core.shape.appearance import Appearance, CornerValues
from moseg_core.shape.mesh import PolygonMesh

STEPS = 6


def sheet():
    """A square of quads and triangles, with a seam in its texture at x = 0.5.

    The texture is a linear function of the place on either side, of the side too.
    """
    ticks = np.linspace(0, 1, STEPS + 1)
    u, v = (each.reshape(-1) for each in np.meshgrid(ticks, ticks, indexing="ij"))
    k = np.arange(len(u)).reshape(STEPS + 1, -1)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    whole, halved = quads[::2].tolist(), quads[1::2].tolist()
    faces = [*whole, *(quad[:3] for quad in halved), *([q[0], *q[2:]] for q in halved)]
    mesh = PolygonMesh.from_faces(np.stack([u, v, 0 * u], axis=1), faces)
    side = mesh.vertices[mesh.triangles].mean(axis=1)[:, 0] > 0.5
    right = side[np.searchsorted(mesh.triangle_polygon, np.arange(mesh.n_polygons))]
    corners = mesh.vertices[mesh.corners]
    of_corner = np.repeat(right, np.diff(mesh.offsets))
    looks = Appearance(
        texture=CornerValues(values=textured(corners, of_corner), corners=np.arange(len(corners))),
        normals=CornerValues(values=np.array([[0.0, 0, 1]]), corners=np.zeros(len(corners), int)),
        materials=("left", "right"),
        polygon_materials=right.astype(int),
    )
    return replace(mesh, appearance=looks)


def textured(points, right):
    return np.stack([2 * points[:, 0] - points[:, 1], points[:, 1]], 1) + 10.0 * right[:, None]


def test_the_texture_of_pieces_is_that_of_their_places():
    mesh = sheet()
    points = np.add.reduceat(mesh.vertices[mesh.corners], mesh.offsets[:-1])
    points /= np.diff(mesh.offsets)[:, None]
    centers = np.array([[0.1, 0.2, 0], [0.83, 0.77, 0], [0.2, 0.9, 0]])
    labels = np.linalg.norm(points[:, None] - centers, axis=2).argmin(axis=1)
    clipped = clip_boundaries(mesh, labels, points, centers, np.ones(3))
    assert len(clipped.source) > mesh.n_polygons
    looks = clipped.mesh.appearance
    right = mesh.appearance.polygon_materials[clipped.source]
    np.testing.assert_array_equal(looks.polygon_materials, right)
    of_corner = np.repeat(right, np.diff(clipped.mesh.offsets)).astype(bool)
    np.testing.assert_allclose(
        looks.texture.values[looks.texture.corners],
        textured(clipped.mesh.vertices[clipped.mesh.corners], of_corner),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        looks.normals.values[looks.normals.corners],
        np.tile([0.0, 0, 1], (len(clipped.mesh.corners), 1)),
        atol=1e-12,
    )


def test_corners_without_any_give_none_and_a_mesh_without_any_has_none():
    tile = PolygonMesh.from_faces([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    halves = PolygonMesh.from_faces([*tile.vertices, [1, 1, 0]], [[0, 1, 3], [0, 3, 2]])
    texture = CornerValues(values=np.ones((1, 2)), corners=np.array([0, 0, -1]))
    look = replace(tile, appearance=Appearance(texture=texture))
    found = looks_of_pieces(look, halves, np.array([0, 0]))
    assert found.texture.corners.tolist() == [0, 0, -1, 0, -1, -1]
    assert looks_of_pieces(tile, halves, np.array([0, 0])) is None
