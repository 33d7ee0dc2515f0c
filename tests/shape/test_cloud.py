"""Point clouds: what is refused, and how well areas are estimated."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from moseg_core.errors import ShapeError
from moseg_core.shape.cloud import PointCloud, estimated_areas
from moseg_core.shape.shape import Shape
from tests import shapes


def random_disc(rng, n, radius=1.0):
    angle, r = rng.uniform(0, 2 * np.pi, n), radius * np.sqrt(rng.random(n))
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), np.zeros(n)])


def literal_areas(points, nearest):
    areas = []
    for point in points:
        squared = np.sort(((points - point) ** 2).sum(axis=1))[1 : nearest + 1]
        areas.append(np.pi * squared.sum() / sum(range(1, nearest + 1)))
    return areas


@pytest.mark.parametrize("n", [2, 5, 60])
def test_areas_by_the_book(n):
    points = np.random.default_rng(n).normal(size=(n, 3))
    expected = literal_areas(points, min(8, n - 1))
    np.testing.assert_allclose(estimated_areas(points), expected, rtol=1e-9)


def test_estimates_of_random_points_in_a_plane_are_not_biased():
    points = random_disc(np.random.default_rng(0), 20_000)
    inner = np.linalg.norm(points, axis=1) < 0.9
    areas = estimated_areas(points)[inner]
    assert areas.mean() == pytest.approx(np.pi / len(points), rel=0.01)
    assert areas.std() / areas.mean() == pytest.approx(0.4, abs=0.03)


@pytest.mark.parametrize(
    ("rows", "area", "excess"), [((1.0, 0.0), 1.0, 1.05), ((np.sqrt(3) / 2, 0.5), 0.866, 1.21)]
)
def test_lattices_come_out_too_large_by_what_is_documented(rows, area, excess):
    height, shift = rows
    i, j = np.meshgrid(np.arange(11.0), np.arange(11.0), indexing="ij")
    points = np.stack([j + shift * (i % 2), height * i, 0 * i], axis=-1).reshape(-1, 3)
    assert estimated_areas(points)[60] / area == pytest.approx(excess, abs=0.005)


@pytest.mark.parametrize("n", [1000, 8000])
def test_a_ball_has_its_area(n):
    ball = trimesh.creation.icosphere(subdivisions=5)
    points = trimesh.sample.sample_surface(ball, n, seed=2)[0]
    assert estimated_areas(points).sum() == pytest.approx(4 * np.pi, rel=0.03)


def test_areas_follow_the_density():
    rng = np.random.default_rng(3)
    sparse, dense = random_disc(rng, 500), random_disc(rng, 4000)
    areas = estimated_areas(np.concatenate([sparse, dense + np.array([5.0, 0, 0])]))
    assert areas[:500].sum() == pytest.approx(areas[500:].sum(), rel=0.1)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_areas_turn_and_scale_with_the_points(scale):
    points = np.random.default_rng(4).normal(size=(50, 3))
    turned = scale * points @ shapes.rotation(5).T + 3 * scale
    np.testing.assert_allclose(
        estimated_areas(turned), scale**2 * estimated_areas(points), rtol=1e-6
    )


def test_given_areas_and_normals_are_kept():
    cloud = PointCloud.from_points(np.eye(3), areas=[1, 0, 2], normals=-np.eye(3))
    assert cloud.areas.tolist() == [1.0, 0.0, 2.0]
    np.testing.assert_array_equal(cloud.normals, -np.eye(3))
    for array in (cloud.areas, cloud.normals, cloud.vertices):
        assert not array.flags.writeable


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"points": []}, "no points"),
        ({"points": 3.0}, "points must have the shape"),
        ({"points": [[1, 2]]}, r"points must have the shape \(F, 3\), not \(1, 2\)"),
        ({"points": [["a", "b", "c"]]}, "points must be an array of numbers"),
        ({"points": [[0, 0, np.inf], [0, np.nan, 0]]}, "no point is finite"),
        ({"points": [[0, 0, 0], [0, np.nan, 0]]}, "all points are in one place"),
        ({"points": [[1, 2, 3]] * 12}, "all points are in one place"),
        ({"points": [[1, 2, 3]]}, "all points are in one place"),
        ({"points": np.eye(3), "areas": [1, 2]}, r"areas must have the shape \(3,\), not \(2,\)"),
        ({"points": np.eye(3), "areas": [1, -1, 1]}, "must not be negative"),
        ({"points": np.eye(3), "areas": [0, 0, 0]}, "not all of them 0"),
        ({"points": np.eye(3), "normals": np.eye(2)}, r"normals must have the shape \(3, 3\)"),
    ],
)
def test_malformed_clouds_are_refused(arguments, message):
    with pytest.raises(ShapeError, match=message):
        PointCloud.from_points(**arguments)


def test_points_that_are_not_finite_stand_by_the_one_before_without_weight():
    points = np.random.default_rng(0).random((9, 3))
    gaps = np.insert(points, [0, 4, 4, 9], np.nan, axis=0)
    gaps[5, 1] = np.inf
    cloud = PointCloud.from_points(gaps)
    lost = [0, 5, 6, 12]
    assert cloud.stand_in.tolist() == [1, 1, 2, 3, 4, 4, 4, 7, 8, 9, 10, 11, 11]
    assert cloud.n_unplaced == 4
    np.testing.assert_array_equal(np.delete(cloud.vertices, lost, axis=0), points)
    np.testing.assert_array_equal(np.delete(cloud.areas, lost), estimated_areas(points))
    assert cloud.areas[lost].tolist() == [0.0] * 4
    given = PointCloud.from_points(gaps, areas=np.arange(13.0), normals=gaps)
    assert given.areas[lost].tolist() == [0.0] * 4
    assert given.normals[lost].tolist() == [[0.0] * 3] * 4
    assert len(given.notes) == 1


def test_areas_and_normals_that_are_not_finite_are_counted_where_points_have_a_place():
    points = np.random.default_rng(0).random((9, 3))
    points[4] = np.nan
    areas, normals = np.ones(9), points.copy()
    areas[[2, 4]], normals[[1, 2]] = np.nan, np.inf
    cloud = PointCloud.from_points(points, areas=areas, normals=normals)
    assert cloud.areas.tolist() == [1, 1, 0, 1, 0, 1, 1, 1, 1]
    assert cloud.normals[[1, 2, 4]].tolist() == [[0.0] * 3] * 3
    assert cloud.notes[1:] == (
        "areas that are not finite: 1; they are taken to be 0",
        "normals that are not finite: 2; they are taken to be 0",
    )


def test_neighbours_are_those_of_the_points_that_have_a_place():
    points = np.random.default_rng(0).random((60, 3))
    gaps = np.insert(points, 30, [[np.nan] * 3] * 15, axis=0)
    whole = Shape.from_points(points, adjacency="knn")
    shape = Shape.from_points(gaps, adjacency="knn")
    place = np.delete(np.arange(75), range(30, 45))
    pairs = {tuple(pair) for pair in shape.adjacency.pairs.tolist()}
    assert {tuple(pair) for pair in place[whole.adjacency.pairs].tolist()} <= pairs
    assert [shape.adjacency.neighbors(k).tolist() for k in range(30, 45)] == [[29]] * 15
    assert sum("not finite" in note for note in shape.notes) == 1
    assert not any("no area" in note for note in shape.notes)
