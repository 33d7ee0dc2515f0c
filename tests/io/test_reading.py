"""How shapes are read, as data: each field does what it says, and says it again."""

from __future__ import annotations

import json

import numpy as np
import pytest

from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.reading import Reading


@pytest.fixture
def grid(tmp_path):
    path = tmp_path / "grid.npy"
    np.save(path, np.ones((3, 3, 3), bool))
    return path


def test_a_grid_is_read_as_is_said(grid):
    assert Reading().read(grid).n_elements == 27
    found = Reading(voxels="surface", pitch=(1.0, 1.0, 3.0), up="z", adjacency="none").read(grid)
    assert found.n_elements == 26
    assert found.up == "z"
    assert found.adjacency is None


@pytest.mark.parametrize(
    "reading",
    [
        Reading(),
        Reading(pitch=(1.0, 2.0, 3.0), up="-x"),
        Reading(adjacency="knn", volume="3.5", weld=0.0, voxels="surface"),
        Reading(limit=("cells=none", "columns=5")),
    ],
)
def test_there_and_back(reading):
    assert Reading.of(json.loads(json.dumps(reading.document()))) == reading


def test_a_pitch_is_for_grids(tmp_path):
    path = tmp_path / "a.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    with pytest.raises(ShapeError):
        Reading(pitch=(1.0, 1.0, 1.0)).read(path)
    with pytest.raises(UsageError):
        Reading().read(tmp_path / "a.xyzzy")
