"""Shapes of points and cells, and what can be estimated of any shape."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.memo import Memo
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from moseg_core.shape.subshape import subshape
from tests import shapes

BLOCK = np.ones((4, 3, 2), bool)


@pytest.fixture(scope="module")
def cloud():
    rng = np.random.default_rng(0)
    points = rng.normal(size=(3000, 3))
    return Shape.from_points(points / np.linalg.norm(points, axis=1, keepdims=True), name="ball")


@pytest.fixture(scope="module", params=["cloud", "near", "solid", "surface"])
def made(request, cloud):
    ball = (np.indices((16, 16, 16)) - 7.5).transpose(1, 2, 3, 0)
    occupied = np.linalg.norm(ball, axis=-1) < 7.5
    return {
        "cloud": lambda: cloud,
        "near": lambda: cloud.with_adjacency("knn"),
        "solid": lambda: Shape.from_voxels(occupied, pitch=0.1),
        "surface": lambda: Shape.from_voxels(occupied, pitch=0.1, elements="surface"),
    }[request.param]()


def test_what_each_kind_is(cloud):
    solid = Shape.from_voxels(BLOCK)
    surface = solid.with_elements("surface")
    told = [(s.noun, s.solid, s.has_surface, s.volume) for s in (cloud, solid, surface)]
    assert told == [
        ("point", False, False, None),
        ("cell", True, False, 24.0),
        ("cell", False, True, 24.0),
    ]
    assert cloud.adjacency is None
    assert cloud.volume_reason == "it is a point cloud"
    assert solid.notes == surface.notes == ()
    assert surface.with_elements("solid").key == solid.key


def test_the_same_places_measured_differently_have_different_keys():
    points = shapes.cube()[0]
    weighted = Shape.from_points(points, areas=np.arange(1, 9))
    assert Shape.from_points(points).key != weighted.key
    one = np.ones((1, 1, 1), bool)
    kinds = [Shape.from_voxels(one, elements=kind) for kind in ("solid", "surface")]
    assert kinds[0].key != kinds[1].key


def test_parts_of_each_kind_have_the_vertices_of_their_elements(made):
    labels = (made.points[:, 0] > made.points[:, 0].mean()).astype(int)
    for part in Segmentation.from_labels(made, labels, 2).parts:
        corners = made.geometry.corners.reshape(made.n_elements, -1)[part.elements]
        expected = np.unique(made.geometry.vertices[corners].reshape(-1, 3), axis=0)
        np.testing.assert_array_equal(np.unique(part.vertices, axis=0), expected)
        shown = np.isin(made.geometry.triangle_polygon, part.elements)
        np.testing.assert_array_equal(
            part.vertices[part.triangles], made.geometry.vertices[made.geometry.triangles[shown]]
        )


def test_coarse_parts_of_each_kind_are_those_of_the_elements(made):
    coarse = coarsen(made, 100)
    assert 80 <= coarse.n_elements <= 120
    labels = np.arange(coarse.n_elements) % 2
    memo = Memo()
    rough = Segmentation.from_labels(coarse, labels, 2, memo=memo).parts
    fine = Segmentation.from_labels(made, labels[coarse.members], 2, memo=memo).parts
    for a, b in zip(rough, fine, strict=True):
        assert (a.membership, a.n_elements) == (b.membership, b.n_elements)
        np.testing.assert_allclose(a.scales, b.scales, rtol=1e-9)
        assert a.box_diagonal == pytest.approx(b.box_diagonal, rel=1e-9)
        hull = "basic:hull_volume"
        assert a.measure(hull) == pytest.approx(b.measure(hull), rel=1e-7)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_units_decide_nothing(scale):
    solid = Shape.from_voxels(BLOCK, pitch=scale)
    labels = np.arange(24) % 2
    parts = Segmentation.from_labels(solid, labels, 2)
    assert not parts.summary.empty(solid).any()
    one = Segmentation.from_labels(solid, [0] + [1] * 23, 2)
    assert not one.summary.empty(solid).any()  # a single cell has an extent
    dots = Shape.from_points(scale * shapes.cube()[0])
    single = Segmentation.from_labels(dots, [0] + [1] * 7, 2)
    assert single.summary.empty(dots).tolist() == [True, False]  # a single point has none


def test_with_adjacency(cloud):
    near = cloud.with_adjacency("knn")
    assert near.adjacency.components()[0] == 1
    assert "the 10 nearest points count as neighbours, where mutually so" in near.notes
    assert near.key != cloud.key
    assert cloud.with_adjacency("auto") is cloud
    assert near.with_adjacency("none").adjacency is None
    with pytest.raises(UsageError, match="did you mean 'knn'"):
        cloud.with_adjacency("kn")


HALVES = shapes.joined(shapes.strip(3), shapes.moved(shapes.strip(3), np.eye(3), 1, (3, 0, 0.1)))
TORN = Shape.from_mesh(*HALVES)


def links(shape):
    return None if shape.adjacency is None else set(map(tuple, shape.adjacency.pairs.tolist()))


@pytest.mark.parametrize(
    "made",
    [
        TORN,
        Shape.from_voxels(BLOCK),
        Shape.from_voxels(BLOCK, elements="surface"),
        Shape.from_points(HALVES[0]),
        coarsen(TORN, 3),
        TORN.deformed(np.abs(TORN.geometry.vertices - [3, 0, 0]) * [1, 1, 0], space="folded"),
        subshape(TORN, np.array([0, 1, 3, 4])),
    ],
    ids=["mesh", "solid", "cells", "points", "coarse", "folded", "part"],
)
@pytest.mark.parametrize("asked", [["knn"], ["none"], ["knn", "none", "knn"]])
def test_auto_restores_what_the_geometry_says(made, asked):
    other = made
    for which in asked:
        other = other.with_adjacency(which, nearest=8)
        assert other.adjacency_source == which
    assert links(other) != links(made) or asked == ["none"]
    again = other.with_adjacency("auto")
    assert links(again) == links(made)
    assert again.adjacency_source == "auto"
    assert again.key == made.key
    assert set(made.notes) <= set(again.notes)  # of a part the whole has said it
    assert not any("nearest" in note for note in again.notes)


def test_what_was_asked_for_before_does_not_count():
    few = TORN.with_adjacency("knn", nearest=1)
    more = TORN.with_adjacency("knn", nearest=5)
    assert links(more.with_adjacency("knn", nearest=1)) == links(few) != links(more)
    assert more.with_adjacency("knn", nearest=1).notes == few.notes


def test_nearest_elements_are_added_to_those_that_touch():
    shape = TORN
    assert "the surface has 2 connected components" in shape.notes
    joined = shape.with_adjacency("knn", nearest=2)
    assert joined.adjacency.components()[0] == 1
    assert not any("components" in note for note in joined.notes)
    for a, b in shape.adjacency.pairs.tolist():
        assert b in joined.adjacency.neighbors(a)


def test_what_only_some_kinds_can_do(cloud):
    with pytest.raises(ShapeError, match="'ball' is a point cloud; only of a voxel grid"):
        cloud.with_elements("surface")
    with pytest.raises(ShapeError, match="'ball' is a point cloud; only a polygon mesh can be"):
        cloud.deformed(cloud.geometry.vertices, space="x")


def test_separate_cells_are_noted():
    occupied = np.zeros((3, 1, 1), bool)
    occupied[0] = occupied[2] = True
    assert Shape.from_voxels(occupied).notes == ("the surface has 2 connected components",)
