"""Links: lengths of shared edges, shared faces, counted neighbours; sums on coarse shapes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.errors import ShapeError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.links import Links
from moseg_core.shape.shape import Shape
from tests import shapes


def as_dict(links: Links) -> dict[tuple[int, int], float]:
    ends = zip(links.first.tolist(), links.second.tolist(), strict=True)
    return dict(zip(ends, links.lengths.tolist(), strict=True))


def shared_edges(vertices, faces) -> dict[tuple[int, int], float]:
    """For each two faces the length of the edges that both have, by position; slowly."""
    points = np.asarray(vertices, float)
    found: dict[tuple[int, int], float] = {}
    edges = []
    for face in faces:
        ends = [(face[k], face[(k + 1) % len(face)]) for k in range(len(face))]
        edges.append({frozenset((tuple(points[a]), tuple(points[b]))) for a, b in ends})
    for f in range(len(faces)):
        for g in range(f + 1, len(faces)):
            common = [tuple(edge) for edge in edges[f] & edges[g] if len(edge) == 2]
            if common:
                found[f, g] = sum(float(np.linalg.norm(np.subtract(*edge))) for edge in common)
    return found


@pytest.mark.parametrize("mesh", [shapes.cube(), shapes.bent_capsule(5, 4)])
def test_a_link_of_faces_is_as_long_as_the_edges_that_both_have(mesh):
    found = as_dict(Shape.from_mesh(*mesh).links)
    slow = shared_edges(*mesh)
    assert found.keys() == slow.keys()
    assert all(found[pair] == pytest.approx(slow[pair]) for pair in slow)


def test_links_are_the_pairs_of_the_adjacency():
    shape = Shape.from_mesh(*shapes.bent_capsule(7, 6))
    pairs = shape.adjacency.pairs
    low = pairs[pairs[:, 0] < pairs[:, 1]]
    assert np.stack([shape.links.first, shape.links.second], 1).tolist() == low.tolist()


def test_around_an_edge_of_three_faces_all_are_linked_with_all():
    vertices = [[0, 0, 0], [0, 0, 2], [1, 0, 0], [0, 1, 0], [-1, 0, 0]]
    links = Shape.from_mesh(vertices, [[0, 1, 2], [0, 1, 3], [0, 1, 4]]).links
    assert as_dict(links) == {(0, 1): 2.0, (0, 2): 2.0, (1, 2): 2.0}


def test_around_an_edge_of_four_faces_those_are_linked_that_follow_each_other():
    vertices = [[0, 0, 0], [0, 0, 2], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
    links = Shape.from_mesh(vertices, [[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 1, 5]]).links
    assert as_dict(links) == {(0, 2): 2.0, (0, 3): 2.0, (1, 2): 2.0, (1, 3): 2.0}


def test_two_edges_of_the_same_two_faces_add_up():
    vertices = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0], [1, -1, 0]]
    links = Shape.from_mesh(vertices, [[0, 1, 2, 3], [2, 1, 0, 4]]).links
    assert as_dict(links) == {(0, 1): 2.0}


def test_faces_without_a_common_edge_have_no_links():
    links = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).links
    assert len(links.first) == len(links.lengths) == 0


def test_cells_of_a_solid_are_linked_by_the_area_of_the_face_that_both_have():
    links = Shape.from_voxels(np.ones((2, 1, 2), bool), pitch=3.0).links
    assert as_dict(links) == {(0, 1): 9.0, (0, 2): 9.0, (1, 3): 9.0, (2, 3): 9.0}


def test_cells_that_are_no_cubes_are_linked_by_the_side_that_they_share():
    links = Shape.from_voxels(np.ones((2, 2, 2), bool), pitch=(2.0, 3.0, 5.0)).links
    along = {4: 15.0, 2: 10.0, 1: 6.0}  # in C order: x, y and z
    assert len(links.first) == 12
    for (first, second), area in as_dict(links).items():
        assert area == along[second - first]


def test_a_cut_through_oblique_cells_has_the_area_of_the_plane():
    steps = [[1.0, 0, 0], [0.2, 1.0, 0], [0.3, -0.1, 2.0]]
    links = Shape.from_voxels(np.ones((4, 3, 2), bool), pitch=steps).links
    cells = np.array(list(np.ndindex(4, 3, 2)))
    upper = cells[:, 0] >= 2
    across = upper[links.first] != upper[links.second]
    cut = np.cross(3 * np.array(steps[1]), 2 * np.array(steps[2]))
    assert links.lengths[across].sum() == pytest.approx(np.linalg.norm(cut))


def test_counted_links_of_a_cloud_give_the_length_of_a_curve():
    rng = np.random.default_rng(0)
    flat = np.column_stack([rng.random((6000, 2)), np.zeros(6000)])
    cloud = Shape.from_points(flat, areas=np.full(6000, 1 / 6000)).with_adjacency("knn")
    x, y = flat[:, 0] - 0.5, flat[:, 1] - 0.5
    inside = np.hypot(x, y) < 0.4
    links = cloud.links
    both = inside[links.first] & inside[links.second]
    found = []
    for angle in np.linspace(0, 3, 13):
        half = x * np.cos(angle) + y * np.sin(angle) > 0
        across = half[links.first] != half[links.second]
        found.append(links.lengths[across & both].sum())
    # Random points: a single line meets some tenths more or fewer links than it should.
    assert np.mean(found) == pytest.approx(0.8, rel=0.03)
    assert found == pytest.approx([0.8] * 13, rel=0.25)


def test_links_of_a_mesh_whose_neighbours_are_the_nearest_are_counted():
    vertices, faces = shapes.sphere(3)
    shape = Shape.from_mesh(vertices, faces).with_adjacency("knn")
    upper = shape.points[:, 2] > 0
    across = upper[shape.links.first] != upper[shape.links.second]
    assert shape.links.lengths[across].sum() == pytest.approx(2 * np.pi, rel=0.15)


def test_a_deformed_mesh_has_the_links_of_the_original_in_its_own_lengths():
    shape = Shape.from_mesh(*shapes.cube())
    twice = shape.deformed(2.0 * shape.geometry.vertices, space="twice")
    assert (twice.links.first == shape.links.first).all()
    assert twice.links.lengths == pytest.approx(2 * shape.links.lengths)
    # A deformation that brings vertices to one position joins nothing.
    flat = shape.geometry.vertices * [1.0, 1.0, 0.0]
    assert len(shape.deformed(flat, space="flat").links.first) == len(shape.links.first)


@given(st.integers(0, 2**32), st.integers(2, 4))
@settings(max_examples=20, deadline=None)
def test_a_boundary_is_as_long_on_a_coarse_shape(seed, n):
    shape = Shape.from_mesh(*shapes.bent_capsule(9, 8))
    coarse = coarsen(shape, 30)
    labels = np.random.default_rng(seed).integers(0, n, coarse.n_elements)

    def length(level, labels):
        links = level.links
        return links.lengths[labels[links.first] != labels[links.second]].sum()

    assert length(coarse, labels) == pytest.approx(length(shape, labels[coarse.members]))


def test_a_shape_without_neighbours_has_no_boundaries():
    with pytest.raises(ShapeError, match=r"'shape' has no boundaries.*--adjacency knn"):
        _ = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]]).links
