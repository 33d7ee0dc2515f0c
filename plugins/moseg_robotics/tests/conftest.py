"""Results made by hand: a mallet of two boxes in one surface, far from the origin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from moseg_core import Problem, Result, Shape
from moseg_core.testing.fixtures.results import area, result_on

#: Where the mallet is.
PLACE = np.array([1000.0, 0.0, 50.0])


def _labelled(shape: Shape, labels: object, *names: str) -> Result:
    problem = Problem(list(names), f"area({names[0]})", objectives={"area": area})
    return replace(result_on(shape), problem=problem, labels=np.asarray(labels, np.int32))


@pytest.fixture(scope="session")
def labelled():
    """A function that makes a result of a shape, a labelling and names."""
    return _labelled


@pytest.fixture(scope="session")
def mallet() -> Result:
    """A handle of 4 x 1 x 1 along x and a head of 1 x 1 x 3 across its end, around `PLACE`."""
    cells = np.zeros((5, 1, 3), bool)
    cells[:, 0, 1] = cells[4] = True
    grid = Shape.from_voxels(cells).geometry
    middle = np.array([4.5, 0.5, 1.5])
    shape = Shape.from_mesh(grid.vertices - middle + PLACE, grid.triangles, name="mallet")
    return _labelled(shape, shape.points[:, 0] > PLACE[0] - 0.5 - 1e-9, "handle", "head")
