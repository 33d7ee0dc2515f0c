"""Numbers and words that are labels, and those that are none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.io.labels.listing import (
    Wanted,
    labels_of_ids,
    middles,
    numbered_names,
    whole_labels,
)
from moseg_core.shape.shape import Shape
from tests import shapes

PATH = Path("folder/x.any")
DTYPES = ["i1", "i2", ">i4", "i8", "f4", "f8", ">f8"]


@given(labels=st.lists(st.integers(-1, 100), min_size=1, max_size=20), kind=st.sampled_from(DTYPES))
def test_whole_numbers_are_labels_however_they_are_stored(labels, kind):
    found = whole_labels(PATH, np.array(labels, kind))
    assert found.dtype == np.int64
    assert found.tolist() == labels


@pytest.mark.parametrize("kind", ["u4", "u8", ">u4"])
def test_the_greatest_unsigned_number_is_minus_one(kind):
    numbers = np.array([3, -1, 0]).astype(kind)
    assert whole_labels(PATH, numbers).tolist() == [3, -1, 0]


def test_a_byte_of_255_is_a_label():
    assert whole_labels(PATH, np.array([0, 255], np.uint8)).tolist() == [0, 255]


@pytest.mark.parametrize(
    ("numbers", "message"),
    [
        ([0, 0.5], "x.any gives face 1 the label 0.5; labels are whole numbers"),
        ([np.inf], "x.any gives face 0 the label inf; labels are whole numbers"),
        ([1e300], "x.any gives face 0 the label 1e+300; labels are whole numbers"),
        ([0, -2], "x.any gives face 1 the label -2; labels count from 0, and -1 stands where"),
        (["a"], "x.any holds <U1 instead of whole numbers"),
        (np.array([2**63], np.uint64), "x.any gives face 0 the label 9223372036854775808; labels"),
    ],
)
def test_numbers_that_are_no_labels_are_named(numbers, message):
    with pytest.raises(ShapeError) as caught:
        whole_labels(PATH, np.array(numbers), noun="face")
    assert str(caught.value).startswith(message)


def test_where_a_wrong_number_stands_is_said_by_its_line():
    with pytest.raises(
        ShapeError, match=r"^x.any, line 12: the label -2 is negative; labels count"
    ):
        whole_labels(PATH, np.array([0, -2]), line_of=lambda k: 11 + k)


def test_words_that_say_that_there_is_no_label():
    labels, names = numbered_names(["b", None, "", " NaN ", "Unlabelled", "a", " b ", "none"])
    assert labels.tolist() == [0, -1, -1, -1, -1, 1, 0, -1]
    assert names == ("b", "a")


def test_ids_count_from_one_only_where_they_must():
    def listed(*ids):
        return labels_of_ids(PATH, [(4, "leg", np.array(ids))], 3, noun="face")

    labels, notes = listed(1, 2)
    assert (labels.tolist(), notes) == ([-1, 4, 4], ())
    labels, notes = listed(1, 3)
    assert (labels.tolist(), notes) == ([4, -1, 4], ("x.any counts faces from 1",))
    for ids in ((0, 3), (-1, 2), (4,)):
        with pytest.raises(ShapeError, match=r"gives the label .leg. to face .*, but there are 3"):
            listed(*ids)
    with pytest.raises(ShapeError, match="gives face 2 the label 'leg' and the label 'leg'"):
        listed(2, 2)


def test_what_is_wanted_of_a_shape():
    cloud = Shape.from_points(np.eye(3))
    alone = Wanted.of(7)
    assert (alone.n_elements, alone.n_vertices, alone.noun) == (7, None, "element")
    assert Wanted.of(cloud, ["a"]).properties == ("a",)
    assert Wanted.of(cloud).noun == "point"


def test_middles_are_those_of_the_corners_of_polygons():
    vertices, faces = shapes.prism(5)
    mesh = Shape.from_mesh(vertices, faces).geometry
    expected = [np.mean([vertices[v] for v in face], axis=0) for face in faces]
    np.testing.assert_allclose(middles(mesh), expected, atol=1e-12)
