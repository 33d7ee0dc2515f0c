"""Uses of edges and turned faces, against what was done to surfaces of known orientation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses, turned_faces
from tests import shapes


def uses_of(vertices, faces):
    return EdgeUses.of(PolygonMesh.from_faces(vertices, faces))


@pytest.mark.parametrize(
    ("mesh", "uses", "unbalanced"),
    [
        (shapes.cube(), [2] * 12, 0),
        (shapes.cube_without_lid(), [1] * 4 + [2] * 8, 4),
        (shapes.book(3), [1] * 6 + [3], 7),
        (shapes.solid([(0, 0, 0), (1, 1, 0)]), [2] * 22 + [4], 0),
    ],
    ids=["cube", "open", "book", "touching"],
)
def test_edges_and_how_often_faces_use_them(mesh, uses, unbalanced):
    found = uses_of(*mesh)
    assert sorted(found.uses.tolist()) == uses
    assert int((found.balance != 0).sum()) == unbalanced
    assert found.pairs.shape == (uses.count(2), 2)
    assert (found.edge[found.pairs[:, 0]] == found.edge[found.pairs[:, 1]]).all()


@given(st.integers(0, 2**32), st.sampled_from(["sphere", "tee", "open", "two"]))
@settings(max_examples=40, deadline=None)
def test_the_lesser_part_of_each_piece_is_turned(seed, name):
    rng = np.random.default_rng(seed)
    vertices, faces = {
        "sphere": shapes.sphere(2),
        "tee": shapes.tee(6, 5),
        "open": shapes.cube_without_lid(),
        "two": shapes.two_boxes(),
    }[name]
    over = rng.random(len(faces)) < rng.random()
    mixed = [face[::-1] if turn else face for face, turn in zip(faces, over, strict=True)]
    weights = rng.random(len(faces))
    turned, piece = turned_faces(uses_of(vertices, mixed), weights)
    assert len(set(piece.tolist())) == (2 if name == "two" else 1)
    for number in set(piece.tolist()):
        mine = piece == number
        assert (turned[mine] == over[mine]).all() or (turned[mine] != over[mine]).all()
        assert weights[mine & turned].sum() <= weights[mine].sum() / 2
    right = [face[::-1] if turn else face for face, turn in zip(mixed, turned, strict=True)]
    assert (np.abs(uses_of(vertices, right).balance) <= 1).all()
    again = turned_faces(uses_of(vertices, right), weights)[0]
    assert not again.any()


def test_a_piece_of_equal_halves_is_as_its_first_face():
    vertices, faces = shapes.cube()
    mixed = [*faces[:3], *(face[::-1] for face in faces[3:])]
    turned = turned_faces(uses_of(vertices, mixed), np.ones(6))[0]
    assert turned.tolist() == [False] * 3 + [True] * 3


def test_a_strip_with_one_side_is_in_no_piece():
    vertices = [[0, 0, 0], [1, 0, 0], [2, 1, 0], [1, 2, 1], [0, 1, 2], [3, 0, 0]]
    # Five triangles, each sharing an edge with the next, the last with the first: a Moebius strip.
    strip = [(k % 5, (k + 1) % 5, (k + 2) % 5) for k in range(5)]
    turned, piece = turned_faces(uses_of(vertices, strip), np.ones(5))
    assert piece.tolist() == [-1] * 5
    assert not turned.any()


def test_edges_of_three_faces_join_no_pieces():
    piece = turned_faces(uses_of(*shapes.book(3)), np.ones(3))[1]
    assert len(set(piece.tolist())) == 3
    assert (piece >= 0).all()


def test_uses_of_some_faces_some_of_them_turned():
    found = uses_of(*shapes.cube())
    none = np.zeros(6, bool)
    kept = np.arange(6) < 5
    assert found.of_faces(kept, none).uses.tolist() == [
        int(kept[found.face[found.edge == k]].sum()) for k in range(12)
    ]
    turned = np.arange(6) == 2
    assert (np.abs(found.of_faces(kept | ~kept, turned).balance) == 2).sum() == 4
