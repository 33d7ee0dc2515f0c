"""Labellings by the batch: each row is that of the labelling alone, to the last bit."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.labellings import Labellings, Summary
from moseg_core.errors import ShapeError
from moseg_core.shape import gaps, part_sums, row_threads
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.gaps import least_distance
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.components.test_field import Heights, capsule


def levels():
    fine = capsule()
    points = fine.points
    block = np.ones((4, 3, 3), np.bool_)
    return {
        "mesh": fine,
        "coarse": coarsen(fine, 20),
        "cloud": Shape.from_points(points, adjacency="knn"),
        "voxels": Shape.from_voxels(block, pitch=0.5),
    }


LEVELS = levels()
LOOKUP = Heights()
"""One for all, since fields are kept with shapes by their ids."""


def labelled(level, labels, n):
    return Labellings.of(level, np.array(labels, np.int32), n, LOOKUP)


def tables(found, wanted):
    """All that is known of the parts, in arrays whose first axis counts labellings."""
    summary = found.summary
    scales, axes = found.axes(wanted & (found.areas > 0))
    return {
        "counts": summary.counts,
        "hashes": summary.hashes,
        "moments": summary.moments,
        "empty": summary.empty(found.level.input),
        "field": found.field("height", {"factor": 2.0}, wanted),
        "scales": scales,
        "axes": axes,
        "around": found.lengths()[0],
        "between": found.lengths()[1],
        "field around": found.integrals("height", {})[0],
        "field between": found.integrals("height", {})[1],
        "gaps": np.reshape(
            [
                found.gap(b, i, j)
                for b, i, j in itertools.product(*map(range, found.lengths()[1].shape))
            ],
            found.lengths()[1].shape,
        ),
    }


def assert_rows_are_those_alone(level, labels, n):
    together = labelled(level, labels, n)
    wanted = np.random.default_rng(1).random((len(labels), n)) < 0.7
    wanted[0] = True
    found = tables(together, wanted)
    areas = together.areas > 0
    for b, row in enumerate(labels):
        alone = tables(labelled(level, row[None], n), wanted[b : b + 1])
        for name, table in alone.items():
            if name in ("field", "scales", "axes"):
                rows = wanted[b] & (areas[b] if name != "field" else True)
                assert found[name][b][rows].tobytes() == table[0][rows].tobytes(), name
            else:
                assert found[name][b].tobytes() == table[0].tobytes(), name


@given(st.sampled_from(list(LEVELS)), st.integers(1, 5), st.integers(1, 6), st.integers(0, 99))
@settings(max_examples=40, deadline=None)
def test_each_row_is_that_of_the_labelling_alone(name, count, n, seed):
    level, rng = LEVELS[name], np.random.default_rng(seed)
    highest = rng.integers(1, n + 1, (count, 1))  # some parts are left without elements
    assert_rows_are_those_alone(level, rng.integers(0, highest, (count, level.n_elements)), n)


@pytest.mark.parametrize("name", LEVELS)
def test_threads_change_nothing(name, monkeypatch):
    monkeypatch.setattr(row_threads, "_WORTH_THREADS", 0.0)
    monkeypatch.setattr(row_threads, "available_processors", lambda: 3)
    level = LEVELS[name]
    labels = np.random.default_rng(3).integers(0, 3, (7, level.n_elements))
    assert_rows_are_those_alone(level, labels, 3)


def test_sums_of_one_labelling_are_those_of_a_batch_of_one():
    for level in LEVELS.values():
        labels = (np.arange(level.n_elements) % 3).astype(np.int32)
        one, several = Summary.of(level, labels, 4), Summary.of(level, labels[None], 4)
        for name in ("counts", "hashes", "moments"):
            assert getattr(one, name).tobytes() == getattr(several.row(0), name).tobytes()
        assert one.counts.sum() == level.input.n_elements
        assert one.empty(level).tolist() == several.empty(level)[0].tolist() == [False] * 3 + [True]


def test_parts_without_elements_or_area_are_empty():
    # The third triangle has no area.
    flat = Shape.from_mesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 2, 0]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]]
    )
    found = labelled(flat, [[0, 1, 2], [0, 0, 1], [2, 2, 2]], 3)
    assert found.summary.empty(flat).tolist() == [
        [False, False, True],
        [False, True, True],
        [True, True, False],
    ]
    assert found.areas.tolist() == [[0.5, 0.5, 0], [1, 0, 0], [0, 0, 1]]


def test_a_batch_of_nothing():
    for level in LEVELS.values():
        found = labelled(level, np.empty((0, level.n_elements)), 3)
        assert len(found) == 0
        for name, table in tables(found, np.empty((0, 3), np.bool_)).items():
            assert table.shape[0] == 0, name
            assert table.shape[1:2] == (3,), name


def test_rows_that_are_asked_for_later_are_added():
    level, passes = LEVELS["mesh"], Heights()
    labels = np.random.default_rng(5).integers(0, 3, (2, level.n_elements))
    all_at_once = labelled(level, labels, 3)
    everything = np.ones((2, 3), np.bool_)
    bit_by_bit = Labellings.of(level, labels.astype(np.int32), 3, passes)
    first = np.array([[True, False, False], [False, False, True]])
    bit_by_bit.field("height", {}, first)
    bit_by_bit.axes(first)
    field = bit_by_bit.field("height", {}, everything)
    assert field.tobytes() == all_at_once.field("height", {}, everything).tobytes()
    for one, two in zip(bit_by_bit.axes(everything), all_at_once.axes(everything), strict=True):
        assert one.tobytes() == two.tobytes()


def test_what_is_asked_for_a_second_time_is_computed_of_all_parts_at_once(monkeypatch):
    level, n = LEVELS["coarse"], 4
    rows = [np.arange(level.n_elements) % n, np.arange(level.n_elements) % n]
    rows.append(np.where(rows[0] == 2, 1, rows[0]))  # in the last, part 2 is empty
    found = labelled(level, np.array(rows), n)
    computed = []
    summarize = part_sums.summarize_field

    def counted(labels, wanted, *rest):
        computed.extend(np.argwhere(wanted).tolist())
        summarize(labels, wanted, *rest)

    monkeypatch.setattr(part_sums, "summarize_field", counted)
    for part, expected in ((0, 1), (1, 5), (3, 5)):
        wanted = np.zeros((3, n), np.bool_)
        wanted[:1, part] = True  # the others have the same members
        found.field("height", {"factor": 3.0}, wanted)
        # Part 2 of the last is empty, so is none; part 1 of the last has other members.
        assert len(computed) == expected
    assert sorted(computed) == [[0, 0], [0, 1], [0, 2], [0, 3], [2, 1]]
    alone = labelled(level, rows[:1], n).field("height", {"factor": 3.0}, np.ones((1, n), bool))
    assert (found.field("height", {"factor": 3.0}, np.zeros((3, n), bool))[:1] == alone).all()


def test_views_in_other_spaces():
    fine = LEVELS["mesh"]
    stretched = fine.deformed(fine.geometry.vertices * [2.0, 1.0, 1.0], space="stretched")
    labels = np.random.default_rng(7).integers(0, 3, (2, fine.n_elements))
    found = labelled(stretched, labels, 3)
    view = found.view("original")
    assert found.view("stretched") is found
    assert found.view("original") is view
    assert view.level is stretched.in_space("original")
    expected = labelled(fine, labels, 3)
    wanted = np.ones((2, 3), np.bool_)
    for name, table in tables(expected, wanted).items():
        assert tables(view, wanted)[name].tobytes() == table.tobytes(), name
    assert not np.allclose(view.areas, found.areas)
    with pytest.raises(ShapeError):
        found.view("elsewhere")


def test_boundaries_need_to_know_what_touches():
    cloud = Shape.from_points(shapes.sphere(1)[0])
    with pytest.raises(ShapeError):
        labelled(cloud, np.zeros((1, cloud.n_elements)), 1).lengths()


def test_a_gap_that_several_labellings_have_is_measured_once(monkeypatch):
    asked = []

    def counted(points, labels, one, other):
        asked.append((one, other))
        return least_distance(points, labels, one, other)

    monkeypatch.setattr(gaps, "least_distance", counted)
    level = LEVELS["mesh"]
    labels = np.zeros((3, level.n_elements), np.int32)
    labels[:, :3], labels[:, 3:6] = 1, 2
    labels[2, 6:9] = 2  # another third part
    found = labelled(level, labels, 3)
    values = [found.gap(b, 1, 2) for b in range(3)] + [found.gap(b, 2, 1) for b in range(3)]
    assert asked == [(1, 2), (1, 2)]
    assert values[:3] == values[3:]
    assert values[0] == values[1] >= values[2] > 0
