"""What a shape lacks is said in words, with what to do about it."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.requirements import LackError, demand, lack
from moseg_core.shape.shape import Shape

OPEN = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="leaf")
CLOUD = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]], name="dots")
BLOCK = Shape.from_voxels(np.ones((2, 2, 2), bool), name="block")


@pytest.mark.parametrize(
    ("shape", "requirement", "advice"),
    [
        (OPEN, "volume", "--volume VALUE|hull|winding"),
        (CLOUD, "adjacency", "--adjacency knn"),
        (CLOUD, "surface", "'dots' is a point cloud"),
        (BLOCK, "surface", "--voxels surface"),
    ],
)
def test_what_is_lacking_comes_with_advice(shape, requirement, advice):
    assert advice in lack(shape, requirement)


@pytest.mark.parametrize(
    ("shape", "requirement"),
    [
        (OPEN, "adjacency"),
        (OPEN, "surface"),
        (BLOCK, "volume"),
        (BLOCK, "adjacency"),
        (CLOUD.with_adjacency("knn"), "adjacency"),
    ],
)
def test_nothing_is_said_where_nothing_lacks(shape, requirement):
    assert lack(shape, requirement) is None


def test_what_else_to_do_is_said_by_who_demands():
    with pytest.raises(
        LackError, match=r"^glue needs to know which.*; use less or take the nearest"
    ):
        demand(CLOUD, ("adjacency",), "glue", instead="use less")
    demand(BLOCK, ("volume", "adjacency"), "glue")
