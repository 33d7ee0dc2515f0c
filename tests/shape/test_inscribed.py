"""Lower bounds of hull volumes, against Qhull: never above, seldom far below."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core.shape import inscribed
from moseg_core.shape.shape import Shape


def bounds_of(shape, labels):
    """(n,) float: the bounds of all parts of one labelling."""
    wanted = np.ones((1, int(labels.max()) + 1), bool)
    volumes = np.full(wanted.shape, np.nan)
    shape.made_from.clear()
    shape.farthest_vertices.least_volumes(np.asarray(labels, np.int32)[None], wanted, volumes)
    return volumes[0]


def hull_of(part):
    return ConvexHull(part.vertices - part.vertices.mean(axis=0)).volume


def nearest(shape, seed, n):
    """Labels by the nearest of some elements."""
    rng = np.random.default_rng(seed)
    places = shape.points[rng.choice(shape.n_elements, n, replace=False)]
    return ((shape.points[:, None] - places) ** 2).sum(axis=2).argmin(axis=1)


@pytest.mark.parametrize("name", ["hammer", "horse"])
@pytest.mark.parametrize("n_elements", [300, 2000, None])
def test_parts_of_meshes_have_hulls_that_are_a_little_larger(name, n_elements):
    shape = moseg.load(moseg.sample_path(name))
    level = shape if n_elements is None else moseg.coarsen(shape, n_elements)
    labels = nearest(level, 1, 7)
    parts = moseg.Segmentation.from_labels(level, labels, 7).parts
    bounds, hulls = bounds_of(level, labels), np.array([hull_of(part) for part in parts])
    assert (bounds < hulls).all()
    assert (bounds > 0.9 * hulls).all()
    assert bounds.sum() > 0.96 * hulls.sum()


def triangles_of(points):
    """A shape of loose triangles, three points each."""
    return Shape.from_mesh(points, np.arange(len(points)).reshape(-1, 3))


@given(
    st.integers(0, 10_000),
    st.integers(2, 60),
    st.sampled_from(["ball", "cube", "sphere", "lattice", "rods"]),
    st.sampled_from([1.0, 3.0, 30.0, 1e4]),
    st.sampled_from([1e-3, 1.0, 1e5]),
)
@example(0, 2, "cube", 1.0, 1.0)
@settings(max_examples=400, deadline=None)
def test_it_is_never_more_than_the_hull_has(seed, count, kind, stretch, size):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(3 * count, 3))
    if kind == "sphere":
        points /= np.linalg.norm(points, axis=1)[:, None]
    if kind == "cube":
        points = rng.choice([-1.0, 1.0], points.shape)
    if kind == "lattice":
        points = points.round()
    if kind == "rods":  # far from convex, and folded where directions go from rod to rod
        points *= 10.0 ** rng.uniform(-2, 1, (len(points), 1))
    turn = Rotation.random(random_state=seed).as_matrix()
    points = size * (points * [stretch, 1.0, 1.0 / stretch**0.5]) @ turn + rng.normal(size=3)
    points[:3] = np.eye(3)  # some face has an area
    shape = triangles_of(points)
    (bound,) = bounds_of(shape, np.zeros(count, int))
    try:
        hull = ConvexHull(points - points.mean(axis=0)).volume
    except QhullError:  # flat
        hull = 0.0
    assert 0.0 <= bound <= hull


def test_surfaces_that_do_not_go_once_around_say_nothing():
    rng = np.random.default_rng(0)
    directions, triangles = inscribed._sphere()
    points = rng.normal(size=(40, 3))
    which = (points @ directions.T).argmax(axis=0).astype(np.int32)
    volume = inscribed._enclosed(points, which, directions, triangles)
    assert 0.0 < volume < ConvexHull(points).volume
    twice = np.concatenate([triangles, triangles])
    assert inscribed._enclosed(points, which, directions, twice) == 0.0
    inside_out = np.ascontiguousarray(triangles[:, ::-1])
    assert inscribed._enclosed(points, which, directions, inside_out) == 0.0
    away = points + np.array([30.0, 0.0, 0.0])
    assert inscribed._enclosed(away, which, directions, triangles) == 0.0


def test_flat_and_empty_parts_and_those_that_nobody_asks_for():
    rng = np.random.default_rng(0)
    plane = rng.normal(size=(30, 3)) * [1.0, 1.0, 0.0]
    shape = triangles_of(np.concatenate([plane, rng.normal(size=(30, 3))]))
    labels = np.repeat([[0, 2]], 10, axis=1).astype(np.int32).reshape(1, -1)
    labels = np.sort(labels, axis=1)
    volumes = np.full((1, 4), -1.0)
    wanted = np.array([[True, True, True, False]])
    shape.farthest_vertices.least_volumes(labels, wanted, volumes)
    assert volumes[0, [0, 1, 3]].tolist() == [0.0, 0.0, -1.0]
    assert volumes[0, 2] > 0.0


def test_blocks_that_are_in_a_part_as_a_whole_change_nothing(monkeypatch):
    shape = moseg.coarsen(moseg.load(moseg.sample_path("horse")), 600)
    labels = nearest(shape, 3, 5)
    expected = bounds_of(shape, labels)
    for size in (2, 3, 1000):
        monkeypatch.setattr(inscribed, "_BLOCK", size)
        assert bounds_of(shape, labels).tolist() == pytest.approx(expected.tolist(), rel=1e-9)


def test_of_more_elements_there_is_no_table(monkeypatch):
    shape = triangles_of(np.random.default_rng(0).normal(size=(30, 3)))
    assert shape.farthest_vertices is not None
    monkeypatch.setattr(inscribed, "_MOST_ELEMENTS", 9)
    shape.made_from.clear()
    assert shape.farthest_vertices is None
