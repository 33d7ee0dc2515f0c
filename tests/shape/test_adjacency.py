"""Neighbours against brute force over edges, cells and distances."""

from __future__ import annotations

import itertools
import tracemalloc

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.shape.adjacency import (
    Adjacency,
    grid_adjacency,
    mesh_adjacency,
    near_pairs,
    undirected,
)
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
    users = {}
    for f, face in enumerate(faces):
        corners = [tuple(vertices[v]) for v in face]
        for a, b in itertools.pairwise([*corners, corners[0]]):
            if a != b:
                users.setdefault(frozenset((a, b)), []).append(f)
    all_with_all = [set() for _ in faces]
    for around in users.values():
        for f, g in itertools.permutations(set(around), 2):
            all_with_all[f].add(g)
            if len(around) <= 3:
                assert g in found.neighbors(f)
    # Some links are left out of crowded edges, so that no more are left than uses; none is made
    # up, and nothing comes apart.
    assert len(found.indices) <= 2 * sum(map(len, users.values()))
    assert all(set(near) <= all_with_all[f] for f, near in enumerate(lists(found)))
    assert found.components()[0] == len(connected_pieces(all_with_all, range(n_faces)))


@pytest.mark.parametrize("pages", [4, 5, 12])
@pytest.mark.parametrize("seed", range(3))
def test_around_an_edge_neighbours_follow_each_other_by_angle(pages, seed):
    rng = np.random.default_rng(seed)
    angles = np.sort(rng.random(pages)) * 2 * np.pi
    reach = rng.uniform(0.5, 2, pages)
    tips = np.stack([reach * np.cos(angles), reach * np.sin(angles), rng.random(pages)], axis=1)
    vertices = np.concatenate([[[0.0, 0, 0], [0, 0, 1]], tips]) @ shapes.rotation(seed).T + 7.0
    order = rng.permutation(pages)
    faces = [(0, 1, 2 + k) if rng.random() < 0.5 else (1, 0, 2 + k) for k in order]
    found = lists(mesh_adjacency(PolygonMesh.from_faces(vertices, faces)))
    named = {int(order[f]): {int(order[g]) for g in near} for f, near in enumerate(found)}
    assert named == {k: {(k - 1) % pages, (k + 1) % pages} for k in range(pages)}
    assert [set(near) for near in found] == edge_neighbors(vertices, faces)


def test_copies_of_faces_at_an_edge_are_neighbours_of_each_other():
    vertices, faces = shapes.book(5)
    copies = [face for face in faces for _ in range(3)]
    found = lists(mesh_adjacency(PolygonMesh.from_faces(vertices, copies)))
    for f, near in enumerate(found):
        assert {abs(f // 3 - g // 3) % 4 for g in near} <= {0, 1}  # pages in turn
        assert any(f // 3 == g // 3 for g in near)


def test_neighbours_around_one_edge_take_as_much_memory_as_faces():
    pages = 20_000
    vertices, faces = shapes.book(pages)
    tracemalloc.start()
    found = mesh_adjacency(PolygonMesh.from_faces(vertices, np.array(faces)))
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(found.indices) == 2 * pages
    assert most < 2000 * pages  # bytes; all with all are 400 million pairs


def test_edges_are_numbered_in_the_order_of_their_ends():
    ends = np.random.default_rng(0).integers(0, 40, (300, 2))
    edge, group = undirected(ends)
    slow, number = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    assert edge.tolist() == slow.tolist()
    assert group.tolist() == number.reshape(-1).tolist()
    assert [len(part) for part in undirected(np.empty((0, 2), np.int64))] == [0, 0]


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


@pytest.mark.parametrize("name", ["tee", "two boxes", "soup", "sphere"])
def test_groups_touch_where_some_of_their_elements_do(name):
    adjacency = mesh_adjacency(PolygonMesh.from_faces(*SHAPES[name]))
    members = np.random.default_rng(1).permutation(adjacency.n_elements) // 2
    count = int(members.max()) + 1
    near = [set() for _ in range(count)]
    for a, b in adjacency.pairs:
        near[members[a]] |= {int(members[b])} - {int(members[a])}
    grouped = adjacency.grouped(members, count)
    assert lists(grouped) == [sorted(some) for some in near]
    assert grouped.indptr.dtype == grouped.indices.dtype == np.int32


def test_pieces_of_some_elements_are_numbered_by_their_first():
    chain = Adjacency.from_pairs(np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 5]]), 6)
    count, piece = chain.components(np.array([0, 1, 3, 5]))
    assert (count, piece.tolist()) == (3, [0, 0, 1, 2])
    assert chain.components()[1].tolist() == [0] * 6
