"""Coarse shapes: connected pieces alike in size, whose parts are those of input elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.discovery.lookup import FoundMeasure
from moseg_core.components.memo import Memo
from moseg_core.components.segmentation import Segmentation
from moseg_core.shape import coarse as module
from moseg_core.shape.coarse import coarse_pins, coarsen
from moseg_core.shape.pins import Pins
from moseg_core.shape.shape import Shape
from tests import shapes

BALL = Shape.from_mesh(*shapes.jitter(shapes.sphere(3), 1, 0.01), name="ball")
CAPSULE = Shape.from_mesh(*shapes.bent_capsule(60, 24), name="capsule")
MADE = {
    "ball": BALL,
    "capsule of quads": CAPSULE,
    "two boxes": Shape.from_mesh(*shapes.two_boxes()),
    "soup": Shape.from_mesh(*shapes.soup(3, 400)),
}


@pytest.fixture(params=sorted(MADE))
def shape(request):
    return MADE[request.param]


def both(shape, seed, n=3, size=60):
    """The same parts, of super-elements and of input elements."""
    coarse = coarsen(shape, min(size, shape.n_elements // 2))
    labels = np.random.default_rng(seed).integers(0, n, coarse.n_elements)
    labels[:n] = np.arange(n)
    return (
        Segmentation.from_labels(coarse, labels, n),
        Segmentation.from_labels(shape, labels[coarse.members], n),
    )


def test_sums_are_kept(shape):
    coarse = coarsen(shape, 50)
    assert coarse.fine is shape
    assert coarse.input is shape
    assert coarse.resolution == "coarse50"
    assert sorted(np.unique(coarse.members)) == list(range(coarse.n_elements))
    for name in ("areas", "first_moments", "second_moments"):
        rows, found = getattr(shape, name), getattr(coarse, name)
        for k in range(coarse.n_elements):
            np.testing.assert_allclose(found[k], rows[coarse.members == k].sum(axis=0), atol=1e-13)
    np.testing.assert_allclose(
        coarse.points * coarse.areas[:, None],
        coarse.first_moments + coarse.areas[:, None] * shape.frame.center,
        atol=1e-12,
    )
    assert coarse.volume == shape.volume
    assert coarse.box_diagonal == pytest.approx(shape.box_diagonal, rel=1e-12)
    assert coarse.sizes.tolist() == np.bincount(coarse.members).tolist()


def test_pieces_are_connected_compact_and_alike():
    for shape in (BALL, CAPSULE):
        coarse = coarsen(shape, 60)
        assert coarse.n_elements == 60
        for k in range(60):
            assert shape.adjacency.components(np.flatnonzero(coarse.members == k))[0] == 1
        assert coarse.areas.max() < 2.5 * coarse.areas.mean()
        assert coarse.areas.min() > coarse.areas.mean() / 4
        # A disc of that area has the least mean squared reach, area / (2 pi).
        reach = ((shape.points - coarse.points[coarse.members]) ** 2).sum(axis=1)
        assert (shape.areas @ reach) / shape.area < 2 * coarse.areas.mean() / (2 * np.pi)


def test_super_elements_touch_where_their_members_do():
    coarse = coarsen(CAPSULE, 40)
    expected = {
        (coarse.members[f], coarse.members[g])
        for f in range(CAPSULE.n_elements)
        for g in CAPSULE.adjacency.neighbors(f)
        if coarse.members[f] != coarse.members[g]
    }
    found = {(k, g) for k in range(40) for g in coarse.adjacency.neighbors(k).tolist()}
    assert found == expected


def test_every_component_gets_a_piece():
    coarse = coarsen(Shape.from_mesh(*shapes.two_boxes()), 4)
    assert coarse.adjacency.components()[0] == 2


def test_many_bits_are_grouped_by_nearness():
    soup = MADE["soup"]
    coarse = coarsen(soup, 20)
    assert coarse.n_elements < 40
    assert len(coarse.adjacency.indices) == 0
    reach = np.linalg.norm(soup.points - coarse.points[coarse.members], axis=1)
    assert (
        reach.mean() < 0.5 * np.linalg.norm(soup.points - soup.points.mean(axis=0), axis=1).mean()
    )


def test_without_adjacency_elements_are_grouped_by_nearness():
    from dataclasses import replace

    coarse = coarsen(replace(BALL, adjacency=None), 60)
    assert coarse.adjacency is None
    assert 50 <= coarse.n_elements <= 70
    assert (
        Segmentation.from_labels(coarse, np.zeros(coarse.n_elements, int), 1).parts[0].n_components
        == 1
    )


def test_it_is_the_same_every_time(shape):
    first = coarsen(shape, 40)
    assert coarsen(shape, 40) is first  # kept with the shape
    anew = coarsen(replace(shape), 40)
    assert anew is not first
    assert anew.members.tolist() == first.members.tolist()


@pytest.mark.parametrize("name", ["ball", "capsule of quads", "soup"])
def test_a_large_shape_is_grouped_by_way_of_smaller_groups(name, monkeypatch):
    shape = replace(MADE[name])  # with nothing kept
    straight = coarsen(shape, 30)
    monkeypatch.setattr(module, "MIDDLE", 200)
    shape = replace(shape)
    few, middle = coarsen(shape, 30), coarsen(shape, 200)
    assert few.fine is shape
    assert few.resolution == "coarse30"
    assert few.n_elements == straight.n_elements
    # Every group of 200 is in one of 30, and these are as alike in size as straight ones.
    pairs = np.unique(np.stack([middle.members, few.members], axis=1), axis=0)
    assert len(pairs) == middle.n_elements
    assert few.areas.sum() == pytest.approx(shape.areas.sum())
    assert few.areas.max() < 2 * straight.areas.max()


def test_pins_hold_on_the_way_to_larger_groups(monkeypatch):
    monkeypatch.setattr(module, "MIDDLE", 200)
    shape = replace(BALL)
    elements = np.arange(0, shape.n_elements, 7)
    pins = Pins(elements=elements, labels=(elements % 2).astype(np.int32))
    members = coarsen(shape, 20, pins=pins).members
    for group in np.unique(members[elements]):
        assert len(np.unique(pins.labels[members[elements] == group])) == 1


@given(st.sampled_from(sorted(MADE)), st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_parts_are_those_of_the_input_elements(name, seed):
    rough, exact = both(MADE[name], seed)
    assert rough.shape is exact.shape
    assert (rough.labels == exact.labels).all()
    assert (rough.summary.hashes == exact.summary.hashes).all()
    assert (rough.summary.counts == exact.summary.counts).all()
    for a, b in zip(rough.parts, exact.parts, strict=True):
        assert a.shape is b.shape
        assert a.n_elements == b.n_elements
        assert a.membership == b.membership
        for measure in ("elements", "points", "areas", "vertices", "triangles"):
            assert getattr(a, measure).tobytes() == getattr(b, measure).tobytes(), measure
        assert a.n_components == b.n_components
        np.testing.assert_allclose(a.moments, b.moments, rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(a.scales, b.scales, rtol=1e-9)
        assert a.box_diagonal == pytest.approx(b.box_diagonal, rel=1e-6)
        assert (a.to_mesh().faces == b.to_mesh().faces).all()


def test_a_permuted_segmentation_has_the_same_parts():
    rough, _ = both(BALL, 4)
    turned = rough.permuted(np.array([2, 0, 1]))
    for j, k in enumerate([2, 0, 1]):
        assert turned.parts[j].membership == rough.parts[k].membership
        assert (turned.parts[j].elements == rough.parts[k].elements).all()


def test_values_are_remembered_apart_from_those_of_input_elements():
    memo, coarse = Memo(), coarsen(BALL, 40)
    calls = []

    class Sizes:
        def measure(self, name):
            return FoundMeasure(
                id="a:size", function=lambda part: calls.append(part) or part.n_elements, keep=True
            )

    for shape in (BALL, coarse, BALL, coarse):
        labels = np.zeros(shape.n_elements, int)
        whole = Segmentation.from_labels(shape, labels, 1, memo=memo, lookup=Sizes())
        assert whole.parts[0].measure("size") == BALL.n_elements
    assert len(calls) == 2


def test_conflicting_pins_are_kept_apart():
    plain = coarsen(BALL, 20)
    inside = np.flatnonzero(plain.members == 7)
    pins = Pins(elements=inside[[0, 1, -1]], labels=np.array([0, 1, 1]))
    coarse = coarsen(BALL, 20, pins=pins)
    found = coarse_pins(pins, coarse)
    asked = dict(zip(found.elements.tolist(), found.labels.tolist(), strict=True))
    for element, label in zip(pins.elements, pins.labels, strict=True):
        assert asked[coarse.members[element]] == label
    for k in range(coarse.n_elements):
        assert BALL.adjacency.components(np.flatnonzero(coarse.members == k))[0] == 1
    # The rest is as it was.
    outside = plain.members != 7
    pairs = np.unique(np.stack([plain.members[outside], coarse.members[outside]]), axis=1)
    assert pairs.shape[1] == 19
    agreeing = Pins(elements=inside, labels=np.zeros(len(inside), int))
    assert (coarsen(BALL, 20, pins=agreeing).members == plain.members).all()
    assert coarse_pins(agreeing, plain).elements.tolist() == [7]
