"""Parts as closed solids: watertight for trimesh, outside out, with the volume that they had."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import moseg_core
from moseg_core.shape.closing.close import close, joined
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.subshape import restricted
from tests import shapes


def solid(mesh):
    """For trimesh, which joins equal vertices."""
    return trimesh.Trimesh(mesh.vertices, mesh.triangles, process=True)


def check(closed, volume=None, caps=None):
    found = solid(closed.mesh)
    assert closed.reason == ""
    assert found.is_watertight
    assert found.is_winding_consistent
    assert found.volume == pytest.approx(closed.volume)
    assert found.volume > 0
    if volume is not None:
        assert closed.volume == pytest.approx(volume)
    if caps is not None:
        assert closed.caps == caps


@pytest.mark.parametrize("name", ["hammer", "horse", "octopus", "dove", "bulldog"])
def test_the_parts_of_the_samples_can_be_printed(name):
    shape = moseg_core.load(moseg_core.sample_path(name))
    labels = moseg_core.read_labels(moseg_core.sample_labels_path(name), shape).labels
    total = 0.0
    for label in np.unique(labels):
        closed = close(restricted(shape.geometry, np.flatnonzero(labels == label)))
        check(closed)
        total += closed.volume
    # Caps of neighbours are the same, up to how the least area is cut.
    assert total == pytest.approx(shape.volume, rel=0.01)


def test_quads_stay_and_caps_come_last():
    tube = PolygonMesh.from_faces(*shapes.tube(8, length=4.0, rings=3))
    closed = close(tube)
    check(closed, volume=4.0 * 2 * 2**0.5, caps=2)
    assert np.diff(closed.mesh.offsets).tolist() == [4] * 24 + [3] * 12
    assert closed.mesh.vertices[closed.mesh.corners[:96]].tolist() == (
        tube.vertices[tube.corners].tolist()
    )


def test_the_wall_of_a_pipe_is_closed_by_rings():
    inner = shapes.tube(12, 0.7)
    wall = shapes.joined(shapes.tube(12, 1.0), (inner[0], [face[::-1] for face in inner[1]]))
    area = 12 * np.sin(np.pi / 6) / 2.0
    closed = close(PolygonMesh.from_faces(*wall))
    check(closed, volume=4.0 * area * (1 - 0.49), caps=2)


def test_what_is_loose_turned_over_or_inside_out_is_put_in_order():
    vertices, faces = shapes.tube(8)
    inside_out = [face[::-1] for face in faces]
    check(close(PolygonMesh.from_faces(vertices, inside_out)), volume=8 * 2**0.5, caps=2)
    mixed = [face[:: (-1) ** k] for k, face in enumerate(faces)]
    check(close(PolygonMesh.from_faces(vertices, mixed)), volume=8 * 2**0.5, caps=2)
    corners = vertices[[v for face in faces for v in face]]
    soup = np.arange(len(corners)).reshape(-1, 4)
    check(close(PolygonMesh.from_faces(corners, soup)), volume=8 * 2**0.5, caps=2)
    twice = [*faces, *inside_out]
    check(close(PolygonMesh.from_faces(vertices, twice)), volume=8 * 2**0.5, caps=2)


def test_a_cavity_stays_and_a_loose_piece_is_turned_outward():
    box = shapes.box(3, 3, 3)
    small = shapes.box()
    inner = (small[0] + 1.0, [face[::-1] for face in small[1]])
    check(close(PolygonMesh.from_faces(*shapes.joined(box, inner))), volume=26.0, caps=0)
    beside = (small[0] + 5.0, inner[1])
    check(close(PolygonMesh.from_faces(*shapes.joined(box, beside))), volume=28.0, caps=0)
    hollow = shapes.joined(box, inner)
    over = (hollow[0], [face[::-1] for face in hollow[1]])
    check(close(PolygonMesh.from_faces(*over)), volume=26.0, caps=0)


def test_a_cap_makes_no_edge_that_the_surface_has():
    # A strip of triangles around a cone: all its vertices are on the rims, joined across.
    check(close(PolygonMesh.from_faces(*shapes.fan(shapes.tube(4, length=1.0)))), volume=2.0)
    lone = close(PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    assert solid(lone.mesh).is_watertight
    assert lone.reason == "it is flat, also with its rims capped"
    assert lone.volume == 0.0


def test_why_a_surface_cannot_be_closed():
    angle = np.arange(12) * np.pi / 6
    across = np.stack([np.cos(angle) * np.cos(angle / 2), np.sin(angle) * np.cos(angle / 2),
                       np.sin(angle / 2)], axis=1)  # fmt: skip
    middle = 3 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    vertices = np.concatenate([middle - across, middle + across])
    band = [(k, k + 1, k + 13, k + 12) for k in range(11)] + [(11, 12, 0, 23)]
    assert "one side only" in close(PolygonMesh.from_faces(vertices, band)).reason
    book = close(PolygonMesh.from_faces(*shapes.book(4)))
    assert book.reason.endswith("of its edges have more than two faces")


def test_faces_without_extent_are_left_out():
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0]],
        [[0, 1, 4, 2], [0, 2, 3], [1, 4, 2], [0, 1, 1]],
    )
    once = joined(mesh)
    assert [len(face) for face in np.split(once.corners, once.offsets[1:-1])] == [3, 3]
    assert len(once.triangles) == 2
