"""Positions, edges, labels of vertices and cuts of small labelled meshes."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.clipping.bisector import Bisectors
from moseg_core.clipping.net import Net
from moseg_core.shape.mesh import PolygonMesh
from tests import shapes


def net_of(mesh, labels, centers, weights=None):
    made = PolygonMesh.from_faces(*mesh)
    points = np.array([made.vertices[list(face)].mean(axis=0) for face in mesh[1]])
    centers = np.array(centers, np.float64)
    weights = np.ones(len(centers)) if weights is None else np.array(weights)
    return Net.of(made, np.array(labels), points, made.vertices, Bisectors(centers, weights))


def nearest(mesh, centers):
    """The nearest centre of each face's middle."""
    points = np.array([mesh[0][list(face)].mean(axis=0) for face in mesh[1]])
    apart = np.linalg.norm(points[:, None] - np.array(centers), axis=2)
    return apart.argmin(axis=1).tolist()


def test_edges_are_shared_also_by_faces_with_vertices_of_their_own():
    vertices, faces = shapes.fan(shapes.cube())
    split = vertices[np.array(faces)].reshape(-1, 3), np.arange(36).reshape(-1, 3).tolist()
    for mesh in ((vertices, faces), split):
        net = net_of(mesh, [0] * 12, [[0, 0, 0]])
        assert len(net.vertex) == 8
        assert len(net.ends) == 18
        assert (net.ends[:, 0] < net.ends[:, 1]).all()
        assert (np.bincount(net.edge.reshape(-1)) == 2).all()
        # The edge of a corner goes from there to the next one.
        for k in range(3):
            pair = np.sort(net.corner[:, [k, (k + 1) % 3]], axis=1)
            assert (net.ends[net.edge[:, k]] == pair).all()


@pytest.mark.parametrize(("weights", "at"), [((1, 1), 2.25), ((1, 2), 1.5)])
def test_edges_between_parts_are_cut_at_the_bisector(weights, at):
    strip = shapes.fan(shapes.strip(6))
    centers = [[0.0, 0.5, 0], [4.5, 0.5, 0]]
    apart = np.linalg.norm(
        np.array([strip[0][list(face)].mean(axis=0) for face in strip[1]])[:, None] - centers,
        axis=2,
    )
    net = net_of(strip, (apart / weights).argmin(axis=1), centers, weights)
    cuts = net.cuts(np.zeros(2, bool))
    x, y = net.places[:, 0], net.places[:, 1]
    assert set(cuts.label[x < at - 1]) == {0}
    assert set(cuts.label[x > at + 1]) == {1}
    assert cuts.cut.any()
    assert (cuts.where[~cuts.cut] == 0).all()
    for edge in np.flatnonzero(cuts.cut):
        low, high = net.ends[edge]
        assert {cuts.label[low], cuts.label[high]} == {0, 1}
        place = net.places[low] + cuts.where[edge] * (net.places[high] - net.places[low])
        to = np.linalg.norm(place - centers, axis=1) / weights
        assert to[0] == pytest.approx(to[1])
        if y[low] == y[high] == 0.5:
            assert place[0] == pytest.approx(at)


def test_labels_that_are_kept_are_not_cut_into():
    strip = shapes.fan(shapes.strip(6))
    centers = [[0.5, 0.5, 0], [4.7, 0.5, 0]]
    net = net_of(strip, nearest(strip, centers), centers)
    cuts = net.cuts(np.array([True, False]))
    owned = np.unique(net.corner[net.label == 0])
    assert (cuts.label[owned] == -1).all()
    assert not cuts.cut.any()


def test_a_face_that_the_flood_left_beyond_the_bisector_stays():
    # The last square is nearest to centre 0 but belongs to part 1, as behind a wall.
    strip = shapes.fan(shapes.strip(3))
    centers = [[2.5, 0.5, 0], [-9.0, 0.5, 0]]
    labels = [0, 0, 0, 0, 1, 1]
    net = net_of(strip, labels, centers)
    cuts = net.cuts(np.zeros(2, bool))
    assert not cuts.cut.any()
    # Its corners do not take the label of the nearer centre.
    own = np.unique(net.corner[np.array(labels) == 1])
    assert 0 not in cuts.label[own]
