"""Parts and deformed versions of shapes whose volume is exact, estimated, given or not known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from moseg_core.components.requirements import lack
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from tests import shapes

VERTICES, FACES = shapes.sphere(3)
BALL = Shape.from_mesh(VERTICES, FACES)
UPPER = np.flatnonzero(BALL.points[:, 2] > 0)
HALF = subshape(BALL, UPPER).volume  # 1.99; the rim of the half is jagged


def flipped(mesh, seed=0):
    """The mesh with half of its faces, at random, the other way round."""
    vertices, faces = mesh
    turned = np.random.default_rng(seed).random(len(faces)) < 0.5
    return vertices, [
        face[::-1] if turn else face for face, turn in zip(faces, turned, strict=True)
    ]


FLIPPED = Shape.from_mesh(*flipped((VERTICES, FACES)), name="ball")


def test_an_exact_volume_vouches_for_all_parts():
    assert BALL.volume_source == "exact"
    assert pytest.approx(2 * np.pi / 3, rel=0.06) == HALF
    part = subshape(BALL, UPPER)
    assert part.volume_source == "exact"
    quarter = subshape(part, np.flatnonzero(part.points[:, 0] > 0))
    assert quarter.volume_source == "exact"
    alone = subshape(BALL, UPPER[part.points[:, 0] > 0])
    assert quarter.volume == pytest.approx(alone.volume, rel=1e-12)


def test_a_part_of_a_shape_with_flipped_faces_is_estimated_by_hulls_afresh():
    whole = FLIPPED.with_volume("hull")
    assert whole.volume == pytest.approx(BALL.volume)
    part = subshape(whole, UPPER)
    assert part.volume_source == "hull"
    assert part.volume == pytest.approx(HALF, rel=0.06)
    # Its cut is closed: left open, the half is a bowl, and the hulls of its pieces are its wall's.
    hull = ConvexHull(part.geometry.vertices).volume
    assert part.volume == pytest.approx(hull, rel=1e-9)


def test_a_deformed_shape_with_flipped_faces_is_estimated_afresh():
    whole = FLIPPED.with_volume("hull")
    same = whole.deformed(whole.geometry.vertices, space="same")
    assert (same.volume, same.volume_source) == (pytest.approx(BALL.volume), "hull")
    tall = whole.deformed(whole.geometry.vertices * [1, 1, 2], space="tall")
    assert tall.volume == pytest.approx(2 * BALL.volume)
    part = subshape(whole, UPPER)
    bent = part.deformed(part.geometry.vertices * 2, space="twice")
    assert bent.volume_source == "hull"


def test_a_number_is_about_the_whole_alone():
    whole = FLIPPED.with_volume(4.2)
    assert whole.volume_source == "user"
    part = subshape(whole, UPPER, name="ball/upper")
    bent = whole.deformed(whole.geometry.vertices, space="same")
    for derived, where in ((part, "a part"), (bent, "the space 'same'")):
        assert (derived.volume, derived.volume_source) == (None, None)
        assert derived.volume_reason == (
            "its faces are not oriented consistently, and the number that was given for the whole"
            f" says nothing of {where}"
        )
        assert derived.volume_reason in lack(derived, "volume")


@pytest.mark.parametrize("volume", [None, "hull", "winding", 3.0])
def test_faces_that_are_oriented_alike_are_measured_whatever_was_asked_for(volume):
    vertices, faces = shapes.jitter(shapes.cube_without_lid(), 0, 0.1)
    bowl = Shape.from_mesh(vertices, shapes.fan((vertices, faces))[1])
    whole = bowl if volume is None else bowl.with_volume(volume)
    some = np.arange(bowl.n_elements - 2)
    part = subshape(whole, some)
    assert part.volume_source == "exact"
    assert part.volume == subshape(bowl, some).volume
    bent = whole.deformed(2 * whole.geometry.vertices, space="twice")
    if volume is None:
        assert bent.volume_reason == bowl.volume_reason
    else:
        everything = subshape(bowl, np.arange(bowl.n_elements))
        assert (bent.volume, bent.volume_source) == (
            pytest.approx(8 * everything.volume),
            "exact",
        )


def two_bowls(turn):
    """Two open boxes that do not touch, the second maybe inside out."""
    vertices, faces = shapes.cube_without_lid()
    away = vertices + np.array([0.0, 3.0, 0.0])
    second = away, [face[::-1] if turn else face for face in faces]
    return Shape.from_mesh(*shapes.joined((vertices, faces), second))


@pytest.mark.parametrize("turn", [False, True])
def test_pieces_that_may_be_oriented_against_each_other_are_not_added_up(turn):
    whole = two_bowls(turn)
    both = subshape(whole, np.arange(10))
    assert both.volume is None
    assert both.volume_reason == "its 2 pieces may be oriented against each other"
    assert subshape(whole, np.arange(5)).volume == pytest.approx(1.0)
    assert subshape(whole, np.arange(5, 10)).volume == pytest.approx(1.0)
    estimated = subshape(whole.with_volume("winding"), np.arange(10))
    assert estimated.volume_source == "winding"


@pytest.mark.parametrize("volume", ["hull", "winding", 3.0])
def test_a_part_that_is_closed_by_itself_is_measured(volume):
    whole = Shape.from_mesh(*shapes.two_boxes()).with_volume(volume)
    left = subshape(whole, np.flatnonzero(whole.points[:, 0] < 2.5))
    assert (left.volume, left.volume_source) == (pytest.approx(2.0), "exact")


def test_legs_of_a_surface_in_one_piece_are_added_up():
    vertices, faces = shapes.tee(6, 5)
    lidless = Shape.from_mesh(vertices, faces[1:])
    ends = np.flatnonzero((lidless.points[:, 0] < 1) | (lidless.points[:, 0] > 4))
    part = subshape(lidless, ends)
    assert part.adjacency.components()[0] == 2
    assert part.volume == pytest.approx(2.0)


def separate(mesh):
    """Each face with vertices of its own, a little smaller than its place."""
    vertices, faces = mesh
    corners = vertices[np.array(faces)]
    middle = corners.mean(axis=1, keepdims=True)
    soup = (middle + 0.95 * (corners - middle)).reshape(-1, 3)
    return Shape.from_mesh(soup, np.arange(len(soup)).reshape(len(faces), -1))


def test_parts_of_a_soup():
    soup = separate((VERTICES, FACES))
    hull, winding = (subshape(soup.with_volume(how), UPPER) for how in ("hull", "winding"))
    assert hull.volume is None
    assert "cuts cannot be closed" in hull.volume_reason
    assert winding.volume_source == "winding"
    assert winding.volume == pytest.approx(HALF, rel=0.1)
    assert subshape(soup, UPPER).volume_reason.startswith("its 624 pieces may be")


def test_parts_of_a_cloud():
    rng = np.random.default_rng(0)
    normals = rng.normal(size=(4000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    cloud = Shape.from_points(normals, normals=normals)
    upper = np.flatnonzero(normals[:, 2] > 0)
    winding = subshape(cloud.with_volume("winding"), upper)
    assert winding.volume_source == "winding"
    assert winding.volume == pytest.approx(2 * np.pi / 3, rel=0.1)
    assert "cuts cannot be closed" in subshape(cloud.with_volume("hull"), upper).volume_reason
    assert subshape(cloud, upper).volume_reason == "it is a point cloud"
    bare = Shape.from_points(normals).with_volume(4.0)
    assert "says nothing of a part" in subshape(bare, upper).volume_reason


def test_a_part_that_cannot_be_estimated_says_why():
    vertices, faces = flipped((VERTICES * [1, 1, 1e-3], FACES))
    ring = shapes.annulus()
    whole = Shape.from_mesh(*shapes.joined((vertices, faces), (ring[0] + 9.0, ring[1])))
    flat = subshape(whole.with_volume("winding"), np.arange(len(faces), whole.n_elements))
    assert flat.volume is None
    assert "flat" in flat.volume_reason


def test_parts_and_deformed_versions_are_joined_where_the_shape_is():
    loose = VERTICES[np.array(FACES).reshape(-1)]
    loose = loose + np.random.default_rng(0).uniform(-1e-10, 1e-10, loose.shape)
    ball = Shape.from_mesh(loose, np.arange(len(loose)).reshape(-1, 3))
    assert subshape(ball, UPPER).volume == pytest.approx(HALF)
    rng = np.random.default_rng(1)
    tall = loose * [1, 1, 2] + rng.uniform(-1e-7, 1e-7, loose.shape)
    assert ball.deformed(tall, space="tall").volume == pytest.approx(2 * BALL.volume, rel=1e-6)
