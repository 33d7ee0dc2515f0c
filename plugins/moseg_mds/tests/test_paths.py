from __future__ import annotations

import numpy as np
import pytest
from moseg_mds.geodesics import geodesic_distances
from moseg_mds.paths import path_graph
from scipy.sparse.csgraph import floyd_warshall


def literal(vertices, triangles, per_edge):
    """Vertex distances when every two nodes of a triangle are joined; `per_edge` of an edge."""
    nodes, places, groups = {}, [tuple(v) for v in vertices.tolist()], []
    for triangle in triangles.tolist():
        group = list(triangle)
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            low, high = min(a, b), max(a, b)
            n = per_edge(low, high)
            for k in range(1, n + 1):
                if (low, high, k) not in nodes:
                    nodes[low, high, k] = len(places)
                    t = k / (n + 1)
                    places.append(tuple((1 - t) * vertices[low] + t * vertices[high]))
                group.append(nodes[low, high, k])
        groups.append(group)
    places = np.array(places)
    lengths = np.full((len(places), len(places)), np.inf)
    for group in groups:
        for a in group:
            for b in group:
                lengths[a, b] = np.linalg.norm(places[a] - places[b])
    return floyd_warshall(lengths)[: len(vertices), : len(vertices)]


@pytest.mark.parametrize("budget", [0, 400, 2000])
def test_against_every_pair_of_nodes_in_a_triangle(make, budget):
    vertices, faces = make.blob(4)
    faces = faces[:120]
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], faces.reshape(-1, 3)
    graph = path_graph(vertices, faces, budget=budget)
    ends = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    length = {(a, b): np.linalg.norm(vertices[a] - vertices[b]) for a, b in ends.tolist()}
    step = sum(length.values()) / max(budget - len(vertices), 1)
    expected = literal(
        vertices, faces, lambda a, b: int(np.clip(np.rint(length[a, b] / step), 1, 7))
    )
    found = np.array([graph.distances(k) for k in range(len(vertices))])
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-13)


def test_more_nodes_are_better(make):
    vertices, faces = make.ball(2)
    expected = geodesic_distances(vertices, faces, [0], method="exact")[0]
    errors = []
    for budget in (0, 1500, 3000):
        found = path_graph(vertices, faces, budget=budget).distances(0)
        assert (found >= expected - 1e-9).all()
        errors.append((found - expected).max())
    assert errors[0] > errors[1] > errors[2]


@pytest.mark.parametrize("budget", [0, 600, 10**6])
def test_long_edges_get_more_points(make, budget):
    vertices, faces = make.strip(3, 20, length=10.0)
    ends = np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    long = np.abs(np.diff(vertices[ends][:, :, 0], axis=1)[:, 0]) > 1
    nodes = len(path_graph(vertices, faces, budget=budget).matrix.indptr) - 1
    least, most = {0: (1, 1), 600: (1, 7), 10**6: (7, 7)}[budget]
    expected = len(vertices) + most * long.sum() + least * (~long).sum()
    assert nodes == pytest.approx(expected, rel=0.02)


def test_corners_that_coincide_lead_on():
    # Two triangles, joined by a hair: a face with two corners in one place.
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [3, 0, 0], [4, 0, 0], [3, 1, 0.0]])
    graph = path_graph(vertices, np.array([[0, 1, 2], [3, 4, 5], [1, 1, 3]]))
    assert graph.distances(0)[[3, 4]].tolist() == pytest.approx([3, 4])
    assert graph.distances(4)[0] == pytest.approx(4)
