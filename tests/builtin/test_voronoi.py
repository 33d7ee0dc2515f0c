"""The Voronoi parameterization: vectors in unit coordinates, labels by Algorithm 1."""

from __future__ import annotations

import dataclasses
import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.voronoi import Voronoi, parse_counts
from moseg_core.components.protocols import Centers, Parameterization
from moseg_core.errors import UsageError
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import (
    connected_partition,
    connected_parts,
    edge_neighbors,
    voronoi_partition,
)

MESH = shapes.jitter(shapes.moved(shapes.bent_capsule(8, 6), np.eye(3), 3.0, [5, -2, 1]), 4)
SHAPE = Shape.from_mesh(*MESH)
NEIGHBORS = edge_neighbors(*MESH)


def centers_at(seed, n):
    rng = np.random.default_rng(seed)
    positions = SHAPE.points[rng.integers(0, SHAPE.n_elements, n)] + rng.normal(size=(n, 3))
    return Centers(positions=positions, weights=rng.uniform(0.3, 3.0, n))


def test_it_answers_the_protocol():
    assert isinstance(Voronoi(SHAPE, 2), Parameterization)


@given(st.integers(0, 2**32), st.integers(1, 5), st.integers(1, 6))
@settings(max_examples=30, deadline=None)
def test_labels_are_those_of_algorithm_1_in_model_units(seed, n, batch):
    several = [centers_at(seed + b, n) for b in range(batch)]
    voronoi = Voronoi(SHAPE, n)
    found = voronoi.labels(np.array([voronoi.encode(centers) for centers in several]))
    assert found.shape == (batch, SHAPE.n_elements)
    assert found.dtype == np.int32
    for row, at in zip(found, several, strict=True):
        expected = connected_partition(
            SHAPE.points.tolist(), NEIGHBORS, at.positions.tolist(), at.weights.tolist()
        )
        assert row.tolist() == expected


@pytest.mark.parametrize("without", ["adjacency", "connected"])
def test_labels_go_by_distance_alone_where_segments_need_not_be_connected(without):
    shape = dataclasses.replace(SHAPE, adjacency=None) if without == "adjacency" else SHAPE
    voronoi = Voronoi(shape, 4, connected=without == "adjacency")
    assert not voronoi.connected
    differs = False
    for seed in range(10):
        at = centers_at(seed, 4)
        found = voronoi.labels(voronoi.encode(at)[None])[0].tolist()
        assert found == voronoi_partition(SHAPE.points, at.positions, at.weights)
        differs |= found != Voronoi(SHAPE, 4).labels(voronoi.encode(at)[None])[0].tolist()
    assert differs


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_encode_decode_and_permute(seed, n):
    voronoi, at = Voronoi(SHAPE, n), centers_at(seed, n)
    vector = voronoi.encode(at)
    assert vector.shape == voronoi.lower.shape == voronoi.upper.shape == voronoi.scale.shape
    assert vector.reshape(n, 4)[:, 3].tolist() == at.weights.tolist()
    assert vector.reshape(n, 4)[:, :3] == pytest.approx(SHAPE.frame.to_unit(at.positions))
    again = voronoi.decode(vector)
    assert again.positions == pytest.approx(at.positions, rel=1e-12)
    assert again.weights.tolist() == at.weights.tolist()

    order = np.random.default_rng(seed).permutation(n)
    permuted = voronoi.permute(vector, order)
    for j in range(n):
        assert (
            permuted[4 * j : 4 * j + 4].tolist() == vector[4 * order[j] : 4 * order[j] + 4].tolist()
        )
    before, after = voronoi.labels(np.stack([vector, permuted]))
    assert (order[after] == before).all()


@given(st.integers(0, 2**32), st.integers(1, 5))
@settings(max_examples=30, deadline=None)
def test_the_least_distance_wins(seed, n):
    voronoi, at = Voronoi(SHAPE, n, connected=False), centers_at(seed, n)
    vector = voronoi.encode(at)
    distances = voronoi.distances(vector, SHAPE.points)
    expected = [
        [np.linalg.norm(p - c) / w for c, w in zip(at.positions, at.weights, strict=True)]
        for p in SHAPE.points
    ]
    assert distances * SHAPE.frame.scale == pytest.approx(np.array(expected), rel=1e-9)
    assert (voronoi.labels(vector[None])[0] == distances.argmin(axis=1)).all()


def test_weights_are_positive_and_positions_are_free():
    voronoi = Voronoi(SHAPE, 2)
    assert (voronoi.lower[[3, 7]] > 0).all()
    assert np.isneginf(np.delete(voronoi.lower, [3, 7])).all()
    assert np.isposinf(voronoi.upper).all()
    assert voronoi.scale.tolist() == [1.0] * 8


def test_any_number_of_threads_gives_the_same_labels(monkeypatch):
    voronoi = Voronoi(SHAPE, 3)
    vectors = np.array([voronoi.encode(centers_at(seed, 3)) for seed in range(40)])
    found = []
    for cores in (1, 2, 8):
        monkeypatch.setattr(os, "sched_getaffinity", lambda _, cores=cores: set(range(cores)))
        found.append(voronoi.labels(vectors))
    assert (found[0] == found[1]).all()
    assert (found[0] == found[2]).all()
    assert voronoi.labels(vectors[:0]).shape == (0, SHAPE.n_elements)


# --- several centres for a label -----------------------------------------------------------------

NAMES = ("head", "body", "leg1", "leg2")
PARTS = np.array([0, 1, 1, 1, 2, 2, 3, 3])


def bodies(shape=SHAPE, **more):
    return Voronoi(shape, 4, centers="body=3,leg*=2", labels=NAMES, **more)


def eight_at(seed):
    return dataclasses.replace(centers_at(seed, 8), parts=PARTS)


@given(st.integers(0, 2**32))
@settings(max_examples=30, deadline=None)
def test_the_cells_of_a_labels_centres_are_its_part(seed):
    voronoi, at = bodies(), eight_at(seed)
    assert voronoi.connected
    assert voronoi.centers_per_part.tolist() == [1, 3, 2, 2]
    case = at.positions.tolist(), at.weights.tolist(), PARTS.tolist()
    expected = connected_parts(SHAPE.points.tolist(), NEIGHBORS, *case)
    assert voronoi.labels(voronoi.encode(at)[None])[0].tolist() == expected

    apart = bodies(connected=False)
    vector = apart.encode(at)
    nearest = PARTS[voronoi_partition(SHAPE.points, at.positions, at.weights)]
    assert (apart.labels(vector[None])[0] == nearest).all()
    assert (apart.distances(vector, SHAPE.points).argmin(axis=1) == nearest).all()


@given(st.integers(0, 2**32))
@settings(max_examples=30, deadline=None)
def test_one_centre_a_label_makes_the_partition_that_it_makes_alone(seed):
    several, single, at = bodies(), Voronoi(SHAPE, 4), centers_at(seed, 4)
    vector = several.encode(at)
    assert vector.shape == several.lower.shape == (32,)
    labels = several.labels(vector[None])[0]
    assert (labels == single.labels(single.encode(at)[None])[0]).all()
    # So labels may change places, whatever number of centres they have.
    order = np.random.default_rng(seed).permutation(4)
    assert (order[several.labels(several.permute(vector, order)[None])[0]] == labels).all()


@given(st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_all_centres_come_back_and_move_with_their_label(seed):
    voronoi, at = bodies(), eight_at(seed)
    vector = voronoi.encode(at)
    again = voronoi.decode(vector)
    assert again.positions == pytest.approx(at.positions, rel=1e-12)
    assert again.weights.tolist() == at.weights.tolist()
    assert again.parts.tolist() == PARTS.tolist()
    places = [voronoi.coordinates(k).tolist() for k in range(4)]
    assert np.concatenate(places).tolist() == [*range(32)]
    assert [len(own) for own in places] == [4, 12, 8, 8]
    legs = voronoi.permute(vector, np.array([0, 1, 3, 2]))
    assert legs[places[2]].tolist() == vector[places[3]].tolist()
    assert legs[places[3]].tolist() == vector[places[2]].tolist()
    before, after = voronoi.labels(np.stack([vector, legs]))
    # A leg keeps its first piece; both have as many centres, in the same order.
    assert (np.array([0, 1, 3, 2])[after] == before).all()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("bdy=3", "centers: unknown label 'bdy'; did you mean 'body'"),
        ("arm*=3", r"centers: 'arm\*' matches none of the labels head, body, leg1, leg2"),
        ("leg*=2,leg1=3", "centers: label 'leg1' is given twice"),
        *(
            (wrong, f"centers: '{wrong}' is not understood; write label=count")
            for wrong in ("body", "body=0", "body=-1", "body=2.5", "body=", "=3x")
        ),
    ],
)
def test_centres_that_make_no_sense_are_refused(text, says):
    with pytest.raises(UsageError, match=says):
        Voronoi(SHAPE, 4, centers=text, labels=NAMES)


def test_labels_that_no_word_names_have_one_centre():
    assert parse_counts("leg2=2", NAMES) == {"head": 1, "body": 1, "leg1": 1, "leg2": 2}
    with pytest.raises(UsageError, match="the names of all 4 labels are needed"):
        Voronoi(SHAPE, 4, centers="body=3")


def test_parts_that_are_expected_to_be_large_have_three_centres():
    shares = np.array([0.25, 0.3, np.nan, 0.1])
    found = Voronoi(SHAPE, 4, centers="auto", labels=NAMES, expected_shares=shares)
    assert found.centers_per_part.tolist() == [1, 3, 1, 1]
    assert Voronoi(SHAPE, 4, centers="auto").centers_per_part.tolist() == [1, 1, 1, 1]
