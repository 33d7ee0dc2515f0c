"""Clipped meshes are whole, lie on bisectors, and agree with a literal version of the method."""

from __future__ import annotations

import os
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from moseg_core import Centers, Shape, clip_boundaries, load, sample_path
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.clipping.clip import Clipped
from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.mesh import PolygonMesh
from tests import shapes
from tests.clipping.checks import (
    assert_valid,
    is_closed,
    polygon_areas,
    reference_areas,
    weighted,
)

SAMPLES = {name: load(sample_path(name)) for name in ("hammer", "horse")}
SMALL = {
    "sphere": shapes.sphere(2),
    "box of quads": shapes.box(4, 3, 2),
    "prism": shapes.prism(9),
    "bent capsule": shapes.jitter(shapes.bent_capsule(), 1, 0.02),
    "annulus": shapes.annulus(),
    "book": shapes.joined(*(shapes.subdivided(shapes.book(4), k) for k in range(1))),
    "two boxes": shapes.two_boxes(),
    "tube": shapes.tube(9, rings=5),
    "loose triangles": shapes.soup(3, 12),
}


def partition(shape: Shape, seed: int, n: int, *, connected: bool = True, equal: bool = False):
    """Random centres and weights near the surface, and their labels."""
    rng = np.random.default_rng(seed)
    near = shape.points[rng.integers(0, shape.n_elements, n)]
    centers = near + rng.normal(0.0, 0.05 * shape.frame.scale, (n, 3))
    weights = np.ones(n) if equal else rng.uniform(0.5, 2.0, n)
    voronoi = Voronoi(shape, n, connected=connected)
    vector = voronoi.encode(Centers(positions=centers, weights=weights))
    return voronoi.labels(vector[None])[0], centers, weights


def clipped(shape: Shape, labels, centers, weights) -> Clipped:
    return clip_boundaries(shape.geometry, labels, shape.points, centers, weights)


def unshared(mesh: PolygonMesh) -> PolygonMesh:
    """The same polygons, with a vertex of its own for every corner, as in an STL file."""
    corners = np.arange(len(mesh.corners))
    faces = [corners[a:b].tolist() for a, b in zip(mesh.offsets, mesh.offsets[1:], strict=False)]
    return PolygonMesh.from_faces(mesh.vertices[mesh.corners], faces)


def assert_on_bisectors(mesh: PolygonMesh, found: Clipped, centers, weights) -> None:
    """New vertices are equally near to two centres, unless all around them is of one face."""
    sources = defaultdict(set)
    after = found.mesh
    sizes = np.diff(after.offsets)
    for vertex, piece in zip(after.corners, np.repeat(np.arange(len(sizes)), sizes), strict=True):
        sources[vertex].add(found.source[piece])
    near = np.sort(weighted(after.vertices, centers, weights), axis=1)
    gaps = np.abs(near[:, :, None] - near[:, None, :])
    gaps[:, np.arange(len(centers)), np.arange(len(centers))] = np.inf
    new = np.arange(len(mesh.vertices), len(after.vertices))
    shared = [v for v in new if len(sources[v]) > 1]
    assert (gaps[shared].min(axis=(1, 2)) < 1e-9 * near[shared].max(axis=1)).all()


@pytest.mark.parametrize("name", SAMPLES)
@given(seed=st.integers(0, 10_000), n=st.integers(2, 8), equal=st.booleans())
@settings(max_examples=6)
def test_samples_stay_whole_under_any_partition(name, seed, n, equal):
    shape = SAMPLES[name]
    assert is_closed(shape.geometry)
    labels, centers, weights = partition(shape, seed, n, equal=equal)
    found = clipped(shape, labels, centers, weights)
    assert_valid(shape.geometry, labels, found)
    assert_on_bisectors(shape.geometry, found, centers, weights)


@pytest.mark.parametrize("name", SMALL)
@given(
    seed=st.integers(0, 10_000), n=st.integers(2, 5), connected=st.booleans(), equal=st.booleans()
)
@settings(max_examples=25)
def test_other_meshes_stay_whole_too(name, seed, n, connected, equal):
    shape = Shape.from_mesh(*SMALL[name])
    labels, centers, weights = partition(shape, seed, n, connected=connected, equal=equal)
    assert_valid(shape.geometry, labels, clipped(shape, labels, centers, weights))


@pytest.mark.parametrize("name", ["sphere", "box of quads", "prism", "tube", "book"])
@given(seed=st.integers(0, 10_000), n=st.integers(1, 4))
@settings(max_examples=25)
def test_any_labels_at_all_leave_a_whole_mesh(name, seed, n):
    shape = Shape.from_mesh(*SMALL[name])
    _, centers, weights = partition(shape, seed, n)
    labels = np.random.default_rng(seed).integers(0, n, shape.n_elements)
    assert_valid(shape.geometry, labels, clipped(shape, labels, centers, weights))


@pytest.mark.parametrize("name", SMALL)
@given(
    seed=st.integers(0, 10_000), n=st.integers(2, 4), connected=st.booleans(), equal=st.booleans()
)
@settings(max_examples=25)
def test_areas_are_those_of_the_literal_method(name, seed, n, connected, equal):
    shape = Shape.from_mesh(*SMALL[name])
    labels, centers, weights = partition(shape, seed, n, connected=connected, equal=equal)
    expected = reference_areas(shape.geometry, labels, shape.points, centers, weights)
    found = clipped(shape, labels, centers, weights)
    if {label for _, label in expected} - {-1} < set(labels.tolist()):
        return  # a part would vanish; that it does not is tested elsewhere
    area = defaultdict(float)
    junctions = {face for face, label in expected if label == -1}
    for face, label, piece in zip(
        found.source.tolist(), found.labels.tolist(), polygon_areas(found.mesh), strict=True
    ):
        area[face, label] += piece
    for key in area.keys() | expected.keys():
        if key[0] not in junctions:
            tolerance = 1e-9 * shape.area
            assert area[key] == pytest.approx(expected.get(key, 0.0), abs=tolerance), key


@given(seed=st.integers(0, 10_000))
@settings(max_examples=10)
def test_copies_of_a_vertex_are_cut_at_the_same_place_to_the_last_bit(seed):
    shape = Shape.from_mesh(*shapes.sphere(2))
    labels, centers, weights = partition(shape, seed, 4)
    shared = clipped(shape, labels, centers, weights)
    loose = unshared(shape.geometry)
    apart = clip_boundaries(loose, labels, shape.points, centers, weights)
    assert (
        apart.mesh.vertices[apart.mesh.corners] == shared.mesh.vertices[shared.mesh.corners]
    ).all()
    assert (apart.labels == shared.labels).all()
    assert is_closed(apart.mesh)


@pytest.mark.parametrize("height", [0.0, 0.13, -0.41])
def test_a_plane_cuts_a_sphere_in_a_circle(height):
    shape = Shape.from_mesh(*shapes.sphere(4))
    centers = np.array([[0.0, 0.0, height + 0.5], [0.0, 0.0, height - 0.5]])
    labels = (shape.points[:, 2] < height).astype(int)
    found = clipped(shape, labels, centers, np.ones(2))
    circle = 2 * np.pi * np.sqrt(1 - height**2)
    smooth = boundary_length(found.mesh, found.labels)
    assert circle * 0.99 < smooth < circle
    if height:
        assert boundary_length(shape.geometry, labels) > 1.1 * circle
    below = polygon_areas(found.mesh)[found.labels == 1].sum()
    assert below == pytest.approx(2 * np.pi * (1 + height), rel=5e-3)


def boundary_length(mesh: PolygonMesh, labels: np.ndarray) -> float:
    """Length of the edges between polygons of different labels."""
    ends, polygon = mesh.edges
    place = mesh.vertices[np.unique(mesh.merged, return_index=True)[1]]
    by_edge = defaultdict(set)
    for (a, b), f in zip(ends.tolist(), polygon.tolist(), strict=True):
        by_edge[min(a, b), max(a, b)].add(int(labels[f]))
    return sum(np.linalg.norm(place[a] - place[b]) for (a, b), k in by_edge.items() if len(k) > 1)


def test_a_sphere_of_apollonius_cuts_a_plane_in_a_circle():
    # Points less than half as far from (0, 0, 0) as from (3, 0, 0): the ball around (-1, 0, 0)
    # of radius 2.
    vertices, faces = shapes.fan(shapes.rectangle(8.0, 8.0, 40, 40))
    shape = Shape.from_mesh(vertices - [4.99, 4.02, 0.0], faces)
    centers, weights = np.array([[0.0, 0, 0], [3, 0, 0]]), np.array([1.0, 2.0])
    labels = weighted(shape.points, centers, weights).argmin(axis=1)
    found = clipped(shape, labels, centers, weights)
    inside = polygon_areas(found.mesh)[found.labels == 0].sum()
    assert inside == pytest.approx(4 * np.pi, rel=2e-3)
    new = found.mesh.vertices[len(vertices) :]
    np.testing.assert_allclose(np.linalg.norm(new - [-1, 0, 0], axis=1), 2.0, rtol=1e-12)


ROW = Shape.from_mesh(*shapes.strip(6))


def cut_row(x: float, labels: list[int]) -> Clipped:
    """A row of six squares with the bisector at x."""
    centers = np.array([[x - 1.0, 0.5, 0.0], [x + 1.0, 0.5, 0.0]])
    return clipped(ROW, labels, centers, np.ones(2))


def test_a_straddling_face_is_cut_and_others_are_the_polygons_that_they_were():
    found = cut_row(3.3, [0, 0, 0, 1, 1, 1])
    assert np.bincount(found.source).tolist()[:3] == [1, 1, 1]
    assert np.diff(found.mesh.offsets)[found.source != 3].tolist() == [4] * 5
    area = np.bincount(found.labels, polygon_areas(found.mesh))
    np.testing.assert_allclose(area, [3.3, 2.7])


def test_where_the_flood_decided_boundaries_stay_on_the_mesh():
    found = cut_row(5.2, [0, 0, 0, 1, 1, 1])
    assert (found.labels == [0, 0, 0, 1, 1, 1]).all()
    assert found.mesh.n_polygons == 6
    assert (found.mesh.corners == ROW.geometry.corners).all()


def test_a_face_that_the_flood_gave_away_is_clipped_if_it_straddles():
    found = cut_row(3.7, [0, 0, 0, 1, 1, 1])  # the fourth would be the first part's
    area = np.bincount(found.labels, polygon_areas(found.mesh))
    np.testing.assert_allclose(area, [3.7, 2.3])


@pytest.mark.parametrize("x", [3.0, 3.0 + 1e-6, 3.0 - 1e-6])
def test_a_boundary_through_vertices_leaves_no_slivers(x):
    found = cut_row(x, [0, 0, 0, 1, 1, 1])
    assert len(found.mesh.vertices) == len(ROW.geometry.vertices)
    assert (found.mesh.corners == ROW.geometry.corners).all()
    assert found.labels.tolist() == [0, 0, 0, 1, 1, 1]


def test_a_cut_at_a_vertex_across_from_a_cut_edge():
    # The bisector goes through a corner and the middle of the opposite side.
    mesh = PolygonMesh.from_faces(
        [[0, 0, 0], [2, 0, 0], [1, 2, 0], [1, -2, 0]], [[0, 1, 2], [1, 0, 3]]
    )
    centers = np.array([[0.0, 0, 0], [2, 0, 0]])
    points = np.array([[1.0 - 1e-3, 0.6, 0], [1.0 + 1e-3, -0.6, 0]])
    found = clip_boundaries(mesh, [0, 1], points, centers, np.ones(2))
    assert found.mesh.vertices[4:].tolist() == [[1.0, 0.0, 0.0]]
    assert found.mesh.n_polygons == 4
    assert polygon_areas(found.mesh).tolist() == [1.0] * 4
    assert sorted(found.labels.tolist()) == [0, 0, 1, 1]
    assert_valid(mesh, np.array([0, 1]), found)


@pytest.mark.parametrize("near", [1e-6, 1e-5, 3e-4, 1e-3])
@given(seed=st.integers(0, 10_000))
@settings(max_examples=15)
def test_bisectors_that_all_but_touch_vertices(near, seed):
    mesh = shapes.sphere(1)
    shape = Shape.from_mesh(*mesh)
    rng = np.random.default_rng(seed)
    through = shape.geometry.vertices[rng.choice(len(mesh[0]), 3, replace=False)].copy()
    through += rng.normal(0, near, (3, 3))
    normal = np.cross(through[1] - through[0], through[2] - through[0])
    normal /= max(np.linalg.norm(normal), 1e-9)
    centers = np.stack([through[0] + normal, through[0] - normal])
    labels = weighted(shape.points, centers, np.ones(2)).argmin(axis=1)
    found = clipped(shape, labels, centers, np.ones(2))
    assert_valid(shape.geometry, labels, found)


def test_three_parts_meet_in_a_point():
    fan = [[0, 0, 0], [4, 0, 0], [1, 3, 0], [3.5, -3, 0], [4, 4, 0], [-2, 2, 0]]
    mesh = PolygonMesh.from_faces(fan, [[0, 1, 2], [1, 0, 3], [2, 1, 4], [0, 2, 5]])
    centers = np.array([[0.0, 0, 0], [4, 0, 0], [1, 3, 0]])
    points = mesh.vertices[mesh.triangles].mean(axis=1)
    labels = weighted(points, centers, np.ones(3)).argmin(axis=1)
    assert set(labels.tolist()) == {0, 1, 2}
    found = clip_boundaries(mesh, labels, points, centers, np.ones(3))
    assert_valid(mesh, labels, found)
    pieces = found.mesh.triangles[found.source[found.mesh.triangle_polygon] == 0]
    (middle,) = set(pieces[0]) & set(pieces[2]) & set(pieces[4])
    np.testing.assert_allclose(found.mesh.vertices[middle], [2, 1, 0], atol=1e-12)


def test_a_part_without_a_vertex_of_its_own_keeps_its_faces():
    shape = Shape.from_mesh(*shapes.sphere(1))
    centers = np.array([[0.0, 0, 0], shape.points[7]])
    weights = np.array([1.0, 0.01])
    labels = weighted(shape.points, centers, weights).argmin(axis=1)
    assert np.flatnonzero(labels).tolist() == [7]
    found = clipped(shape, labels, centers, weights)
    assert found.source[found.labels == 1].tolist() == [7]
    assert found.mesh.n_polygons == shape.n_elements


def test_faces_without_area_and_with_repeated_corners():
    vertices, faces = shapes.strip(6)
    # A needle along the side y = 1 of the fourth square, and a face that is a line.
    vertices = np.concatenate([vertices, [[3.5, 1.0, 0.0]]])
    faces = [*faces, (11, 14, 10), (3, 4, 4)]
    shape = Shape.from_mesh(vertices, faces)
    labels = [0, 0, 0, 1, 1, 1, 1, 1]
    centers = np.array([[2.3, 0.5, 0.0], [4.3, 0.5, 0.0]])
    found = clipped(shape, labels, centers, np.ones(2))
    assert_valid(shape.geometry, np.array(labels), found)


def test_all_faces_at_an_edge_are_cut_at_once():
    shape = Shape.from_mesh(*shapes.book(5))
    centers = np.array([[0.0, 0.0, 0.2], [0.0, 0.0, 1.0]])
    labels = [0, 1, 0, 1, 0]
    found = clipped(shape, labels, centers, np.ones(2))
    on_spine = np.flatnonzero(np.abs(found.mesh.vertices[:, :2]).max(axis=1) == 0.0)
    assert found.mesh.vertices[on_spine, 2].tolist() == pytest.approx([0.0, 1.0, 0.6])
    pieces = (found.mesh.triangles == on_spine[2]).any(axis=1)
    assert set(found.source[pieces].tolist()) == set(range(5))
    assert_valid(shape.geometry, np.array(labels), found)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=10)
def test_in_an_embedding_cuts_are_made_at_the_same_fraction(seed):
    shape = Shape.from_mesh(*shapes.fan(shapes.tube(9, rings=6)))
    bend = np.random.default_rng(seed).normal(0, 0.5, (3, 3)) + np.eye(3)
    space = shape.deformed(shape.geometry.vertices @ bend.T, space="bent")
    labels, centers, weights = partition(space, seed, 3)
    there = clipped(space, labels, centers, weights)
    here = clip_boundaries(
        shape.geometry,
        labels,
        space.points,
        centers,
        weights,
        places=space.geometry.vertices,
    )
    # New vertices are numbered by the places of their edges, which differ.
    moved = here.mesh.vertices @ bend.T
    assert len(moved) == len(there.mesh.vertices)
    apart, match = cKDTree(there.mesh.vertices).query(moved)
    assert apart.max() < 1e-12
    assert len(set(match.tolist())) == len(moved)
    assert_valid(shape.geometry, labels, here)


def test_what_does_not_fit_is_refused():
    mesh, points = ROW.geometry, ROW.points
    centers, weights = np.zeros((2, 3)), np.ones(2)
    with pytest.raises(ShapeError, match="label for each of 6 polygons"):
        clip_boundaries(mesh, [0, 1], points, centers, weights)
    with pytest.raises(ShapeError, match="label for each"):
        clip_boundaries(mesh, np.zeros(6), points, centers, weights)
    with pytest.raises(ShapeError, match="not 5 and 14"):
        clip_boundaries(mesh, [0] * 6, points[:5], centers, weights)
    with pytest.raises(ShapeError, match="not 6 and 13"):
        clip_boundaries(mesh, [0] * 6, points, centers, weights, places=mesh.vertices[1:])
    with pytest.raises(UsageError, match="0 to 1"):
        clip_boundaries(mesh, [0, 1, 2, 0, 0, 0], points, centers, weights)
    with pytest.raises(UsageError, match="positive weight"):
        clip_boundaries(mesh, [0] * 6, points, centers, np.array([1.0, 0.0]))


@pytest.mark.slow
@pytest.mark.parametrize("model", [81, 121, 281])
def test_benchmark_models_stay_whole(model):
    folder = os.environ.get("MOSEG_PSB")
    if folder is None:
        pytest.skip("MOSEG_PSB does not name a folder with the benchmark's models")
    shape = load(Path(folder) / "off" / f"{model}.off")
    for seed in range(3):
        labels, centers, weights = partition(shape, seed, 5)
        found = clipped(shape, labels, centers, weights)
        assert_valid(shape.geometry, labels, found)
        loaded = trimesh.Trimesh(found.mesh.vertices, found.mesh.triangles, process=False)
        whole = trimesh.Trimesh(shape.geometry.vertices, shape.geometry.triangles, process=False)
        assert loaded.is_watertight == whole.is_watertight
