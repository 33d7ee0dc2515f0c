"""What is in reach, against shortest paths by the book and against areas that are known."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_learn import neighbourhoods as module
from moseg_learn.neighbourhoods import Neighbourhoods

import moseg_core as moseg
from moseg_core import Shape


def ball(rounds, stretch=(1, 1, 1)):
    mesh = trimesh.creation.icosphere(subdivisions=rounds)
    return Shape.from_mesh(mesh.vertices * stretch, mesh.faces)


def sheet(n):
    """A square of side 1 in n x n squares."""
    x, y = (np.ravel(each) for each in np.meshgrid(*[np.linspace(0, 1, n + 1)] * 2))
    corner = np.arange(n * (n + 1)).reshape(n, n + 1)[:, :-1].ravel()
    faces = np.stack([corner, corner + 1, corner + n + 2, corner + n + 1], axis=1)
    return Shape.from_mesh(np.c_[x, y, 0 * x], faces)


def paths_by_the_book(shape):
    """(F, F) float: Floyd and Warshall over neighbours and theirs."""
    near = shape.adjacency.matrix.toarray().astype(int)
    near = near + near @ near
    lengths = np.linalg.norm(shape.points[:, None] - shape.points, axis=2)
    distances = np.where(near > 0, lengths, np.inf)
    np.fill_diagonal(distances, 0)
    for k in range(len(near)):
        distances = np.minimum(distances, distances[:, k, None] + distances[k])
    return distances


@pytest.mark.parametrize("radius", [0.05, 0.2, 0.45])
def test_shares_are_those_of_the_shortest_paths(radius):
    shape = ball(1, (2, 1, 1))
    distances = paths_by_the_book(shape)
    within = Neighbourhoods.of(shape).within(radius)
    reach = radius * shape.box_diagonal
    for i in range(shape.n_elements):
        for j in range(shape.n_elements):
            half = np.sqrt(shape.areas[j] / np.pi)
            inside = min(max((reach - distances[i, j] + half) / (2 * half), 0), 1)
            assert within[i, j] == pytest.approx(inside, abs=1e-9)


def test_area_in_reach_is_that_of_a_disc():
    shape = sheet(36)
    middle = int(((shape.points - [0.5, 0.5, 0]) ** 2).sum(axis=1).argmin())
    for radius in (0.04, 0.08, 0.16, 0.3):
        area = float(Neighbourhoods.of(shape).within(radius)[middle] @ shape.areas)
        assert area == pytest.approx(np.pi * (radius * np.sqrt(2)) ** 2, rel=0.12)


def test_all_is_in_reach_but_other_components():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    two = np.concatenate([mesh.vertices, mesh.vertices + 5])
    shape = Shape.from_mesh(two, np.concatenate([mesh.faces, mesh.faces + len(mesh.vertices)]))
    within = Neighbourhoods.of(shape).within(2.0)
    same = np.arange(640)[:, None] // 320 == np.arange(640) // 320
    assert np.array_equal(within, same.astype(float))


def test_groups_and_distances_are_made_once(monkeypatch):
    shape = ball(2)
    around = Neighbourhoods.of(shape)
    around.within(0.04)
    monkeypatch.setattr(module.csgraph, "dijkstra", None)
    around.within(0.3)
    assert Neighbourhoods.of(shape) is around
    with pytest.raises(TypeError):
        around.within(0.6)  # farther than paths were followed


def test_means_of_groups_and_values_on_elements(monkeypatch):
    monkeypatch.setattr(module, "MOST", 300)
    shape = ball(4, (1, 0.7, 0.5))
    around = Neighbourhoods.of(shape)
    members, count = around.groups.members, around.groups.n_elements
    assert 200 < count <= 300 < shape.n_elements
    values = np.stack([shape.points[:, 0], shape.points[:, 2] ** 2], axis=1)
    means = around.of_elements(values)
    for group in range(count):
        own = members == group
        assert means[group] == pytest.approx(np.average(values[own], 0, shape.areas[own]))
    assert around.on_elements(np.ones(count)) == pytest.approx(1)
    assert around.on_elements(means) == pytest.approx(values, abs=0.1)
    element = 1234
    links = around.groups.adjacency
    start, stop = links.indptr[members[element]], links.indptr[members[element] + 1]
    beside = [members[element], *links.indices[start:stop]]
    weights = 1 / ((shape.points[element] - around.groups.points[beside]) ** 2).sum(axis=1)
    assert around.on_elements(means)[element] == pytest.approx(
        np.average(means[beside], 0, weights)
    )


def test_fewer_groups_do_as_well(monkeypatch):
    horse = moseg.load(moseg.sample_path("horse"))
    areas = []
    for most in (1500, 700):
        monkeypatch.setattr(module, "MOST", most)
        shape = moseg.load(moseg.sample_path("horse"))
        around = Neighbourhoods.of(shape)
        assert around.groups.n_elements <= most
        areas.append(around.on_elements(around.within(0.16) @ around.areas) / horse.area)
    assert np.median(np.abs(np.log(areas[0] / areas[1]))) < 0.05
