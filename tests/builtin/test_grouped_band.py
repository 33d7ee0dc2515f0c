"""Groups of the elements of a band: connected, of one label, and of the same energy."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.band import Band
from moseg_core.builtin.graph_cut import count_pieces
from moseg_core.builtin.grouped_band import GroupedBand
from moseg_core.builtin.swaps import Energy
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from tests import shapes

N = 4
SHAPE = Shape.from_mesh(*shapes.jitter(shapes.sphere(3), 3, 0.01))
LABELS = (np.arctan2(SHAPE.points[:, 0], SHAPE.points[:, 1]) // 1.6 % N).astype(np.int32)


def grouped(most, *, pins=NO_PINS, width=0.2):
    rng = np.random.default_rng(0)
    band = Band.of(SHAPE, LABELS, N, width=width, pins=pins)
    costs = np.where(np.isfinite(band.distances), rng.random(band.distances.shape), np.inf)
    energy = Energy(
        costs=costs,
        first=band.first,
        second=band.second,
        weights=rng.random(len(band.links)),
    )
    return band, energy, GroupedBand.of(SHAPE, LABELS, band, energy, most=most)


@pytest.mark.parametrize("most", [10, 60, 10_000])
def test_groups_are_connected_have_one_label_and_are_free_as_a_whole(most):
    pins = Pins(elements=np.array([5, 70]), labels=LABELS[[5, 70]].astype(np.int64))
    band, energy, groups = grouped(most, pins=pins)
    count = len(groups.labels)
    assert sorted(set(groups.members.tolist())) == list(range(count))
    assert (groups.labels[groups.members] == LABELS).all()
    assert (count_pieces(SHAPE.links, groups.members.astype(np.int32), count) == 1).all()
    free = np.zeros(SHAPE.n_elements, bool)
    free[band.elements] = np.isfinite(energy.costs).sum(axis=1) > 1
    assert not free[pins.elements].any()
    share = np.bincount(groups.members, free) / np.bincount(groups.members)
    assert set(share.tolist()) == {0.0, 1.0}
    assert (groups.elements == np.unique(groups.members[band.elements])).all()


@pytest.mark.parametrize("most", [10, 60])
def test_a_labelling_of_groups_costs_what_that_of_their_elements_does(most):
    band, energy, groups = grouped(most)
    allowed = np.isfinite(groups.energy.costs)
    assert (allowed.sum(axis=1) > 1).any()
    for seed in range(5):
        rng = np.random.default_rng(seed)
        labels = groups.labels.copy()
        labels[groups.elements] = [rng.choice(np.flatnonzero(row)) for row in allowed]
        of_groups = groups.energy.of(labels[groups.elements].astype(np.int64))
        of_elements = energy.of(labels[groups.members][band.elements].astype(np.int64))
        assert of_groups == pytest.approx(of_elements, rel=1e-12)


def test_pieces_of_groups_are_those_of_elements():
    _, _, groups = grouped(60)
    rng = np.random.default_rng(1)
    for _ in range(5):
        labels = rng.integers(0, N, len(groups.labels)).astype(np.int32)
        of_groups = count_pieces(groups.links, labels, N)
        assert (of_groups == count_pieces(SHAPE.links, labels[groups.members], N)).all()
        assert of_groups.max() > 1
