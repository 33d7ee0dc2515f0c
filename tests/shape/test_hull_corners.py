"""The vertices that hulls of coarse parts are made from, against hulls of all vertices."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

import moseg_core as moseg
from moseg_core.shape.hull_corners import find_hull_corners


def parts_of(shape, seed, n=5):
    rng = np.random.default_rng(seed)
    places = shape.points[rng.choice(shape.n_elements, n, replace=False)]
    labels = ((shape.points[:, None] - places) ** 2).sum(axis=2).argmin(axis=1)
    return moseg.Segmentation.from_labels(shape, labels.astype(np.int32), n).parts


@pytest.mark.parametrize("name", ["hammer", "horse"])
@pytest.mark.parametrize("n_elements", [60, 700])
def test_hulls_and_extents_of_coarse_parts_are_those_of_all_vertices(name, n_elements):
    coarse = moseg.coarsen(moseg.load(moseg.sample_path(name)), n_elements)
    for part in parts_of(coarse, seed=n_elements):
        few, every = part.extreme_vertices, part.vertices
        assert len(few) <= len(every)
        assert {row.tobytes() for row in few} <= {row.tobytes() for row in every}
        exact = ConvexHull(every - every.mean(axis=0)).volume
        assert ConvexHull(few - every.mean(axis=0)).volume == pytest.approx(exact, rel=1e-12)
        extent = np.ptp(every @ part.axes.T, axis=0)
        np.testing.assert_allclose(np.ptp(few @ part.axes.T, axis=0), extent, rtol=1e-12)


def test_a_bowl_keeps_its_rim_and_bottom_a_dent_is_left_out():
    n = 12
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    dent = np.maximum(0.0, 1.0 - np.hypot(x - 6, y - 6) / 3)
    vertices = np.stack([x, y, -0.01 * (x - 6) ** 2 - 0.01 * (y - 6) ** 2 - dent], axis=-1)
    i, j = (a.reshape(-1) for a in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    corner = i * (n + 1) + j
    faces = np.stack([corner, corner + n + 1, corner + n + 2, corner + 1], axis=1)
    shape = moseg.Shape.from_mesh(vertices.reshape(-1, 3), faces)
    found = find_hull_corners(shape.geometry, np.zeros(len(faces), np.int64), np.zeros((1, 3)))
    kept = set(found.of(np.array([0])).tolist())
    bottom = 6 * (n + 1) + 6
    assert bottom in kept  # the tip of the dent is the lowest point
    assert bottom + 1 not in kept  # its slope is inside
    assert {0, n, n * (n + 1), (n + 1) ** 2 - 1} <= kept


def test_flat_groups_keep_all_their_vertices():
    vertices = [[x, y, 0.0] for x in range(4) for y in range(3)]
    faces = [
        [3 * x + y, 3 * x + y + 3, 3 * x + y + 4, 3 * x + y + 1] for x in range(3) for y in range(2)
    ]
    shape = moseg.Shape.from_mesh(vertices, faces)
    found = find_hull_corners(shape.geometry, np.zeros(6, np.int64), np.zeros((1, 3)))
    assert found.of(np.array([0])).tolist() == list(range(12))


def test_shared_vertices_come_once():
    coarse = moseg.coarsen(moseg.load(moseg.sample_path("hammer")), 50)
    together = coarse.hull_corners.of(np.arange(coarse.n_elements))
    assert (np.diff(together) > 0).all()
    assert len(together) < len(coarse.hull_corners.vertices)


def test_a_part_of_input_elements_has_all_its_vertices():
    part = parts_of(moseg.load(moseg.sample_path("hammer")), seed=0)[0]
    assert part.extreme_vertices is part.vertices


def test_far_from_the_origin_nothing_is_lost():
    shape = moseg.load(moseg.sample_path("hammer"))
    mesh = shape.geometry
    away = moseg.Shape.from_mesh(mesh.vertices + 1e5, mesh.triangles)
    coarse = moseg.coarsen(shape, 300)
    near = coarse.hull_corners
    far = find_hull_corners(away.geometry, coarse.members, coarse.points)
    # Rounding at 1e5 moves a vertex by 1e-11: a few that stick out no further may change sides.
    assert len(np.setxor1d(near.of(np.arange(300)), far.of(np.arange(300)))) < 20
