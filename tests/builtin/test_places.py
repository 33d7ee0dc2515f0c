"""Places against the definition, with shortest paths found by relaxing all edges until it ends."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.places import NEAR, Places, distances_on
from moseg_core.shape.shape import Shape
from tests import shapes

TEE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
APART = Shape.from_mesh(*shapes.two_boxes())
CLOUD = Shape.from_points(np.random.default_rng(0).random((40, 3)))


def literal_distances(shape):
    """(F, F) shortest paths, in space where there is none."""
    points = shape.points
    straight = np.linalg.norm(points[:, None] - points, axis=2)
    if shape.adjacency is None:
        return straight
    far = np.full_like(straight, np.inf)
    np.fill_diagonal(far, 0.0)
    pairs = shape.adjacency.pairs
    for _ in range(len(points)):
        before = far.copy()
        for a, b in pairs:
            far[:, b] = np.minimum(far[:, b], far[:, a] + straight[a, b])
        if (far == before).all():
            break
    return np.where(np.isfinite(far), far, straight)


@pytest.mark.parametrize("shape", [TEE, APART, CLOUD], ids=["tee", "two boxes", "cloud"])
def test_distances_are_shortest_paths_or_straight_where_there_is_none(shape):
    distances = distances_on(shape)
    found = np.stack([distances(element) for element in range(shape.n_elements)])
    assert found == pytest.approx(literal_distances(shape), abs=1e-9 * shape.frame.scale)


@pytest.mark.parametrize("shape", [TEE, APART, CLOUD], ids=["tee", "two boxes", "cloud"])
def test_each_place_is_the_element_furthest_from_those_before(shape):
    far = literal_distances(shape)
    places = Places.spread(shape, 12)
    middle = np.linalg.norm(shape.points - shape.points.mean(axis=0), axis=1).argmin()
    chosen = places.elements.tolist()
    assert far[middle, chosen[0]] == pytest.approx(far[middle].max())
    for k in range(1, len(chosen)):
        nearest = far[chosen[:k]].min(axis=0)
        assert nearest[chosen[k]] == pytest.approx(nearest.max())
    for k, near in enumerate(places.near):
        assert k not in near
        assert len(set(near.tolist())) == NEAR
        others = np.delete(far[chosen[k], chosen], k)
        assert sorted(far[chosen[k], places.elements[near]]) == pytest.approx(
            np.sort(others)[:NEAR].tolist()
        )


def test_on_a_bent_shape_the_two_ends_come_first():
    rows = [[x, 0, 0] for x in range(10)] + [[9, y, 0] for y in range(1, 10)]
    rows += [[x, 9, 0] for x in range(8, 0, -1)]
    graph = Shape.from_points(rows).with_adjacency("knn", nearest=2)
    # The ends are near in space; along the shape nothing is further apart.
    assert sorted(Places.spread(graph, 2).elements.tolist()) == [0, len(rows) - 1]


def test_places_are_different_even_where_elements_are_in_one_point():
    shape = Shape.from_points([[0, 0, 0]] * 3 + [[1, 0, 0]] * 2)
    for places in (Places.spread(shape, 9), Places.everywhere(shape)):
        assert sorted(places.elements.tolist()) == [0, 1, 2, 3, 4]
        assert places.near.shape == (5, 4)
        assert all(k not in near for k, near in enumerate(places.near))


@pytest.mark.parametrize("count", [1, 5])
def test_everywhere_means_all_elements(count):
    shape = Shape.from_mesh(*shapes.strip(count))
    places = Places.everywhere(shape)
    assert len(places) == count
    assert places.near.shape == (count, count - 1)


def test_a_grid_has_places_too():
    shape = Shape.from_voxels(np.ones((5, 2, 2), bool))
    assert len(set(Places.spread(shape, 8).elements.tolist())) == 8
