"""Cut discrepancy against all shortest paths, on small meshes of triangles, quads and more."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.agreement import EdgeGraph, cut_discrepancy, cut_vertices
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.agreement import references
from tests.agreement.labellings import renumbered


def graph_of(shape):
    mesh = shape.geometry
    return EdgeGraph.joined(
        mesh.vertices, mesh.merged, *mesh.edges, centroids=shape.points, areas=shape.areas
    )


def torn(mesh):
    """The mesh with vertices of its own for every face, as an STL file has them."""
    vertices, faces = mesh
    corners = [v for face in faces for v in face]
    starts = np.cumsum([0, *map(len, faces)])
    numbers = [tuple(range(starts[f], starts[f + 1])) for f in range(len(faces))]
    return np.asarray(vertices)[corners], numbers


MESHES = {
    "quads": shapes.jitter(shapes.box(2, 2, 1), 1),
    "torn": torn(shapes.jitter(shapes.box(2, 1, 1), 2)),
    "hexagons": shapes.jitter(shapes.prism(6), 3, 0.01),
    "not a manifold": shapes.jitter(shapes.book(5), 4),
    "open": shapes.jitter(shapes.rectangle(3.0, 2.0, 3, 2), 5),
    "two components": shapes.two_boxes(),
}
SHAPES = {name: Shape.from_mesh(*mesh) for name, mesh in MESHES.items()}
GRAPHS = {name: graph_of(shape) for name, shape in SHAPES.items()}


def labellings(draw, n):
    """Two labellings; in some draws faces of either have no label."""
    kinds, least = st.sampled_from([1, 2, 3, 9]), draw(st.sampled_from([0, 0, -1]))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    return rng.integers(least, draw(kinds), n), rng.integers(least, draw(kinds), n)


@given(st.data(), st.sampled_from(sorted(MESHES)))
@settings(max_examples=60)
def test_the_discrepancy_is_the_mean_over_all_shortest_paths(data, name):
    vertices, faces = MESHES[name]
    shape, graph = SHAPES[name], GRAPHS[name]
    first, second = labellings(data.draw, len(faces))
    cut = {tuple(p) for p in graph.positions[cut_vertices(graph, first)].tolist()}
    assert cut == references.cut_points(vertices, faces, first)
    center = np.average(shape.points, axis=0, weights=shape.areas)
    radius = np.average([np.linalg.norm(p - center) for p in shape.points], weights=shape.areas)
    expected = references.cut_discrepancy(vertices, faces, first, second, radius)
    found = cut_discrepancy(graph, first, second)
    assert found == (None if expected is None else pytest.approx(expected, abs=1e-12))
    assert cut_discrepancy(graph, second, first) == (
        None if expected is None else pytest.approx(expected, abs=1e-12)
    )
    if min(first.min(), second.min()) >= 0:
        assert cut_discrepancy(graph, renumbered(first, 1), renumbered(second, 2)) == found
        assert cut_discrepancy(graph, first, renumbered(first, 3)) == 0.0


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_the_discrepancy_has_no_units_and_no_place(scale):
    vertices, faces = shapes.rectangle(4.0, 1.0, 4, 1)
    shape = Shape.from_mesh(scale * (np.asarray(vertices) + 7.0), faces)
    first, second = np.array([0, 1, 1, 1]), np.array([0, 0, 0, 1])
    # Cuts at 1 and at 3; centroids at 1/2, 3/2, 5/2, 7/2 are on average 1 from the middle.
    assert cut_discrepancy(graph_of(shape), first, second) == pytest.approx(2.0, rel=1e-9)


def test_all_points_of_both_cuts_count_alike():
    shape = Shape.from_mesh(*shapes.rectangle(4.0, 1.0, 4, 1))
    # Two points at 1 find a cut at 1; two at 1 and two at 3 find it 0 and 2 away.
    first, second = np.array([0, 1, 1, 1]), np.array([0, 1, 1, 2])
    assert cut_discrepancy(graph_of(shape), first, second) == pytest.approx((2 * 2.0) / 6)


def test_one_part_has_no_cuts_and_no_discrepancy_from_others():
    graph, n = GRAPHS["quads"], len(MESHES["quads"][1])
    whole, halves = np.zeros(n, int), np.arange(n) % 2
    assert cut_vertices(graph, whole).size == 0
    assert cut_discrepancy(graph, whole, whole + 3) == 0.0
    assert cut_discrepancy(graph, whole, halves) is None
    assert cut_discrepancy(graph, halves, whole) is None


def test_a_cut_without_another_in_its_component_leaves_the_discrepancy_undefined():
    shape, graph = SHAPES["two components"], GRAPHS["two components"]
    left = shape.points[:, 0] < 3.0
    both = np.arange(shape.n_elements) % 2
    here, there = np.where(left, both, 0), np.where(left, 0, both)
    assert cut_discrepancy(graph, here, there) is None
    assert cut_discrepancy(graph, here, both) is None
    assert cut_discrepancy(graph, here, here) == 0.0
    # The two components themselves may be two parts: nothing is cut between them.
    assert cut_discrepancy(graph, left.astype(int), np.zeros(shape.n_elements, int)) == 0.0


def test_different_cuts_on_a_surface_of_no_extent_are_undefined():
    path = EdgeGraph(
        positions=np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]),
        ends=np.array([[0, 1], [0, 1], [1, 2], [2, 3], [2, 3]]),
        face=np.array([0, 1, 1, 1, 2]),
        radius=0.0,
    )
    assert cut_discrepancy(path, np.array([0, 1, 1]), np.array([0, 0, 1])) is None
    assert cut_discrepancy(path, np.array([0, 1, 1]), np.array([0, 1, 1])) == 0.0


def test_without_edges_there_are_no_cuts():
    empty = EdgeGraph(
        positions=np.zeros((1, 3)),
        ends=np.empty((0, 2), np.int64),
        face=np.empty(0, np.int64),
        radius=1.0,
    )
    assert cut_discrepancy(empty, np.array([0, 1]), np.array([0, 0])) == 0.0
