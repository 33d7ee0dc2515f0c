"""Faces that lie on each other: what of them encloses a volume, on solids of known volume."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from moseg_core.shape.volume import twins
from moseg_core.shape.volume.orientation import EdgeUses
from moseg_core.shape.volume.twins import one_of_each, one_sheet
from tests import shapes

BOX = shapes.box(2, 2, 2)
WALL = (1, 2, 6, 5)


def at(mesh, *place, scale=1.0):
    return shapes.moved(mesh, np.eye(3), scale, place)


def doubled(mesh, which=None, *, copies=1, turned=True):
    """A mesh with some faces, by default all, once more or several times, turned over."""
    vertices, faces = mesh
    again = [f for k, f in enumerate(faces) if which is None or k in which]
    return vertices, [*faces, *(f[::-1] if turned else f for f in again for _ in range(copies))]


def shuffled(mesh, seed):
    """Faces in another order, each beginning at any of its corners."""
    rng = np.random.default_rng(seed)
    vertices, faces = mesh
    order = rng.permutation(len(faces))
    return vertices, [tuple(np.roll(faces[k], rng.integers(9)).tolist()) for k in order]


def open_sheet():
    return np.array([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1.0]]), [(0, 1, 2, 3)]


def divided(mesh, *, copies):
    """A box of 2 by 1 by 1 with a wall across its middle, which lies there so often."""
    vertices, faces = shapes.joined(shapes.cube(), at(shapes.cube(), 1, 0, 0))
    points = np.asarray(vertices)
    inner = [k for k, face in enumerate(faces) if (points[list(face), 0] == 1).all()]
    assert len(inner) == 2
    kept = [face for k, face in enumerate(faces) if k not in inner]
    return vertices, kept + [faces[inner[k % 2]] for k in range(copies)]


def joined(*meshes):
    return shapes.joined(*meshes)


SOLIDS = {
    "a box from both sides": (doubled(BOX), 8),
    "another one beside it": (joined(doubled(BOX), at(shapes.tee(6, 5), 9, 0, 0)), 19),
    "both from both sides": (joined(doubled(BOX), doubled(at(BOX, 9, 0, 0))), 16),
    "touching along an edge": (joined(doubled(BOX), doubled(at(BOX, 2, 2, 0))), 16),
    "some faces from both sides": (doubled(shapes.tee(6, 5), {0, 3, 4}), 11),
    "all but one": (doubled(BOX, {0, 1, 2, 3, 4}), 8),
    "three sheets": (doubled(BOX, copies=2), 8),
    "four sheets": (doubled(doubled(BOX)), 8),
    "the same again": (doubled(BOX, turned=False), 8),
    "some the same again": (doubled(BOX, {1, 2}, turned=False), 8),
    "two boxes with a wall of both": (divided(None, copies=2), 2),
    "a double fin on a box": (
        joined(BOX, doubled((open_sheet()[0][:, [1, 0, 2]] + [2, 0, 0], open_sheet()[1]))),
        8,
    ),
    "a ball within a box": (
        joined(doubled(BOX), doubled(at(shapes.cube(), 0.7, 0.7, 0.7, scale=0.5))),
        8 - 0.125,
    ),
    "a box within a ball within a box": (
        joined(
            doubled(BOX),
            doubled(at(shapes.cube(), 0.5, 0.5, 0.5)),
            doubled(at(shapes.cube(), 0.7, 0.7, 0.7, scale=0.5)),
        ),
        8 - 1 + 0.125,
    ),
    "a box in the notch of another": (
        joined(doubled(shapes.solid([(0, 0, 0), (2, 0, 0), (1, 0, 0), (0, 0, 2), (0, 0, 1)])),
               doubled(at(shapes.cube(), 1.5, 0.2, 1.5, scale=0.5))),
        5.125,
    ),
    "triangles": (doubled(shapes.sphere(2)), None),
}  # fmt: skip


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_volumes_of_solids_with_faces_that_lie_on_each_other(name, seed):
    mesh, volume = SOLIDS[name]
    if volume is None:
        volume = Shape.from_mesh(*shapes.sphere(2)).volume
    if seed is not None:
        mesh = shapes.moved(shuffled(mesh, seed), shapes.rotation(seed), 0.1, [5.0, 1.0, 2.0])
        volume *= 1e-3
    shape = Shape.from_mesh(*mesh)
    assert shape.volume == pytest.approx(volume, rel=1e-9)
    assert shape.volume_source == "exact"
    assert any("lie on another one" in note for note in shape.notes)
    winding = shape.with_volume("winding")
    assert winding.volume == pytest.approx(volume, rel=0.02)
    assert not any("lie on another one" in note for note in winding.notes)


REFUSED = {
    "open and from both sides": (
        doubled(shapes.cube_without_lid()),
        "all faces lie on another one, as for two sides of a surface, and of one of each the"
        " surface is open (4 boundary edges)",
        1.0,
    ),
    "with a wall, all from both sides": (
        doubled(divided(None, copies=1)),
        "all faces lie on another one, as for two sides of a surface, and of one of each 4 edges"
        " have three or more faces",
        2.0,
    ),
    "a soup of two and one more": (
        joined(doubled(BOX, {0}), at(open_sheet(), 9, 0, 0)),
        "2 of 26 faces lie on another one, as for two sides of a surface, and of one of each the"
        " surface is open (4 boundary edges)",
        8.0,
    ),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("seed", [None, 1])
def test_what_does_not_close_is_refused_and_winding_helps(name, seed):
    mesh, reason, volume = REFUSED[name]
    shape = Shape.from_mesh(*(mesh if seed is None else shuffled(mesh, seed)))
    assert shape.volume is None
    assert shape.volume_reason == reason
    assert shape.with_volume("winding").volume == pytest.approx(volume, rel=0.02)


def test_two_faces_that_nothing_else_touches_enclose_nothing():
    shape = Shape.from_mesh(*doubled(open_sheet()))
    assert shape.volume_reason == "it is flat"


def test_parts_and_embeddings_of_what_is_seen_from_both_sides_have_the_volumes_of_one():
    vertices, faces = shapes.tee(6, 5)
    plain, both = Shape.from_mesh(vertices, faces), Shape.from_mesh(*doubled((vertices, faces)))
    assert both.volume == pytest.approx(plain.volume)
    few = np.arange(len(faces) // 2 + 3)
    twice = np.concatenate([few, few + len(faces)])
    expected = subshape(plain, few).volume
    assert expected > 0.1
    assert subshape(both, twice).volume == pytest.approx(expected)
    stretched = vertices * [2.0, 1.0, 3.0]
    assert both.deformed(stretched, space="x").volume == pytest.approx(6 * plain.volume)


@pytest.mark.parametrize("mesh", [shapes.cube(), shapes.book(3), shapes.soup(2, 6)])
def test_where_no_faces_lie_on_each_other_nothing_changes(mesh):
    made = PolygonMesh.from_faces(*mesh)
    assert one_of_each(made, EdgeUses.of(made)) is None
    assert one_sheet(made) is made


def test_the_first_that_looks_as_most_do_stands_for_all():
    vertices, faces = shapes.cube()
    three = [faces[0][::-1], *faces, faces[0]]
    made = PolygonMesh.from_faces(vertices, three)
    found = one_of_each(made, EdgeUses.of(made))
    assert found.kept.tolist() == [False, True, True, True, True, True, True, False]
    assert not found.turned.any()
    assert found.twins == 3
    assert len(one_sheet(made).triangles) == len(found.triangles(made)) == 12


def test_of_leaves_within_each_other_none_is_a_wall_of_a_cavity(monkeypatch):
    def no_trees(*_):
        raise AssertionError("what is open has no depth to be asked for")

    monkeypatch.setattr(twins.WindingTree, "of", no_trees)
    tent = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]), [(0, 1, 3), (2, 0, 3)]
    leaves = joined(*(at(tent, -k / 2, -k / 2, -k / 2, scale=1.0 + k) for k in range(20)))
    vertices, faces = doubled(leaves)
    made = PolygonMesh.from_faces(vertices, faces)
    found = one_of_each(made, EdgeUses.of(made))
    assert found.twins == len(faces)
    assert found.kept.sum() == len(faces) // 2
