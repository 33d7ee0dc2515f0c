"""What the data of a shape say of it: its versions, its super-elements, what tells it apart."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest

import moseg_core as moseg
from moseg_core.errors import ShapeError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.data import Frame
from moseg_core.shape.shape import Shape
from tests import shapes

BALL = Shape.from_mesh(*shapes.sphere(3), name="ball")
BENT = BALL.deformed(BALL.geometry.vertices * [1, 1, 2], space="tall")


def test_a_frame_goes_there_and_back():
    frame = Frame(np.array([1.0, 2.0, 3.0]), 4.0)
    points = np.array([[1.0, 2.0, 3.0], [5.0, 2.0, 3.0]])
    assert frame.to_unit(points).tolist() == [[0, 0, 0], [1, 0, 0]]
    assert frame.to_model(frame.to_unit(points)).tolist() == points.tolist()


def test_the_versions_of_a_shape():
    assert BALL.in_space("original") is BALL
    assert BENT.in_space("tall") is BENT
    assert BENT.in_space("original") is BALL
    with pytest.raises(ShapeError, match="'ball' is not known in the space 'wide'"):
        BENT.in_space("wide")


def test_super_elements_stand_for_input_elements():
    coarse = coarsen(BALL, 40)
    assert coarse.input is BALL
    assert BALL.input is BALL
    assert coarse.sizes.tolist() == np.bincount(coarse.members).tolist()
    assert BALL.sizes.tolist() == [1] * BALL.n_elements
    some = np.array([3, 7])
    assert coarse.expand(some).tolist() == np.flatnonzero(np.isin(coarse.members, some)).tolist()
    assert BALL.expand(some) is some
    with np.errstate(over="ignore"):
        for element in (0, 5):
            inside = BALL.element_hashes[coarse.members == element]
            assert (coarse.element_hashes[element] == inside.sum(axis=0)).all()
    assert BALL.hull_corners is None
    assert coarse.hull_corners is not None


def test_what_tells_shapes_apart():
    known = [
        BALL,
        BENT,
        coarsen(BALL, 40),
        coarsen(BALL, 30),
        BALL.with_adjacency("knn"),
        BALL.with_adjacency("none"),
        BALL.with_volume(4.0),
        BALL.with_volume(BALL.volume),  # the same value, but known otherwise
        BALL.with_up("z"),
        Shape.from_mesh(*shapes.sphere(2)),
    ]
    assert len({shape.key for shape in known}) == len(known)
    again = Shape.from_mesh(*shapes.sphere(3), name="another name")
    assert again.key == BALL.key


def test_what_is_printed():
    assert repr(BALL) == "Shape(ball: 1280 elements, area 12.5065, volume 4.15274)"
    assert repr(Shape.from_mesh(*shapes.disc())).endswith("no volume)")
    assert repr(coarsen(BALL, 40)).endswith(", coarse40)")


def test_what_was_asked_of_one_version_is_made_of_another():
    shape = moseg.load(moseg.sample_path("hammer"))
    coarse = moseg.coarsen(shape, 50)
    coarse.make_ready(like=shape)
    assert not {"hull_corners", "links"} & vars(coarse).keys()
    assert {"element_hashes", "key"} <= vars(coarse).keys()
    assert shape.hull_corners is None
    coarse.make_ready(like=shape)
    assert "hull_corners" in vars(coarse)
    assert "links" not in vars(coarse)


def test_a_fingerprint_is_of_all_arrays_one_after_the_other():
    shape = Shape.from_voxels(np.ones((2, 3, 4), bool))
    geometry = shape.geometry
    digest = hashlib.sha256()
    for array in (geometry.vertices, geometry.corners, geometry.offsets):
        digest.update(array.tobytes())
    digest.update(b"voxel grid" + shape.areas.tobytes())
    assert shape.fingerprint == digest.hexdigest()[:16]
