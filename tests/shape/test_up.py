"""Which way is up, as far as anybody knows."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.errors import UsageError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from moseg_core.shape.up import checked_up, turn_to_y, up_direction
from tests.shapes import sphere

BALL = Shape.from_mesh(*sphere(3))


def test_an_axis_by_its_name_and_its_direction():
    for name, direction in (("x", [1, 0, 0]), ("-y", [0, -1, 0]), ("z", [0, 0, 1])):
        assert up_direction(checked_up(name)).tolist() == direction
    with pytest.raises(UsageError, match="unknown axis 'up'; known: -x, -y, -z, x, y, z"):
        checked_up("up")


def test_it_is_not_known_unless_somebody_says_so():
    assert BALL.up is None
    standing = BALL.with_up("z")
    assert standing.up == "z"
    assert standing.with_up(None).up is None
    assert standing.with_up("z") is standing


def test_what_is_made_of_a_shape_stands_as_it_does():
    standing = BALL.with_up("-x")
    for made in (
        standing.with_volume("hull"),
        standing.with_adjacency("knn"),
        standing.with_weld(1e-6),
        coarsen(standing, 40),
        subshape(standing, np.arange(30)),
        Shape.from_voxels(np.ones((3, 3, 3), bool)).with_up("-x").with_elements("surface"),
    ):
        assert made.up == "-x", made
    # An embedding may lie anyhow; what it was made from is still known.
    bent = standing.deformed(standing.geometry.vertices * [1, 1, 2], space="long")
    assert (bent.up, bent.original.up) == (None, "-x")


AXES = {"x": 0, "y": 1, "z": 2}


@pytest.mark.parametrize("up", ["x", "-x", "y", "-y", "z", "-z"])
def test_the_axis_comes_to_lie_on_y(up):
    turn = turn_to_y(up)
    axis = np.zeros(3)
    axis[AXES[up[-1]]] = -1.0 if up[0] == "-" else 1.0
    assert (turn @ axis).tolist() == [0.0, 1.0, 0.0]
    np.testing.assert_array_equal(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert set(np.unique(turn)) <= {-1.0, 0.0, 1.0}


def test_nothing_turns_where_y_is_up_or_nothing_is_known():
    for up in ("y", None):
        np.testing.assert_array_equal(turn_to_y(up), np.eye(3))
