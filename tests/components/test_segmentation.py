"""Labellings and their parts: what is accepted, and which parts count as empty."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.memo import Memo
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ShapeError
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import membership_hash


@pytest.fixture(scope="module")
def tee():
    return Shape.from_mesh(*shapes.tee(), name="tee")


@pytest.mark.parametrize(
    ("labels", "message"),
    [
        ([0, 1], r"one label for each of the 46 faces, not an array of shape \(2,\)"),
        (np.zeros((46, 1), int), r"shape \(46, 1\)"),
        (3, r"shape \(\)"),
        (np.zeros(46), "labels must be integers, not float64"),
        (np.zeros(46, bool), "labels must be integers, not bool"),
        (["a"] * 46, "labels must be integers"),
        ([0] * 40 + [-1] * 6, "face 40 has the label -1; allowed are 0 to 2"),
        ([0] * 45 + [3], "face 45 has the label 3; allowed are 0 to 2"),
        (np.array([0] * 45 + [2**32]), "face 45 has the label 4294967296"),
    ],
)
def test_labels_that_do_not_fit_are_refused(tee, labels, message):
    with pytest.raises(ShapeError, match=message):
        Segmentation.from_labels(tee, labels, 3)


@pytest.mark.parametrize("dtype", [np.int8, np.uint64, np.int64, np.int32])
def test_labels_of_any_integer_type_are_taken(tee, dtype):
    labels = (np.arange(46) % 3).astype(dtype)
    found = Segmentation.from_labels(tee, labels, 3)
    assert found.labels.dtype == np.int32
    assert found.labels.tolist() == labels.tolist()


@given(st.integers(0, 2**32), st.integers(1, 7))
@settings(max_examples=40, deadline=None)
def test_the_parts_share_out_the_elements(seed, n):
    shape = Shape.from_mesh(*shapes.tee())
    labels = np.random.default_rng(seed).integers(0, n, shape.n_elements)
    parts = Segmentation.from_labels(shape, labels, n).parts
    assert len(parts) == n
    assert sum(part.area for part in parts) == pytest.approx(shape.area)
    for k, part in enumerate(parts):
        members = [f for f, label in enumerate(labels.tolist()) if label == k]
        assert part.elements.tolist() == members
        assert part.n_elements == len(members)
        assert part.membership == membership_hash(members)
        assert (part.points == shape.points[members]).all()
        assert (part.areas == shape.areas[members]).all()


def test_parts_without_elements_area_or_extent_are_empty():
    # Three proper faces, then a needle, a point, and a face too small to matter.
    vertices = [
        *[[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0], [5, 5, 0]],
        *[[2, 0, 0], [3, 3, 3], [3 + 1e-6, 3, 3], [3, 3 + 1e-6, 3]],
    ]
    faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 1, 5), (6, 6, 6), (6, 7, 8)]
    shape = Shape.from_mesh(vertices, faces)
    summary = Segmentation.from_labels(shape, [0, 0, 1, 3, 4, 5], 7).summary
    assert summary.counts.tolist() == [2, 1, 0, 1, 1, 1, 0]
    assert summary.empty(shape).tolist() == [False, False, True, True, True, True, True]
    # Together with a proper face they are part of something.
    whole = Segmentation.from_labels(shape, [0, 0, 1, 1, 1, 1], 2)
    assert not whole.summary.empty(shape).any()


def test_what_is_empty_does_not_depend_on_units():
    mesh = shapes.tee()
    labels = np.arange(46) % 2
    for scale in (1e-9, 1.0, 1e9):
        shape = Shape.from_mesh(*shapes.moved(mesh, np.eye(3), scale, [0, 0, 0]))
        empty = Segmentation.from_labels(shape, labels, 3).summary.empty(shape)
        assert empty.tolist() == [False, False, True]


def test_the_least_that_is_not_empty_still_has_a_length():
    # So that ratios of scales exist for every part that an objective may receive.
    emptiness = set()
    for seed, size in enumerate(np.geomspace(1e-8, 1e-5, 60)):
        # A sliver at random, at a corner of a far larger box.
        sliver = np.random.default_rng(seed).normal(size=(3, 3)) * size + [1.0, 1.0, 1.0]
        mesh = shapes.joined(shapes.cube(), (sliver, [(0, 1, 2)]))
        shape = Shape.from_mesh(*mesh)
        found = Segmentation.from_labels(shape, [0] * 6 + [1], 2)
        empty = bool(found.summary.empty(shape)[1])
        emptiness.add(empty)
        assert empty or found.parts[1].scales[0] > 0
    assert emptiness == {True, False}


def test_parts_share_the_memory_that_they_are_given(tee):
    memo = Memo()
    found = Segmentation.from_labels(tee, np.zeros(46, int), 2, memo=memo)
    assert all(part.memo is memo for part in found.parts)
    other = Segmentation.from_labels(tee, np.zeros(46, int), 2)
    assert other.memo is not memo


def test_a_part_is_made_once_and_only_when_asked_for(tee):
    segmentation = Segmentation.from_labels(tee, np.arange(46) % 3, 3)
    assert segmentation._made == {}
    second = segmentation.part(1)
    assert list(segmentation._made) == [1]
    assert segmentation.parts[1] is second
    assert [part.membership for part in segmentation.parts] == list(segmentation.memberships)
    assert [part.n_elements for part in segmentation.parts] == [16, 15, 15]
