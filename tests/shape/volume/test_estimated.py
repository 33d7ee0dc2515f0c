"""Estimated volumes against the true ones of known shapes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io import load
from moseg_core.samples import sample_path
from moseg_core.shape.shape import Shape
from tests import shapes


def trimesh_of(shape):
    return trimesh.Trimesh(shape.geometry.vertices, shape.geometry.triangles, process=False)


def shrunk(shape, factor):
    """The triangles of a shape, each smaller than its place: a soup."""
    corners = shape.geometry.vertices[shape.geometry.triangles]
    middle = corners.mean(axis=1, keepdims=True)
    soup = (middle + factor * (corners - middle)).reshape(-1, 3)
    return Shape.from_mesh(soup, np.arange(len(soup)).reshape(-1, 3))


@pytest.fixture(scope="module", params=["hammer", "horse", "torus"])
def known(request):
    if request.param == "torus":
        return Shape.from_mesh(trimesh.creation.torus(1.0, 0.3))
    return load(sample_path(request.param))


def test_winding_of_a_closed_mesh(known):
    assert known.with_volume("winding").volume == pytest.approx(known.volume, rel=0.001)


def test_winding_of_a_soup(known):
    soup = shrunk(known, 0.9)
    assert soup.volume is None
    assert soup.with_volume("winding").volume == pytest.approx(known.volume, rel=0.003)


@pytest.mark.parametrize(("n", "error"), [(2000, 0.03), (8000, 0.015)])
def test_winding_of_a_cloud_with_normals(known, n, error):
    mesh = trimesh_of(known)
    points, face = trimesh.sample.sample_surface(mesh, n, seed=1)
    cloud = Shape.from_points(points, normals=mesh.face_normals[face])
    assert cloud.with_volume("winding").volume == pytest.approx(known.volume, rel=error)


@pytest.mark.parametrize("turned", [False, True])
def test_winding_whichever_way_the_whole_is_oriented(turned):
    vertices, faces = shapes.moved(shapes.cube(), shapes.rotation(3), 1e-3, (5, 6, 7))
    faces = [face[::-1] if turned else face for face in faces]
    cube = Shape.from_mesh(vertices, faces[:-1])  # without its lid
    volume = cube.with_volume("winding").volume
    assert volume == pytest.approx(1e-9, rel=0.005)  # a membrane over the rim closes it


def test_winding_of_many_triangles_takes_seconds():
    ball = trimesh.creation.icosphere(subdivisions=6)
    assert len(ball.faces) > 60_000
    shape = Shape.from_mesh(ball).with_volume("winding")
    assert shape.volume == pytest.approx(ball.volume, rel=0.001)


def test_what_is_recorded():
    made = Shape.from_points(shapes.cube()[0])
    assert "encloses no volume: it is a point cloud" in made.notes
    given = made.with_volume("2.5")
    assert (given.volume, given.volume_reason) == (2.5, "")
    assert given.notes == ("the enclosed volume is taken to be 2.5, as given",)
    assert given.key != made.key
    assert made.with_volume(2.5).key == given.key
    hull = made.with_volume("hull")
    assert hull.volume == pytest.approx(1.0)
    assert hull.notes == ("the enclosed volume is taken to be 1, that of its convex hull",)


DOUBT = "faces are not oriented alike"


@pytest.mark.parametrize("share", [0.001, 0.2, 0.5])
def test_faces_that_are_turned_over_are_turned_back_before_anything_winds(share):
    vertices, faces = shapes.sphere(3)
    turned = np.random.default_rng(0).random(len(faces)) < share
    mixed = [face[::-1] if turn else face for face, turn in zip(faces, turned, strict=True)]
    shape = Shape.from_mesh(vertices, mixed).with_volume("winding")
    assert shape.volume == Shape.from_mesh(vertices, faces).with_volume("winding").volume
    few = int(min(turned.sum(), (~turned).sum()))
    back = f", {few} face{'s' * (few != 1)} turned over to agree with the others"
    assert shape.notes[-1].endswith(f"winds more than half around{back}")


def test_a_winding_volume_of_faces_that_cannot_be_oriented_is_doubted():
    shape = Shape.from_mesh(*shapes.joined(shapes.box(2, 2, 2), moebius(30)))
    assert f"; it may be far off: at 1 edge {DOUBT}" in shape.with_volume("winding").notes[-1]
    assert not any(DOUBT in note for note in shape.with_volume("hull").notes)


def moebius(n):
    """A strip of n quads that comes back to itself turned over."""
    angle = 2 * np.pi * np.arange(n) / n
    out = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    up = np.stack([np.cos(angle / 2) * out[:, 0], np.cos(angle / 2) * out[:, 1], np.sin(angle / 2)])
    vertices = np.concatenate([5 * out - up.T, 5 * out + up.T])
    faces = [(k, k + 1, n + k + 1, n + k) for k in range(n - 1)]
    return vertices + np.array([9.0, 0, 0]), [*faces, (n - 1, n, 0, 2 * n - 1)]


def test_hulls_of_an_open_surface_are_those_of_it_capped_and_doubted():
    rng = np.random.default_rng(0)
    vertices, faces = shapes.tee(6, 5)
    bottom = len(faces) - 1
    opened = Shape.from_mesh(vertices, faces[:bottom])
    assert (
        "; a guess, since the surface is open (4 boundary edges)"
        in opened.with_volume("hull").notes[-1]
    )
    # A bowl, whose hulls without a cap are those of its wall.
    ball_vertices, ball = shapes.sphere(4)
    middles = ball_vertices[np.array(ball)].mean(axis=1)
    bowl = [face for face, z in zip(ball, middles[:, 2], strict=True) if z < 0.3]
    shape = Shape.from_mesh(ball_vertices * rng.uniform(1, 2, 3), bowl)
    truth = shape.with_volume("winding").volume
    assert shape.with_volume("hull").volume == pytest.approx(truth, rel=0.1)


def test_how_far_hulls_of_an_open_surface_are_off_is_said():
    ring = trimesh.creation.torus(1.0, 0.3)
    shape = Shape.from_mesh(ring.vertices, ring.faces[1:])  # hulls are bad at rings
    words = shape.with_volume("hull").notes[-1]
    value = float(words.rpartition("by '--volume winding' it is ")[2])
    assert value == pytest.approx(ring.volume, rel=0.05)
    assert shape.with_volume("hull").volume > 1.3 * ring.volume


def touching_cubes():
    """Two cubes that have one edge in common: four faces meet there, two each way."""
    return shapes.joined(shapes.cube(), shapes.moved(shapes.cube(), np.eye(3), 1, (1, 1, 0)))


@pytest.mark.parametrize(
    "mesh",
    [
        shapes.sphere(1),
        shapes.cube_without_lid(),
        (shapes.cube()[0], [face[::-1] for face in shapes.cube()[1]]),
        touching_cubes(),
    ],
    ids=["closed", "open", "inside out", "touching"],
)
def test_a_winding_volume_of_faces_that_are_oriented_alike_is_not_doubted(mesh):
    shape = Shape.from_mesh(*mesh).with_volume("winding")
    assert shape.notes[-1].endswith("where its surface winds more than half around")


@pytest.mark.parametrize("volume", ["hul", "", 0, -1.0, "nan", float("inf"), None, True])
def test_volumes_that_are_none(volume):
    with pytest.raises(UsageError, match="positive number in model units cubed, 'hull' or 'wind"):
        Shape.from_points(np.eye(3)).with_volume(volume)


@pytest.mark.parametrize(
    ("made", "how", "message"),
    [
        (Shape.from_points(np.eye(3)), "hull", "is flat"),
        (Shape.from_points(shapes.rectangle(nx=9, ny=4)[0]), "hull", "is flat"),
        (Shape.from_mesh(*shapes.rectangle()), "winding", "is flat"),
        (Shape.from_points(shapes.cube()[0]), "winding", "no normals"),
        (
            Shape.from_mesh(*shapes.joined(shapes.rectangle(), shapes.moved(
                shapes.rectangle(), np.eye(3), 1.0, (0, 0, 9)))),
            "winding",
            "no place",
        ),
    ],
)  # fmt: skip
def test_shapes_without_a_volume_to_estimate(made, how, message):
    with pytest.raises(ShapeError, match=message):
        made.with_volume(how)
