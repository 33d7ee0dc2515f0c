"""Algorithm 1 against its literal version: the same labels, element by element, ties included."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.builtin.flood import flood_labels, flood_parts, voronoi_labels, workspace
from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import (
    connected_partition,
    connected_parts,
    connected_pieces,
    voronoi_partition,
    weighted_distance,
)

MESHES = {
    "disc": shapes.disc(),
    "tee": shapes.tee(),
    "two boxes": shapes.two_boxes(),
    "annulus": shapes.annulus(),
    "book": shapes.book(5),
    "strip": shapes.strip(),
    "soup": shapes.soup(1, 12),
    "bent capsule": shapes.bent_capsule(),
    "sphere": shapes.sphere(1),
}


def flood(points, adjacency, centers, weights):
    labels = np.full(len(points), 77, np.int32)
    graph = adjacency.indptr, adjacency.indices
    flood_labels(points, centers, weights, *graph, labels, *used(len(centers), len(points)))
    return labels.tolist()


def used(n_centers, n_elements):
    """A workspace that is larger than need be and holds what another flood has left in it."""
    table, rows, key, code = workspace(n_centers + 2, n_elements)
    for array in (table, key, code):
        array.fill(-3)
    return table, rows, key, code


def neighbors(adjacency):
    return [adjacency.neighbors(f).tolist() for f in range(adjacency.n_elements)]


@st.composite
def cases(draw, *, integer: bool):
    """Points, a graph of any kind over them, and weighted centres."""
    size = draw(st.integers(1, 30))
    n = draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    # Up to two edges an element: from nothing but isolated elements to one dense component.
    pairs = rng.integers(0, size, (draw(st.integers(0, 2 * size)), 2))
    if integer:
        reach = draw(st.integers(1, 4))  # few places: points and centres coincide, distances tie
        points = rng.integers(0, reach, (size, 3)).astype(np.float64)
        centers = rng.integers(0, reach, (n, 3)).astype(np.float64)
        weights = 2.0 ** rng.integers(-1, 2, n)
    else:
        points, centers = rng.normal(size=(size, 3)), rng.normal(size=(n, 3))
        weights = 10.0 ** rng.uniform(-draw(st.sampled_from([0, 1, 8])), 1.0, n)
    if draw(st.booleans()):  # centres on elements, as a seeder places them; some twice
        centers = points[rng.integers(0, size, n)].copy()
    return points, Adjacency.from_pairs(pairs, size), centers, weights


@given(cases(integer=False))
@settings(max_examples=150, deadline=None)
def test_the_flood_is_algorithm_1(case):
    points, adjacency, centers, weights = case
    expected = connected_partition(points.tolist(), neighbors(adjacency), centers, weights)
    assert flood(*case) == expected


@given(cases(integer=True))
@settings(max_examples=300, deadline=None)
def test_ties_go_by_distance_then_centre_then_element(case):
    points, adjacency, centers, weights = case
    expected = connected_partition(points.tolist(), neighbors(adjacency), centers, weights)
    assert flood(*case) == expected


@given(
    cases(integer=True) | cases(integer=False),
    st.lists(st.tuples(st.integers(0, 5), st.booleans(), st.integers(0, 9)), max_size=6),
)
@settings(max_examples=100, deadline=None)
def test_a_flood_does_not_depend_on_those_before_it_in_a_workspace(case, moves):
    points, adjacency, centers, weights = case
    space = workspace(len(centers) + 1, len(points))
    graph = adjacency.indptr, adjacency.indices
    for k, changes_weight, to in [(0, False, 0), *moves]:
        centers, weights, k = centers.copy(), weights.copy(), k % len(centers)
        if changes_weight:
            weights[k] *= 1.5
        else:
            centers[k] = points[to % len(points)]
        labels = np.full(len(points), 77, np.int32)
        flood_labels(points, centers, weights, *graph, labels, *space)
        assert labels.tolist() == flood(points, adjacency, centers, weights)
        voronoi_labels(points, centers, weights, labels, *space[:2])
        assert labels.tolist() == voronoi_partition(points, centers, weights)
        if len(centers) > 1:  # fewer centres, as where some of a part coincide
            flood_labels(points, centers[1:], weights[1:], *graph, labels, *space)
            assert labels.tolist() == flood(points, adjacency, centers[1:], weights[1:])


@given(
    width=st.integers(2, 7),
    height=st.integers(1, 5),
    n=st.integers(2, 6),
    halves=st.booleans(),
    seed=st.integers(0, 2**32),
)
@settings(max_examples=200, deadline=None)
def test_ties_on_a_grid_of_squares_with_gaps(width, height, n, halves, seed):
    # Nearly every distance ties with others, and many elements are reached by detours only.
    rng = np.random.default_rng(seed)
    points = np.array([(x, y, 0.0) for y in range(height) for x in range(width)])
    apart = np.abs(points[:, None] - points[None]).sum(axis=2)
    pairs = np.argwhere(apart == 1)
    adjacency = Adjacency.from_pairs(pairs[rng.random(len(pairs)) < 0.6], len(points))
    centers = points[rng.integers(0, len(points), n)] + (0.5 if halves else 0.0)
    case = points, adjacency, centers, np.ones(n)
    expected = connected_partition(points.tolist(), neighbors(adjacency), centers, [1.0] * n)
    assert flood(*case) == expected


@pytest.mark.parametrize("name", MESHES)
@given(seed=st.integers(0, 2**32), n=st.integers(1, 5))
@settings(max_examples=12, deadline=None)
def test_the_flood_is_algorithm_1_on_meshes(name, seed, n):
    shape = Shape.from_mesh(*MESHES[name])
    rng = np.random.default_rng(seed)
    centers = shape.points[rng.integers(0, shape.n_elements, n)]
    if seed % 2:
        centers = centers + rng.normal(scale=0.3, size=centers.shape)
    weights = np.ones(n) if seed % 3 == 0 else rng.uniform(0.2, 3.0, n)
    expected = connected_partition(
        shape.points.tolist(), neighbors(shape.adjacency), centers, weights
    )
    assert flood(shape.points, shape.adjacency, centers, weights) == expected


@given(cases(integer=False), st.booleans())
@settings(max_examples=60, deadline=None)
def test_without_adjacency_each_element_takes_its_nearest_weighted_centre(case, on_a_grid):
    points, _, centers, weights = case
    if on_a_grid:
        points, centers = points.round(), centers.round()
    labels = np.full(len(points), 77, np.int32)
    voronoi_labels(points, centers, weights, labels, *used(len(centers), len(points))[:2])
    assert labels.tolist() == voronoi_partition(points.tolist(), centers, weights)


@given(cases(integer=True) | cases(integer=False))
@settings(max_examples=150, deadline=None)
def test_every_element_is_labelled_and_segments_are_connected_where_a_seed_is(case):
    points, adjacency, centers, weights = case
    labels = np.array(flood(*case))
    assert labels.min() >= 0
    assert labels.max() < len(centers)
    seeds = []
    for c, w in zip(centers, weights, strict=True):
        distances = [weighted_distance(p, c, w) for p in points]
        seeds.append(distances.index(min(distances)))
    for component in connected_pieces(neighbors(adjacency), range(len(points))):
        if not component.intersection(seeds):
            continue
        for i in range(len(centers)):
            segment = [f for f in component if labels[f] == i]
            assert len(connected_pieces(neighbors(adjacency), segment)) <= 1


@given(cases(integer=True) | cases(integer=False), st.integers(-40, 40))
@settings(max_examples=60, deadline=None)
def test_only_the_ratios_of_the_weights_matter(case, power):
    points, adjacency, centers, weights = case
    assert flood(points, adjacency, centers, weights * 2.0**power) == flood(*case)


@given(cases(integer=False), st.floats(0.001, 1000.0))
@settings(max_examples=60, deadline=None)
def test_weights_times_any_number_change_nothing_in_generic_position(case, factor):
    points, adjacency, centers, weights = case
    distances = np.linalg.norm(points[:, None] - centers[None], axis=2) / weights
    ordered = np.sort(distances.reshape(-1))
    if (np.diff(ordered) > 1e-12 * ordered[1:]).all():
        assert flood(points, adjacency, centers, weights * factor) == flood(*case)


def test_equal_centres_leave_the_second_without_elements():
    shape = Shape.from_mesh(*shapes.strip(6))
    centers = np.repeat(shape.points[2:3], 2, axis=0)
    assert flood(shape.points, shape.adjacency, centers, np.ones(2)) == [0] * 6


def test_a_tie_goes_to_the_lower_centre_and_then_the_lower_element():
    # Seven squares in a row, centres on the outer ones: the middle one is equally far from both.
    shape = Shape.from_mesh(*shapes.strip(7))
    ends = shape.points[[0, 6]]
    assert flood(shape.points, shape.adjacency, ends, np.ones(2)) == [0, 0, 0, 0, 1, 1, 1]
    assert flood(shape.points, shape.adjacency, ends[::-1].copy(), np.ones(2)) == [
        1,
        1,
        1,
        0,
        0,
        0,
        0,
    ]


def test_a_segment_cut_off_by_another_stays_with_the_flood_that_reaches_it():
    # The far arm of the U is nearer to centre 0 in space, but only centre 1 gets there.
    shape = Shape.from_mesh(*shapes.strip(6))
    bent = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [0, 0.6, 0]])
    centers = bent[[0, 3]]
    plain = voronoi_partition(bent, centers, [1.0, 1.0])
    assert plain == [0, 0, 1, 1, 1, 0]
    assert flood(bent, shape.adjacency, centers, np.ones(2)) == [0, 0, 1, 1, 1, 1]


def test_a_heavy_centre_that_comes_too_late_keeps_nobody_from_the_rest():
    """It is the nearest to most of a row whose elements it never gets to."""
    size = 40
    points = np.array([(x, 0.0, 0.0) for x in range(size)])
    adjacency = Adjacency.from_pairs(np.array([(x, x + 1) for x in range(size - 1)]), size)
    centers = np.array([(3.0, 0, 0), (3.0, 0.9, 0), (30.0, 0, 0)])
    weights = np.array([1.0, 5.0, 1.0])
    away = np.linalg.norm(points[:, None] - centers, axis=2) / weights
    assert (away.argmin(axis=1) == 1).sum() > size / 2
    expected = connected_partition(points.tolist(), neighbors(adjacency), centers, weights)
    assert flood(points, adjacency, centers, weights) == expected
    assert set(expected) == {0, 2}


def test_a_component_without_a_seed_takes_its_nearest_weighted_centres():
    shape = Shape.from_mesh(*shapes.joined(shapes.strip(4), shapes.soup(3, 5)))
    centers = shape.points[[0, 3]] + [[0, 1e-3, 0], [0, -1e-3, 0]]
    weights = np.array([1.0, 1.5])
    labels = flood(shape.points, shape.adjacency, centers, weights)
    assert labels[4:] == voronoi_partition(shape.points[4:], centers, weights)


@pytest.mark.parametrize("smallest", [np.finfo(np.float64).tiny, 1e-300, 1e-12])
def test_the_least_feasible_weight_still_gives_a_labelling(smallest):
    shape = Shape.from_mesh(*shapes.strip(5))
    centers = shape.points[[1, 4]] + 0.1
    labels = flood(100 * shape.points, shape.adjacency, 100 * centers, np.array([smallest, 1.0]))
    # The seed of a centre of hardly any weight is the last to be popped, and is taken by then.
    assert labels == [1] * 5


# --- parts of several centres --------------------------------------------------------------------


def flood_in_parts(points, adjacency, centers, weights, parts):
    labels = np.full(len(points), 77, np.int32)
    graph = adjacency.indptr, adjacency.indices
    component = adjacency.components()[1]
    of_centers, space = np.array(parts, np.int32), used(len(centers), len(points))
    flood_parts(points, centers, weights, of_centers, component, *graph, labels, *space)
    return labels.tolist()


@st.composite
def parted(draw, cases):
    """A case, and the parts of its centres, rising."""
    points, adjacency, centers, weights = draw(cases)
    steps = draw(st.lists(st.integers(0, 1), min_size=len(centers) - 1, max_size=len(centers) - 1))
    return points, adjacency, centers, weights, [0, *np.cumsum(steps, dtype=int).tolist()]


@given(st.one_of(parted(cases(integer=False)), parted(cases(integer=True))))
@settings(max_examples=300, deadline=None)
def test_parts_of_several_centres_keep_one_piece(case):
    points, adjacency, centers, weights, parts = case
    expected = connected_parts(points.tolist(), neighbors(adjacency), centers, weights, parts)
    assert flood_in_parts(*case) == expected


@pytest.mark.parametrize("name", ["disc", "tee", "annulus", "bent capsule", "sphere"])
@given(seed=st.integers(0, 2**32), parts=st.sampled_from([(0, 0, 1), (0, 0, 1, 1, 1, 2)]))
@settings(max_examples=12, deadline=None)
def test_parts_of_several_centres_are_in_one_piece_on_meshes(name, seed, parts):
    shape = Shape.from_mesh(*MESHES[name])
    rng = np.random.default_rng(seed)
    centers = shape.points[rng.integers(0, shape.n_elements, len(parts))]
    weights = rng.uniform(0.2, 3.0, len(parts))
    found = flood_in_parts(shape.points, shape.adjacency, centers, weights, parts)
    expected = connected_parts(
        shape.points.tolist(), neighbors(shape.adjacency), centers, weights, parts
    )
    assert found == expected
    for part in set(found):
        members = np.flatnonzero(np.array(found) == part).tolist()
        assert len(connected_pieces(neighbors(shape.adjacency), members)) == 1


def test_a_piece_apart_from_that_of_the_first_centre_goes_to_its_neighbours():
    shape = Shape.from_mesh(*shapes.strip(9))
    case = shape.points, shape.adjacency, shape.points[[0, 8, 4]], np.ones(3)
    assert flood(*case) == [0, 0, 0, 2, 2, 2, 1, 1, 1]
    assert flood_in_parts(*case, [0, 0, 1]) == [0, 0, 0, 1, 1, 1, 1, 1, 1]
    assert flood_in_parts(*case, [0, 1, 1]) == [0, 0, 0, 1, 1, 1, 1, 1, 1]
    assert flood_in_parts(*case, [0, 0, 0]) == [0] * 9
