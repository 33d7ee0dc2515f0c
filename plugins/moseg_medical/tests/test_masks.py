"""From arrays and affines to shapes: places, sizes and refusals."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from moseg_medical.examples import AFFINE, ell
from moseg_medical.masks import affine_of, label_map, shape_of_mask, stem_of

from moseg_core import Shape, ShapeError, UsageError
from moseg_core.testing.fixtures.results import result_on

PATH = Path("scan.nii")


def shape_of(values, affine=AFFINE):
    return shape_of_mask(PATH, values, affine, name="scan", header={})


def test_cells_are_where_the_affine_says():
    shape = shape_of(ell())
    indices = np.argwhere(ell())  # in C order, as the elements
    np.testing.assert_allclose(shape.points, indices @ AFFINE[:3, :3].T + AFFINE[:3, 3])
    cell = abs(np.linalg.det(AFFINE[:3, :3]))
    assert shape.volume == pytest.approx(len(indices) * cell)
    assert shape.solid
    np.testing.assert_allclose(affine_of(shape.geometry), AFFINE)


def test_all_that_is_not_0_is_the_shape_and_that_is_said():
    assert "2 labels (1, 2): all of them together are the shape" in shape_of(ell()).notes
    assert not [note for note in shape_of(ell() > 0).notes if "labels" in note]
    whole = shape_of(ell().astype(np.float32)[..., None])
    assert whole.n_elements == np.count_nonzero(ell())


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.linspace(0, 1, 8).reshape(2, 2, 2), "numbers that are not whole, as images do"),
        (np.full((2, 2, 2), np.nan), "numbers that are not whole"),
        (np.arange(-4, 4).reshape(2, 2, 2), "negative numbers"),
        (np.arange(1000).reshape(10, 10, 10), "999 different numbers"),
        (np.ones((2, 2, 2, 2), int), "a volume of 4 axes, 2 x 2 x 2 x 2"),
        (np.ones((2, 2), int), "a volume of 2 axes"),
        (np.zeros((2, 2, 2), int), "none of the 8 cells"),
        (np.ones((2, 2, 2), complex), "not numbers"),
    ],
)
def test_what_is_no_mask_is_refused_with_what_to_do(values, message):
    with pytest.raises(ShapeError, match=message) as caught:
        shape_of(values)
    assert str(caught.value).startswith("scan.nii")


def test_an_affine_of_a_plane_is_refused():
    with pytest.raises(ShapeError, match=r"scan\.nii: a grid needs a positive pitch"):
        shape_of(ell(), np.diag([1.0, 1.0, 0.0, 1.0]))


def test_parts_are_numbered_from_1():
    grid, numbers = label_map(result_on(shape_of(ell())), "NIfTI")
    assert numbers.dtype == np.uint8
    np.testing.assert_array_equal(numbers > 0, ell() > 0)
    count = grid.n_elements
    assert numbers[tuple(grid.cells.T)].tolist() == [1] * (count // 2) + [2] * (count - count // 2)


def test_cells_within_have_the_number_of_the_nearest_of_the_surface():
    mask = np.zeros((9, 7, 7), np.uint8)
    mask[1:8, 1:6, 1:6] = 1
    flat = np.diag([1.0, 1.0, 9.0, 1.0])
    surface = shape_of(mask, flat).with_elements("surface")
    halves = result_on(surface)
    grid, numbers = label_map(halves, "NIfTI")
    np.testing.assert_array_equal(numbers > 0, mask > 0)
    assert numbers[tuple(grid.cells.T)].tolist() == (halves.labels + 1).tolist()
    assert (numbers[2:4, 3, 3] == 1).all()
    assert (numbers[5:7, 3, 3] == 2).all()
    front = np.where(surface.geometry.cells[:, 2] == 1, 0, 1).astype(np.int32)
    _, numbers = label_map(result_on(surface, labels=front), "NIfTI")
    assert (numbers[2:7, 2:5, 2] == 2).all()  # the bottom is one cell away, but dearer than a side


def test_only_grids_have_label_maps():
    tile = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    with pytest.raises(UsageError, match="NIfTI holds the label map of a voxel grid"):
        label_map(result_on(tile), "NIfTI")


def test_stems():
    suffixes = (".nii", ".nii.gz")
    assert [stem_of(n, suffixes) for n in ("a.b.NII.GZ", "a.nii", "a")] == ["a.b", "a", "a"]
