"""What columns of points mean, by their names and by what stands in them."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.io.read.point_columns import named_columns, passed_over, unnamed_columns

RNG = np.random.default_rng(0)
PLACE = RNG.normal(size=(50, 3)) * 9
NORMAL = PLACE / np.linalg.norm(PLACE, axis=1, keepdims=True)
COLOUR = RNG.integers(0, 256, (50, 3)).astype(float)
ONE = RNG.random((50, 1))
LABEL = RNG.integers(0, 2, (50, 1)).astype(float)
ONE_HOT = np.eye(3)[RNG.integers(0, 3, 50)]


@pytest.mark.parametrize(
    ("blocks", "first"),
    [
        ([NORMAL], 3),
        ([NORMAL, LABEL], 3),
        ([COLOUR, NORMAL], 6),
        ([ONE, NORMAL], 4),
        ([ONE, COLOUR, NORMAL, LABEL], 7),
        ([np.round(NORMAL, 2), COLOUR], 3),
        ([np.where(LABEL > 0, NORMAL, 0.0)], 3),
        ([np.where(LABEL > 0, NORMAL, np.nan)], 3),
        ([ONE_HOT], 3),  # a shape of planes along the axes
        ([LABEL, ONE_HOT], None),  # labels, one column each
        ([COLOUR], None),
        ([COLOUR / 255, ONE], None),
        ([ONE], None),
        ([LABEL, LABEL, LABEL, LABEL], None),
        ([0 * COLOUR], None),
        ([], None),
    ],
)
def test_normals_are_found_by_their_length(blocks, first):
    table = np.hstack([PLACE, *blocks])
    found = unnamed_columns(table.shape[1], lambda k: table[:, k])
    places = {"x": 0, "y": 1, "z": 2}
    normals = {} if first is None else {f"n{a}": first + k for k, a in enumerate("xyz")}
    assert found == places | normals


def test_columns_of_words_are_no_normals():
    table = np.hstack([PLACE, NORMAL, ONE, NORMAL])
    found = unnamed_columns(10, lambda k: None if k == 4 else table[:, k])
    assert found["nx"] == 7


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ("z y x", {"x": 2, "y": 1, "z": 0}),
        ("x_coord y_coord z_coord area", {"x": 0, "y": 1, "z": 2, "area": 3}),
        ("points_0 points_1 points_2", {"x": 0, "y": 1, "z": 2}),
        ("easting northing height", {"x": 0, "y": 1, "z": 2}),
        ("id normal_x normal_y normal_z", {"nx": 1, "ny": 2, "nz": 3}),
        ("a b c", {}),
    ],
)
def test_names_of_other_programs(names, found):
    assert named_columns(names.split()) == found


def test_of_many_columns_some_are_named():
    (note,) = passed_over(103, [0, 1, 2])
    assert note.endswith("14, 15 and 88 more")
    assert passed_over(3, [2, 1, 0]) == []
