"""Volumes of open surfaces: caps over loops of any outline, loops that touch, and orientation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse.csgraph import connected_components

from moseg_core.shape.adjacency import undirected
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.capped import _blocks, capped_volume, with_caps
from tests.shapes import (
    cube,
    cube_without_lid,
    disc,
    moved,
    rotation,
    sphere,
    subdivided,
    tee,
    two_boxes,
)


def volume(mesh):
    made = PolygonMesh.from_faces(*mesh)
    return capped_volume(made.vertices, made.triangles)


@pytest.mark.parametrize(
    ("mesh", "expected"), [(cube(), 1.0), (tee(6, 5), 11.0), (two_boxes(), 4.0)]
)
def test_a_closed_surface_encloses_what_it_encloses(mesh, expected):
    assert volume(mesh) == pytest.approx(expected, rel=1e-12)


def test_a_plane_cut_is_closed_by_its_lid():
    assert volume(cube_without_lid()) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("level", [1, 3, 5])
def test_a_cut_across_the_stem_of_a_tee(level):
    vertices, faces = tee(6, 5)
    low = [face for face in faces if vertices[list(face), 2].max() <= level]
    high = [face for face in faces if vertices[list(face), 2].min() >= level]
    assert len(low) + len(high) == len(faces)
    assert volume((vertices, low)) == pytest.approx(level, rel=1e-12)
    assert volume((vertices, high)) == pytest.approx(11 - level, rel=1e-12)


def test_a_surface_in_a_plane_encloses_nothing():
    assert volume(disc()) == pytest.approx(0.0, abs=1e-12)


@given(seed=st.integers(0, 2**16), scale=st.floats(0.1, 10.0))
@settings(max_examples=20, deadline=None)
def test_neither_motions_nor_the_tessellation_matter(seed, scale):
    mesh = cube_without_lid()
    turned = moved(subdivided(mesh, seed), rotation(seed), scale, [1.0, -2.0, 0.5])
    assert volume(turned) == pytest.approx(scale**3, rel=1e-9)


def test_faces_all_the_other_way_round():
    vertices, faces = cube_without_lid()
    assert volume((vertices, [face[::-1] for face in faces])) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("turned", [[], [0], [1, 3]])
def test_caps_close_a_surface_however_its_faces_are_oriented(turned):
    vertices, faces = cube_without_lid()
    mesh = PolygonMesh.from_faces(
        vertices, [face[::-1] if f in turned else face for f, face in enumerate(faces)]
    )
    closed = with_caps(mesh)
    assert closed.n_polygons == 2 * 5 + 4
    assert (np.bincount(undirected(closed.edges[0])[1]) % 2 == 0).all()
    assert closed.vertices[len(vertices) :].tolist() == [[0.5, 0.5, 1.0]]  # of the lid
    assert with_caps(closed) is closed


def reference_blocks(edges):
    """Two edges are in one block where they stay connected without any single vertex."""
    n = len(edges)
    together = np.ones((n, n), bool)
    for v in np.unique(edges):
        touch = np.eye(n, dtype=bool)
        for i in range(n):
            for j in range(n):
                touch[i, j] |= bool(set(edges[i]) & set(edges[j]) - {v})
        _, component = connected_components(touch, directed=False)
        together &= component[:, None] == component
    return together


@given(data=st.data())
@settings(max_examples=60, deadline=None)
def test_blocks_by_their_definition(data):
    vertex = st.integers(0, 7)
    pairs = st.tuples(vertex, vertex).filter(lambda e: e[0] < e[1])
    edges = np.array(data.draw(st.lists(pairs, min_size=1, max_size=12, unique=True)))
    block = _blocks(edges)
    assert sorted(set(block)) == list(range(block.max() + 1))
    np.testing.assert_array_equal(block[:, None] == block, reference_blocks(edges.tolist()))


def test_blocks_of_a_long_loop():
    k = np.arange(20_000)
    assert (_blocks(np.stack([k, np.roll(k, -1)], axis=1)) == 0).all()


def test_of_a_surface_that_is_there_twice_one_is_capped():
    vertices, faces = sphere(3)
    triangles = np.array([f for f in faces if vertices[list(f), 2].mean() < 0.4])
    once = capped_volume(vertices, triangles)
    twice = np.concatenate([triangles, triangles[:, ::-1]])
    assert once > 1
    for seed in range(3):
        order = np.random.default_rng(seed).permutation(len(twice))
        assert capped_volume(vertices, twice[order]) == pytest.approx(once)
    flat = np.array([[0, 1, 2], [2, 1, 0]])
    assert capped_volume(np.eye(3), flat) == 0
    assert capped_volume(np.eye(3), np.empty((0, 3), int)) == 0


def test_vertices_are_joined_where_the_mesh_joins_them():
    vertices, faces = sphere(3)
    upper = np.array([f for f in faces if vertices[list(f), 2].mean() > 0])
    once = capped_volume(vertices, upper)
    loose = vertices[upper.reshape(-1)]
    loose = loose + np.random.default_rng(0).uniform(-1e-10, 1e-10, loose.shape)
    apart = np.arange(len(loose)).reshape(-1, 3)
    mesh = PolygonMesh.from_faces(loose, apart)
    assert capped_volume(loose, apart, mesh.merged) == pytest.approx(once, rel=1e-8)
    # Torn apart each triangle has its own cap.
    assert capped_volume(loose, apart) == pytest.approx(0.0, abs=1e-12)


def test_where_some_faces_lie_on_others_one_of_each_counts():
    vertices, faces = sphere(3)
    triangles = np.array(faces)
    upper = triangles[vertices[triangles, 2].mean(axis=1) > 0.3]
    lower = triangles[vertices[triangles, 2].mean(axis=1) < 0.6]
    whole, cut = capped_volume(vertices, triangles), capped_volume(vertices, lower)
    assert whole > cut > 1
    both = np.concatenate([triangles, upper[:, ::-1]])
    assert capped_volume(vertices, both) == pytest.approx(whole)
    again = np.concatenate([lower, lower[:, ::-1], upper + len(vertices)])
    apart = np.concatenate([vertices, vertices + 9.0])
    expected = cut + capped_volume(vertices, upper)
    assert capped_volume(apart, again) == pytest.approx(expected)


@pytest.mark.parametrize("weld", [0.0, 1e-3])
def test_a_surface_with_caps_is_joined_within_the_tolerance_it_had(weld):
    vertices, faces = cube_without_lid()
    loose = vertices[[v for face in faces for v in face]]
    loose = loose + np.random.default_rng(0).uniform(-1e-5, 1e-5, loose.shape)
    mesh = PolygonMesh.from_faces(loose, np.arange(len(loose)).reshape(-1, 4), weld=weld)
    closed = with_caps(mesh)
    assert closed.tolerance == mesh.tolerance
    # Each face by itself has four edges to be capped, the cube without a lid has those of its rim.
    assert closed.n_polygons == 2 * 5 + (4 if weld else 4 * 5)
