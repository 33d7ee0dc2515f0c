"""Corners of cells against tables of them, and what is left of them against convex hulls."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.spatial import ConvexHull

import moseg_core as moseg
from moseg_core.shape import cell_corners
from moseg_core.shape.cell_corners import NOTHING, corner_numbers, outer_points, used_points

sides = arrays.array_shapes(min_dims=3, max_dims=3, min_side=1, max_side=5)
grids = arrays.arrays(np.bool_, sides).filter(np.any)
groupings = arrays.arrays(np.int32, sides, elements=st.integers(NOTHING - 1, 2))


def corners_of(cell):
    return [tuple(np.add(cell, step).tolist()) for step in np.ndindex(2, 2, 2)]


def in_use(cells):
    """Lattice points that are corners, in C order."""
    return sorted({point for cell in np.argwhere(cells) for point in corners_of(cell)})


@given(cells=grids)
def test_points_in_use_are_the_corners_of_cells(cells):
    assert [tuple(point) for point in np.argwhere(used_points(cells)).tolist()] == in_use(cells)


@given(cells=grids, at_once=st.sampled_from([1, 3, 1000]))
def test_each_cell_has_its_eight_corners(cells, at_once):
    points = in_use(cells)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cell_corners, "_AT_ONCE", at_once)
        stretches = [*corner_numbers(cells)]
    assert max(map(len, stretches)) <= at_once
    found = [[points[k] for k in row] for row in np.concatenate(stretches).tolist()]
    assert found == [corners_of(cell) for cell in np.argwhere(cells)]


@given(groups=groupings)
def test_what_is_left_of_a_group_has_the_same_hull(groups):
    points = in_use(groups != NOTHING)
    owner, number = outer_points(groups)
    assert (np.diff(number) >= 0).all()
    assert len({*zip(owner.tolist(), number.tolist(), strict=True)}) == len(number)
    assert set(owner.tolist()) == set(groups[groups >= 0].tolist())
    for group in np.unique(owner).tolist():
        every = in_use(groups == group)
        left = [points[k] for k in number[owner == group]]
        assert set(left) <= set(every)
        assert ConvexHull(left).volume == pytest.approx(ConvexHull(every).volume)
        assert set(left) == {point for point in every if not between_others(point, set(every))}


def between_others(point, every):
    steps = set(itertools.product((-1, 0, 1), repeat=3)) - {(0, 0, 0)}
    return any(
        {tuple(np.add(point, step)), tuple(np.subtract(point, step))} <= every for step in steps
    )


def test_of_millions_of_cells_no_table_of_corners_is_kept():
    shape = moseg.Shape.from_voxels(np.ones((16, 16, 16), bool))
    coarse = moseg.coarsen(shape, 50)
    assert coarse.hull_corners is not None
    labels = (shape.points[:, 0] > 8).astype(np.int32)
    part = moseg.Segmentation.from_labels(shape, labels, 2).parts[0]
    assert len(part.extreme_vertices) == 8
    assert len(part.vertices) == 9 * 17 * 17
    assert shape.fingerprint == coarse.fingerprint
    assert "corners" not in vars(shape.geometry)
    assert "cells" not in vars(shape.geometry)
