"""Pieces grown over a graph: nearest seeds along it, by a literal reference."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csgraph, csr_array

from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.grow import grow_pieces, middle_elements


@st.composite
def graphs(draw):
    size = draw(st.integers(1, 40))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    pairs = rng.integers(0, size, (draw(st.integers(0, 3 * size)), 2))
    seeds = rng.permutation(size)[: draw(st.integers(1, size))]
    return rng.normal(size=(size, 3)), Adjacency.from_pairs(pairs, size), seeds, rng


@given(graphs())
@settings(max_examples=80, deadline=None)
def test_elements_go_to_the_nearest_seed_along_the_graph(case):
    points, graph, seeds, _ = case
    members = np.full(len(points), -5)
    pieces = grow_pieces(points, graph.indptr, graph.indices, seeds, members)
    rows = np.repeat(np.arange(len(points)), np.diff(graph.indptr))
    lengths = np.linalg.norm(points[rows] - points[graph.indices], axis=1)
    matrix = csr_array((lengths, graph.indices, graph.indptr), shape=(len(points),) * 2)
    apart = csgraph.dijkstra(matrix, indices=seeds)
    reached = np.isfinite(apart.min(axis=0))
    assert (members[reached] == apart.argmin(axis=0)[reached]).all()
    # Components without a seed make one piece each, numbered on by their first element.
    component = csgraph.connected_components(matrix, directed=False)[1]
    alone = list(dict.fromkeys(component[~reached].tolist()))
    assert pieces == len(seeds) + len(alone)
    for k, c in enumerate(alone):
        assert (members[component == c] == len(seeds) + k).all()


@given(graphs())
@settings(max_examples=80, deadline=None)
def test_middles_are_the_elements_nearest_to_the_centroids(case):
    points, _, _, rng = case
    pieces = int(rng.integers(1, len(points) + 1))
    members = rng.permutation(np.arange(len(points)) % pieces)
    areas = rng.uniform(0, 1, len(points))
    areas[members == 0] = 0.0
    found = middle_elements(points, areas, members, pieces)
    for k in range(pieces):
        inside = np.flatnonzero(members == k)
        weights = areas[inside] if k else np.ones(len(inside))
        center = np.average(points[inside], axis=0, weights=weights)
        assert found[k] == inside[np.argmin(((points[inside] - center) ** 2).sum(axis=1))]
