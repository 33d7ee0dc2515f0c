"""Labels that fit a shape, and what is said of those that do not."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.errors import ShapeError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from tests import shapes


@pytest.fixture
def two_faces():
    return PolygonMesh.from_faces(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]]
    )


@pytest.mark.parametrize("dtype", [np.uint8, np.int32, np.int64, np.uint64])
def test_labels_of_any_integer_type(two_faces, dtype):
    labels = np.array([1, 0], dtype)
    assert checked_labels(two_faces, labels, 2) is labels


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([0], r"each of the 2 faces, not an array of shape \(1,\)"),
        ([[0, 1]], "each of the 2 faces"),
        ([0, [1, 1]], "one number per face"),
        ([0.0, 1.0], "integers, not float64"),
        ([True, False], "integers, not bool"),
        (["a", "b"], "integers, not <U1"),
        ([0, 2], "face 1 has the label 2; allowed are 0 to 1"),
        ([-1, 0], "face 0 has the label -1"),
    ],
)
def test_labels_that_do_not_fit(two_faces, labels, message):
    with pytest.raises(ShapeError, match=message):
        checked_labels(two_faces, labels, 2)


def test_a_coarse_shape_has_as_many_labels_as_super_elements():
    ball = Shape.from_mesh(*shapes.sphere(3))
    coarse = coarsen(ball, 50)
    assert len(checked_labels(coarse, np.zeros(coarse.n_elements, int), 1)) == coarse.n_elements
    with pytest.raises(ShapeError, match=f"each of the {coarse.n_elements} faces"):
        checked_labels(coarse, np.zeros(ball.n_elements, int), 1)


def test_no_label_is_one_only_where_that_is_asked_for():
    mesh = Shape.from_mesh(*shapes.strip(3))
    with pytest.raises(ShapeError, match=r"allowed are 0 to 1$"):
        checked_labels(mesh, [0, -1, 1], 2)
    assert checked_labels(mesh, [0, -1, 1], 2, unlabelled=True).tolist() == [0, -1, 1]
    for wrong in (-2, 2):
        with pytest.raises(ShapeError, match="allowed are 0 to 1, and -1 where there is none"):
            checked_labels(mesh, [0, wrong, 1], 2, unlabelled=True)
