"""Neighbours against brute force over edges, cells and distances."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.adjacency import Adjacency, grid_adjacency, mesh_adjacency, near_pairs
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.voxels import VoxelGrid
from tests import shapes
from tests.references import connected_pieces, edge_neighbors

SHAPES = {
    "cube": shapes.cube(),
    "tee": shapes.tee(),
    "two boxes": shapes.two_boxes(),
    "prism": shapes.prism(6),
    "disc": shapes.disc(),
    "annulus": shapes.annulus(),
    "book": shapes.book(4),
    "open cube": shapes.cube_without_lid(),
    "soup": shapes.soup(2, 6),
    "sphere": shapes.sphere(1),
    "boxes that share an edge": shapes.solid([(0, 0, 0), (1, 1, 0)]),
    "boxes that share a corner": shapes.solid([(0, 0, 0), (1, 1, 1)]),
}


def lists(adjacency):
    return [adjacency.neighbors(f).tolist() for f in range(adjacency.n_elements)]


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("apart", [False, True])
def test_neighbours_are_the_faces_that_share_an_edge_by_position(name, apart):
    vertices, faces = SHAPES[name]
    if apart:  # every face with vertices of its own, as in an STL file
        flat = [v for face in faces for v in face]
        starts = np.cumsum([0, *map(len, faces)])
        vertices = np.asarray(vertices)[flat]
        faces = [tuple(range(a, b)) for a, b in itertools.pairwise(starts)]
    found = mesh_adjacency(PolygonMesh.from_faces(vertices, faces))
    assert lists(found) == [sorted(near) for near in edge_neighbors(vertices, faces)]
    assert found.indptr.dtype == found.indices.dtype == np.int32


@given(st.integers(0, 2**32), st.integers(3, 9), st.integers(1, 25))
@settings(max_examples=60, deadline=None)
def test_neighbours_on_random_faces_over_few_vertices(seed, n_vertices, n_faces):
    # Edges that many faces share, faces that name a vertex twice, the same face again.
    rng = np.random.default_rng(seed)
    vertices = rng.integers(0, 3, (n_vertices, 3)).astype(np.float64)
    faces = [
        tuple(rng.integers(0, n_vertices, rng.integers(3, 6)).tolist()) for _ in range(n_faces)
    ]
    found = mesh_adjacency(PolygonMesh.from_faces(vertices, faces))
    assert lists(found) == [sorted(near) for near in edge_neighbors(vertices, faces)]


def test_neighbours_agree_with_trimesh_on_a_manifold():
    ball = trimesh.creation.icosphere(subdivisions=2)
    expected = {tuple(sorted(pair)) for pair in ball.face_adjacency.tolist()}
    found = lists(mesh_adjacency(PolygonMesh.from_faces(ball.vertices, ball.faces)))
    assert {(f, g) for f, near in enumerate(found) for g in near if f < g} == expected


@given(st.integers(0, 2**32), st.integers(1, 25), st.integers(0, 40))
@settings(max_examples=60, deadline=None)
def test_pairs_may_repeat_reverse_and_join_an_element_to_itself(seed, size, count):
    rng = np.random.default_rng(seed)
    pairs = rng.integers(0, size, (count, 2))
    graph = Adjacency.from_pairs(pairs, size)
    expected = [set() for _ in range(size)]
    for f, g in pairs.tolist():
        if f != g:
            expected[f].add(g)
            expected[g].add(f)
    assert lists(graph) == [sorted(near) for near in expected]
    dense = graph.matrix.toarray()
    assert (dense == dense.T).all()
    assert sorted(zip(*np.nonzero(dense), strict=True)) == [
        (f, g) for f in range(size) for g in sorted(expected[f])
    ]

    asked = np.flatnonzero(rng.integers(0, 2, size))
    for elements, chosen in ((None, range(size)), (asked, asked.tolist())):
        number, component = graph.components(elements)
        pieces = connected_pieces(expected, chosen)
        assert number == len(pieces)
        grouped = {}
        for f, c in zip(chosen, component.tolist(), strict=True):
            grouped.setdefault(c, set()).add(f)
        assert sorted(map(sorted, grouped.values())) == sorted(map(sorted, pieces))


def literal_grid_pairs(grid, most):
    cells = grid.cells
    return {
        (a, b)
        for a in range(len(cells))
        for b in range(len(cells))
        if 0 < np.abs(cells[a] - cells[b]).sum() <= most and np.abs(cells[a] - cells[b]).max() == 1
    }


@pytest.mark.parametrize("elements", ["solid", "surface"])
@pytest.mark.parametrize("seed", range(4))
def test_cells_share_faces_or_on_a_surface_edges(elements, seed):
    occupied = np.random.default_rng(seed).random((4, 3, 5)) < 0.7
    grid = VoxelGrid.from_occupied(occupied, elements=elements)
    pairs = set(map(tuple, grid_adjacency(grid).pairs.tolist()))
    assert pairs == literal_grid_pairs(grid, 1 if elements == "solid" else 2)


def test_the_surface_of_a_slope_is_connected():
    x, y, z = np.indices((6, 6, 6))
    grid = VoxelGrid.from_occupied(x + y + z < 6, elements="surface")
    assert grid_adjacency(grid).components()[0] == 1


@pytest.mark.parametrize("nearest", [1, 3, 50])
@pytest.mark.parametrize("seed", range(3))
def test_near_pairs_are_mutual(nearest, seed):
    points = np.random.default_rng(seed).normal(size=(20, 3))
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    near = np.argsort(distance, axis=1)[:, 1 : nearest + 1].tolist()
    expected = [
        [a, b] for a in range(20) for b in range(a + 1, 20) if b in near[a] and a in near[b]
    ]
    assert near_pairs(points, nearest).tolist() == expected


def test_near_pairs_do_not_bridge_to_a_sparser_sheet():
    dense = np.stack([*np.indices((10, 10)).reshape(2, -1) / 10, np.zeros(100)], axis=1)
    sparse = np.array([[0.5, 0.5, 0.3]])
    pairs = near_pairs(np.concatenate([dense, sparse]), 6)
    assert 100 not in pairs
