"""Arrays of parts: what they say of each part is what the part says itself."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.memo import Memo
from moseg_core.components.part import measure_key
from moseg_core.components.part_array import PartArray
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ShapeError
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.components.test_labellings import LEVELS, LOOKUP, labelled


def close(value):
    return pytest.approx(value, rel=1e-12, abs=1e-12)


def arrayed(level, labels, n, calls):
    """An array of parts, and the parts themselves: by call one, or a list of several."""
    rows = np.array([b for b, _ in calls])
    parts = np.array([numbers for _, numbers in calls])
    array = PartArray(_labellings=labelled(level, labels, n), _rows=rows, _parts=parts)
    alone = [Segmentation.from_labels(level, row, n, lookup=LOOKUP).parts for row in labels]
    own = [
        [alone[b][k] for k in numbers] if isinstance(numbers, tuple) else alone[b][numbers]
        for b, numbers in calls
    ]
    return array, own


def assert_same(values, part, at):
    """What an array says at a place, against a part."""
    array, field = values
    assert array.areas[at] == part.area
    assert array.centroids[at].tolist() == part.centroid.tolist()
    assert array.scales[at].tolist() == part.scales.tolist()
    assert array.axes[at].tolist() == part.axes.tolist()
    assert [column[at] for column in field] == list(part.field("height", factor=2.0))
    assert array.boundary_lengths[at] == part.boundary.length
    mean = array.boundary_means("height")[at]
    if part.boundary.length > 0:
        assert mean == part.boundary.mean("height")
    else:
        assert math.isnan(mean)


def random_labels(level, seed, n):
    """Two labellings at random, none of whose parts is empty."""
    rng = np.random.default_rng(seed)
    rest = rng.integers(0, n, (2, level.n_elements - n))
    return np.concatenate([np.tile(np.arange(n), (2, 1)), rest], axis=1)


@given(st.sampled_from(list(LEVELS)), st.integers(1, 4), st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_of_single_parts_it_says_what_each_says(name, n, seed):
    level = LEVELS[name]
    calls = [(b, k) for b in range(2) for k in range(n)]
    calls = [calls[k] for k in np.random.default_rng(seed).permutation(len(calls))][: n + 1]
    array, parts = arrayed(level, random_labels(level, seed, n), n, calls)
    field = array.field("height", factor=2.0)
    assert len(array) == len(calls)
    assert (array.level, array.shape) == (level, level.input)
    assert array.field_of_shape("height") == parts[0].field_of_shape("height")
    for call, part in enumerate(parts):
        assert_same((array, field), part, call)


@given(st.sampled_from(list(LEVELS)), st.integers(2, 4), st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_of_several_parts_of_a_call_it_says_what_each_says(name, m, seed):
    level = LEVELS[name]
    rng = np.random.default_rng(seed)
    calls = [(b, tuple(rng.permutation(4)[:m].tolist())) for b in (1, 0, 1)]
    array, parts = arrayed(level, random_labels(level, seed, 4), 4, calls)
    field = array.field("height", factor=2.0)
    assert array.areas.shape == array.boundary_lengths.shape == field.mean.shape == (3, m)
    assert array.lengths_between.shape == (3, m, m)
    for call, several in enumerate(parts):
        for j, part in enumerate(several):
            assert_same((array, field), part, (call, j))
            assert array.lengths_between[call, j, j] == 0
        for i, j in itertools.permutations(range(m), 2):
            between = several[i].boundary_with(several[j]).length
            assert array.lengths_between[call, i, j] == between
            assert array.distance(call, i, j) == several[i].distance_to(several[j])


@pytest.mark.parametrize("name", LEVELS)
def test_of_whole_segmentations_it_says_what_each_says(name):
    level = LEVELS[name]
    labels = random_labels(level, 11, 3)
    calls = [(b, (0, 1, 2)) for b in range(2)]
    array, _ = arrayed(level, labels, 3, calls)
    for call, row in enumerate(labels):
        whole = Segmentation.from_labels(level, row, 3, lookup=LOOKUP)
        assert array.areas[call].tolist() == whole.areas.tolist()
        assert array.boundary_lengths[call].tolist() == whole.boundaries.around.tolist()
        assert array.lengths_between[call].tolist() == whole.boundaries.lengths.tolist()
        means = array.boundary_means("height")[call]
        assert means.tolist() == whole.boundaries.means_around("height").tolist()
        summaries = whole.fields("height")
        assert array.field("height").spread[call].tolist() == [each.spread for each in summaries]


def test_arrays_that_others_read_too_cannot_be_written_to():
    level = LEVELS["mesh"]
    array, _ = arrayed(level, random_labels(level, 2, 2), 2, [(0, (0, 1))])
    for name in (
        *("areas", "centroids", "scales", "axes"),
        *("boundary_lengths", "lengths_between"),
    ):
        values = getattr(array, name)
        assert getattr(array, name) is values
        with pytest.raises(ValueError, match="read-only"):
            values[:] = 0
    array.field("height").mean[:] = np.nan  # a copy
    array.boundary_means("height")[:] = np.nan
    assert np.isfinite(array.field("height").mean).all()
    assert np.isfinite(array.boundary_means("height")).all()


def test_on_a_coarse_shape_it_is_about_the_user_s():
    coarse = LEVELS["coarse"]
    labels = random_labels(coarse, 4, 3)
    array, _ = arrayed(coarse, labels, 3, [(0, 0), (1, 2)])
    fine, _ = arrayed(LEVELS["coarse"].input, labels[:, coarse.members], 3, [(0, 0), (1, 2)])
    for name in ("areas", "centroids", "scales", "boundary_lengths"):
        assert getattr(array, name) == close(getattr(fine, name)), name
    assert array.field("height").mean == close(fine.field("height").mean)
    assert repr(array) == f"PartArray(2 parts of {coarse.input.name})"


def test_a_shape_that_lacks_neighbours_is_named():
    cloud = Shape.from_points(shapes.sphere(1)[0])
    array, _ = arrayed(cloud, random_labels(cloud, 0, 2), 2, [(0, (0, 1))])
    assert array.areas.shape == (1, 2)
    for ask in (
        lambda: array.boundary_lengths,
        lambda: array.lengths_between,
        lambda: array.boundary_means("height"),
    ):
        with pytest.raises(ShapeError):
            ask()


@given(st.sampled_from(list(LEVELS)), st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_least_hull_volumes_are_those_of_the_parts_whatever_else_is_asked(name, seed):
    level = LEVELS[name]
    labels = random_labels(level, seed, 3)
    array, _ = arrayed(level, labels, 3, [(b, (0, 1, 2)) for b in range(2)])
    all_of_them = array.least_hull_volumes(np.ones((2, 3), bool))
    assert (all_of_them >= 0.0).all()
    for b, k in itertools.product(range(2), range(3)):
        alone, _ = arrayed(level, labels[b : b + 1], 3, [(0, k)])
        assert alone.least_hull_volumes(np.ones(1, bool)).tolist() == [all_of_them[b, k]]
    some, _ = arrayed(level, labels, 3, [(b, (2, 0)) for b in range(2)])
    wanted = np.random.default_rng(seed).random((2, 2)) < 0.5
    found = some.least_hull_volumes(wanted)
    assert found[wanted].tolist() == all_of_them[:, [2, 0]][wanted].tolist()


def test_what_is_remembered_of_parts():
    level = next(iter(LEVELS.values()))
    labels, memo = random_labels(level, 0, 2), Memo()
    calls = [(0, (0, 1)), (1, (1, 0))]
    array, _ = arrayed(level, labels, 2, calls)
    assert np.isnan(array.remembered("basic:hull_volume")).all()
    array = replace(array, _memo=memo)
    assert np.isnan(array.remembered("basic:hull_volume")).all()
    first = Segmentation.from_labels(level, labels[0], 2, memo=memo, lookup=LOOKUP).parts[1]
    memo.get(measure_key(first.membership, level, "basic:hull_volume"), lambda: 2.5)
    found = array.remembered("basic:hull_volume")
    assert np.isnan(found).tolist() == [[True, False], [True, True]]
    assert found[0, 1] == 2.5
