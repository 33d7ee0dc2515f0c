"""The band: distances along the surface, to every part, and who may not go."""

from __future__ import annotations

import heapq

import numpy as np
import pytest

from moseg_core.builtin.band import Band, depths
from moseg_core.shape.pins import NO_PINS, Pins
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.sphere(2), 3, 0.02))
LABELS = (np.arctan2(SHAPE.points[:, 0], SHAPE.points[:, 1]) // 2.1 % 3).astype(np.int32)
WIDTH = 0.12


def band_of(labels=LABELS, *, shape=SHAPE, width=WIDTH, pins=NO_PINS, n=3):
    return Band.of(shape, labels, n, width=width, pins=pins)


def literal_ways(shape, begun):
    """Shortest ways from element to element, after the first steps that are given."""
    scale = shape.frame.scale
    found: dict[int, float] = {}
    queue = [(way, element) for element, way in begun.items()]
    heapq.heapify(queue)
    while queue:
        way, element = heapq.heappop(queue)
        if element in found:
            continue
        found[element] = way
        for other in shape.adjacency.neighbors(element).tolist():
            step = np.linalg.norm(shape.points[element] - shape.points[other]) / scale
            heapq.heappush(queue, (way + step, other))
    return found


def literal_begun(shape, labels, wanted):
    """Half a step for each element at a boundary between two labels that are wanted."""
    begun: dict[int, float] = {}
    for one, other in shape.adjacency.pairs.tolist():
        if labels[one] != labels[other] and wanted(labels[one], labels[other]):
            half = np.linalg.norm(shape.points[one] - shape.points[other]) / shape.frame.scale / 2
            begun[one] = min(begun.get(one, np.inf), half)
    return begun


def test_distances_are_the_shortest_ways_to_each_part():
    assert len(np.unique(LABELS)) == 3
    band = band_of()
    depth = literal_ways(SHAPE, literal_begun(SHAPE, LABELS, lambda own, other: True))
    deepest = [max(depth[e] for e in np.flatnonzero(k == LABELS)) for k in range(3)]
    ways = [
        literal_ways(SHAPE, literal_begun(SHAPE, LABELS, lambda own, other, k=k: other == k))
        for k in range(3)
    ]
    expected = np.full((SHAPE.n_elements, 3), np.inf)
    for element, own in enumerate(LABELS.tolist()):
        expected[element, own] = 0.0
        if depth[element] <= min(WIDTH, deepest[own] / 2):
            for k in range(3):
                if k != own and ways[k][element] <= WIDTH:
                    expected[element, k] = ways[k][element]
    found = np.full((SHAPE.n_elements, 3), np.inf)
    found[np.arange(SHAPE.n_elements), LABELS] = 0.0
    found[band.elements] = band.distances
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert np.isfinite(band.distances).sum() > len(band.elements) + 20


def test_links_are_those_of_the_shape_between_its_elements():
    band, links = band_of(), SHAPE.links
    assert (band.elements[band.first] == links.first[band.links]).all()
    assert (band.elements[band.second] == links.second[band.links]).all()
    inside = np.isin(links.first, band.elements) & np.isin(links.second, band.elements)
    assert len(band.links) == inside.sum()
    # Whatever may change has all of its neighbours in it.
    free = band.elements[(np.isfinite(band.distances)).sum(axis=1) > 1]
    touching = np.unique(SHAPE.adjacency.pairs[np.isin(SHAPE.adjacency.pairs[:, 0], free), 1])
    assert np.isin(touching, band.elements).all()


def test_pinned_elements_stay():
    free = band_of()
    movable = free.elements[np.isfinite(free.distances).sum(axis=1) > 1]
    pins = Pins(elements=movable[:4], labels=LABELS[movable[:4]].astype(np.int64))
    band = band_of(pins=pins)
    places = np.searchsorted(band.elements, movable)
    allowed = np.isfinite(band.distances[places]).sum(axis=1)
    assert (allowed[:4] == 1).all()
    assert (allowed[4:] > 1).all()


@pytest.mark.parametrize("width", [0.0, 0.05, 1.0, 9.0])
def test_of_every_part_something_stays_however_wide_the_band(width):
    labels = LABELS.copy()
    labels[5] = 3  # a part of one element
    band = band_of(labels, width=width, n=4)
    whole = np.ones(SHAPE.n_elements, bool)
    whole[band.elements[np.isfinite(band.distances).sum(axis=1) > 1]] = False
    assert set(labels[whole].tolist()) == {0, 1, 2, 3}


def test_a_shape_of_one_part_has_no_band():
    band = band_of(np.zeros(SHAPE.n_elements, np.int32), n=1)
    assert len(band.elements) == len(band.links) == 0


@pytest.mark.parametrize("limit", [0.05, 0.2, 10.0])
def test_depths_are_the_shortest_ways_from_any_boundary(limit):
    literal = literal_ways(SHAPE, literal_begun(SHAPE, LABELS, lambda own, other: True))
    expected = [literal[e] if literal[e] <= limit else np.inf for e in range(SHAPE.n_elements)]
    assert depths(SHAPE, LABELS, limit) == pytest.approx(np.array(expected))
    assert np.isinf(depths(SHAPE, np.zeros_like(LABELS), limit)).all()  # there is no boundary
