"""Exact volumes of known solids, and why other surfaces have none."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape.adjacency import mesh_adjacency
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.enclosed import enclosed_volume
from moseg_core.shape.volume.volume import Volume
from tests import shapes


def volume_of(mesh):
    return enclosed_volume(mesh, mesh_adjacency(mesh))


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (shapes.cube(), 1.0),
        (shapes.box(2, 3, 4), 24.0),
        (shapes.tee(6, 5), 11.0),
        (shapes.two_boxes(), 4.0),
        (shapes.solid([(0, 0, 0), (1, 1, 0)]), 2.0),  # share an edge, which four faces use
        (shapes.prism(6, 1.0, 2.0), 3 * 3**0.5),
        (shapes.fan(shapes.prism(5, 2.0, 3.0)), 3 * 5 / 2 * 4 * np.sin(2 * np.pi / 5)),
    ],
    ids=["cube", "box", "tee", "two", "edge", "prism", "triangles"],
)
@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_volumes_of_known_solids(mesh, volume, shift):
    for seed in (None, 1):
        turned = shapes.moved(
            mesh, np.eye(3) if seed is None else shapes.rotation(seed), 1.0, [shift] * 3
        )
        found = volume_of(PolygonMesh.from_faces(*turned))
        assert found == Volume.exact(pytest.approx(volume, rel=1e-9))


def test_the_volume_is_positive_whichever_way_the_faces_look():
    vertices, faces = shapes.tee()
    inside_out = PolygonMesh.from_faces(vertices, [face[::-1] for face in faces])
    assert volume_of(inside_out).value == pytest.approx(11.0)


def test_components_against_each_other_are_refused_but_cavities_are_not():
    box, far = shapes.box(2, 2, 2), shapes.moved(shapes.cube(), np.eye(3), 1.0, [9.0] * 3)
    inner = shapes.moved(shapes.cube(), np.eye(3), 0.5, [0.7] * 3)

    def turned(mesh):
        return mesh[0], [face[::-1] for face in mesh[1]]

    def volume(*meshes):
        return volume_of(PolygonMesh.from_faces(*shapes.joined(*meshes)))

    assert volume(box, far) == Volume.exact(pytest.approx(9.0))
    refused = Volume.none(
        "its components are oriented against each other",
        "take --volume winding, for which a piece may be oriented either way",
    )
    assert volume(box, turned(far)) == refused
    assert volume(turned(box), turned(far)) == Volume.exact(pytest.approx(9.0))
    assert volume(box, turned(inner)) == Volume.exact(pytest.approx(8 - 0.125))
    assert volume(turned(box), inner) == Volume.exact(pytest.approx(8 - 0.125))


def flipped(mesh):
    vertices, faces = mesh
    return vertices, [faces[0][::-1], *faces[1:]]


@pytest.mark.parametrize(
    ("mesh", "reason"),
    [
        (shapes.cube_without_lid(), "open (4 boundary edges)"),
        (shapes.annulus(12), "open (24 boundary edges)"),
        (shapes.book(3), "open (6 boundary edges), and 1 edge has three or more faces"),
        (
            (shapes.cube()[0], [*shapes.cube()[1], (0, 1, 2)]),
            "open (1 boundary edge), and 2 edges have three or more faces",
        ),
        (flipped(shapes.cube()), "not oriented consistently (1 of 6 is turned over)"),
        ((np.eye(3), [(0, 1, 2), (2, 1, 0)]), "flat"),
        ((np.zeros((3, 3)), [(0, 1, 2)]), "no edges"),
    ],
    ids=["no lid", "annulus", "book", "extra face", "flipped", "flat", "a point"],
)
def test_a_surface_that_encloses_nothing_says_why(mesh, reason):
    found = volume_of(PolygonMesh.from_faces(*mesh))
    assert (found.value, found.source) == (None, None)
    assert reason in found.reason
