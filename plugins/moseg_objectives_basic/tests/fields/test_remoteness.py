"""Remoteness against closed forms, and on groups against single elements."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.fields import remoteness as module
from moseg_objectives_basic.fields.remoteness import remoteness
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core import Shape


def rod(edge):
    box = trimesh.creation.box((10, 0.3, 0.3))
    return Shape.from_mesh(*trimesh.remesh.subdivide_to_size(box.vertices, box.faces, edge))


@pytest.mark.parametrize("edge", [0.5, 0.15])
def test_a_rod(edge):
    """At the distance x from the middle of a rod of length 2 the mean distance is (1 + x^2) / 2."""
    shape = rod(edge)
    values = remoteness(shape)
    assert values == pytest.approx(1 + (shape.points[:, 0] / 5) ** 2, abs=0.1)
    assert values.min() == pytest.approx(1, abs=1e-3)
    ends = np.abs(shape.points[:, 0]) > 4.99
    assert values[ends] == pytest.approx(2, abs=0.1)


def test_on_a_ball_everything_is_in_the_middle(make):
    assert remoteness(Shape.from_mesh(*make.ball(4))) == pytest.approx(1, abs=0.01)


def test_fewer_groups_of_elements_do_as_well(monkeypatch):
    hammer = moseg.load(moseg.sample_path("hammer"))
    values = remoteness(hammer)
    monkeypatch.setattr(module, "_MOST", 500)
    rough = remoteness(hammer)
    assert rough == pytest.approx(values, abs=0.08)
    assert np.median(np.abs(rough - values)) < 0.01
    # Values are spread, not one for each group.
    assert len(set(rough.round(9).tolist())) > hammer.n_elements // 2


@pytest.mark.parametrize("name", ["hammer", "horse"])
def test_fewer_places_to_go_to_change_little(name, monkeypatch):
    shape = moseg.load(moseg.sample_path(name))
    values = remoteness(shape)
    monkeypatch.setattr(module, "_TO", shape.n_elements)
    assert values == pytest.approx(remoteness(shape), rel=0.005)


def test_distances_are_those_of_the_shortest_paths(make):
    """By the book: Floyd and Warshall over neighbours and theirs."""
    shape = Shape.from_mesh(*make.ball(1))
    n = shape.n_elements
    near = shape.adjacency.matrix.toarray().astype(int)
    near = near + near @ near
    lengths = np.linalg.norm(shape.points[:, None] - shape.points, axis=2)
    distances = np.where(near > 0, lengths, np.inf)
    np.fill_diagonal(distances, 0)
    for k in range(n):
        distances = np.minimum(distances, distances[:, k, None] + distances[k])
    means = distances @ shape.areas
    assert remoteness(shape) == pytest.approx(means / means.min())


def test_another_component_is_far_away(make):
    vertices, faces = make.ball(2)
    small = np.concatenate([vertices, 0.2 * vertices + 9])
    values = remoteness(Shape.from_mesh(small, np.concatenate([faces, faces + len(vertices)])))
    assert values[: len(faces)] == pytest.approx(1, abs=0.02)
    assert values[len(faces) :].min() > 2


def test_motion_size_and_reflection_change_nothing(make):
    vertices, faces = make.ball(2)
    vertices = vertices * [3, 2, 1]
    before = remoteness(Shape.from_mesh(vertices, faces))
    turn = Rotation.from_rotvec([0.4, -1.1, 0.7])
    moved = make.moved((vertices, faces), turn=turn, scale=30, shift=[40, 50, 60])
    assert remoteness(Shape.from_mesh(*moved)) == pytest.approx(before)
    assert remoteness(Shape.from_mesh(vertices * [1, -1, 1], faces[:, ::-1])) == pytest.approx(
        before
    )


def test_one_element_is_the_middle(make):
    assert remoteness(Shape.from_mesh(*make.rectangle(2, 1))).tolist() == [1.0]
