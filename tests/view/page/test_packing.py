"""Geometry in base64: what is unpacked is what was packed, within the steps of 16 bits."""

from __future__ import annotations

import base64

import numpy as np
import pytest

from moseg_core.shape.shape import Shape
from moseg_core.view.page.packing import packed
from tests import shapes


def numbers(array):
    return np.frombuffer(base64.b64decode(array["data"]), f"<{array['type']}")


def places(document):
    steps = numbers(document["positions"]).reshape(-1, 3)
    frame = document["frame"]
    return np.array(frame["low"]) + steps / 65535.0 * np.array(frame["size"])


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_corners_are_where_they_were(shift):
    vertices, faces = shapes.tee()
    shape = Shape.from_mesh(vertices * 0.37 + shift, faces)
    mesh = shape.geometry
    labels = np.arange(shape.n_elements)
    document = packed(mesh, labels).document
    corners = places(document)[numbers(document["triangles"]).reshape(-1, 3)]
    error = np.abs(corners - mesh.vertices[mesh.triangles]).max()
    assert error <= np.ptp(mesh.vertices, axis=0).max() / 65535.0 * 0.51 + 1e-9
    assert numbers(document["labels"]).tolist() == mesh.triangle_polygon.tolist()


def test_vertices_at_one_position_are_one():
    """Each triangle of an STL has corners of its own: without this a page has no edges."""
    vertices, faces = shapes.cube()
    loose = np.array([vertices[i] for face in faces for i in face])
    shape = Shape.from_mesh(loose, np.arange(24).reshape(6, 4))
    document = packed(shape.geometry, np.zeros(6, np.int64)).document
    assert len(places(document)) == 8


def test_a_flat_shape_has_a_side_of_no_length(row):
    document = packed(row.geometry, np.zeros(6, np.int64)).document
    assert document["frame"]["size"] == [6.0, 1.0, 0.0]
    assert np.isfinite(places(document)).all()


def test_labels_take_the_bytes_that_they_need(row):
    for largest, kind in [(255, "u1"), (256, "u2"), (70_000, "u4")]:
        document = packed(row.geometry, np.full(6, largest)).document
        assert document["labels"]["type"] == kind


def test_of_a_large_cloud_some_points_are_drawn_and_know_their_numbers():
    cloud = Shape.from_points(np.random.default_rng(0).random((1000, 3)))
    shown = packed(cloud.geometry, np.arange(1000) // 500, most_points=100)
    assert (shown.drawn, shown.known) == (100, 1000)
    kept = numbers(shown.document["elements"])
    assert (kept[0], kept[-1]) == (0, 999)
    assert numbers(shown.document["labels"]).tolist() == (kept // 500).tolist()
    np.testing.assert_allclose(places(shown.document), cloud.points[kept], atol=1e-4)


def directions(document):
    return numbers(document["normals"]).reshape(-1, 3) / 127.5 - 1.0


def test_points_know_the_direction_of_their_surface():
    ball = np.random.default_rng(2).normal(size=(3000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    cloud = Shape.from_points(1e3 * ball + 5e4)
    found = directions(packed(cloud.geometry, np.zeros(3000, np.int64)).document)
    assert np.abs(np.einsum("pi,pi->p", found, ball)).min() > 0.9
    given = Shape.from_points(ball, normals=np.tile([0.0, 0.0, 2.0], (3000, 1)))
    found = directions(packed(given.geometry, np.zeros(3000, np.int64)).document)
    np.testing.assert_allclose(found, np.tile([0.0, 0.0, 1.0], (3000, 1)), atol=0.01)


def test_two_points_are_a_cloud_too():
    cloud = Shape.from_points([[0, 0, 0], [1, 2, 3]])
    found = directions(packed(cloud.geometry, np.array([0, 1])).document)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=0.02)
