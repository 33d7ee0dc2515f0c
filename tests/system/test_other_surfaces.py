"""The sample hammer as a point cloud, as voxels and as a soup: cut as the mesh is."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import moseg_core as moseg


@pytest.fixture(scope="module")
def hammer():
    return moseg.load(moseg.sample_path("hammer"))


def _solve(shape: moseg.Shape) -> moseg.Result:
    found = moseg.load_recipe("paper_hammer")
    problem = moseg.Problem(found.labels, found.minimize)
    return moseg.segment(shape, problem, defaults=found.statement.search)


@pytest.fixture(scope="module")
def expected(hammer):
    return _solve(hammer).labels


def _trimesh(shape):
    return trimesh.Trimesh(shape.geometry.vertices, shape.geometry.triangles, process=False)


def _centroids(hammer, folder):
    path = folder / "hammer.xyz"
    np.savetxt(path, hammer.points)
    return moseg.load(path).with_adjacency("knn").with_volume("hull")


def _samples(hammer, folder):
    path = folder / "hammer.csv"
    points = trimesh.sample.sample_surface(_trimesh(hammer), 8000, seed=1)[0]
    np.savetxt(path, points, delimiter=",")
    return moseg.load(path).with_adjacency("knn").with_volume("hull")


def _samples_with_normals(hammer, folder):
    mesh = _trimesh(hammer)
    points, face = trimesh.sample.sample_surface(mesh, 8000, seed=2)
    cloud = moseg.Shape.from_points(points, normals=mesh.face_normals[face])
    return cloud.with_adjacency("knn").with_volume("winding")


def _cells(hammer, folder, elements):
    pitch = hammer.frame.scale / 100
    grid = _trimesh(hammer).voxelized(pitch).fill()
    origin = grid.transform[:3, 3] - pitch / 2
    occupied = np.asarray(grid.matrix)
    return moseg.Shape.from_voxels(occupied, pitch=pitch, origin=origin, elements=elements)


def _solid(hammer, folder):
    return _cells(hammer, folder, "solid")


def _surface(hammer, folder):
    return _cells(hammer, folder, "surface")


def _soup(hammer, folder):
    """Triangles that are smaller than their places, and a little off them."""
    path = folder / "hammer.stl"
    corners = hammer.geometry.vertices[hammer.geometry.triangles]
    middle = corners.mean(axis=1, keepdims=True)
    noise = np.random.default_rng(0).normal(size=middle.shape) * 2e-4 * hammer.frame.scale
    soup = (middle + noise + 0.95 * (corners - middle)).reshape(-1, 3)
    trimesh.Trimesh(soup, np.arange(len(soup)).reshape(-1, 3), process=False).export(path)
    return moseg.load(path).with_adjacency("knn").with_volume("winding")


@pytest.mark.slow
@pytest.mark.parametrize(
    "version", [_centroids, _samples, _samples_with_normals, _solid, _surface, _soup]
)
def test_every_version_is_cut_like_the_mesh(version, hammer, expected, tmp_path):
    shape = version(hammer, tmp_path)
    result = _solve(shape)
    nearest = cKDTree(shape.points).query(hammer.points)[1]
    alike = result.labels[nearest] == expected
    assert hammer.areas[alike].sum() / hammer.area >= 0.95
