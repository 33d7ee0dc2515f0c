"""Boundaries of parts: lengths and means of fields in closed form, alike on all levels."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError, ShapeError
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.components.test_field import Heights


def slices(nx: int = 12) -> Segmentation:
    """A strip of length 6 and width 2, in three parts along x that end at 2 and 5."""
    shape = Shape.from_mesh(*shapes.rectangle(6.0, 2.0, nx, 4))
    labels = np.digitize(shape.points[:, 0], [2.0, 5.0])
    along = Heights(lambda shape: shape.points[:, 0])
    return Segmentation.from_labels(shape, labels, 3, lookup=along)


def test_lengths():
    a, b, c = slices().parts
    assert [part.boundary.length for part in (a, b, c)] == pytest.approx([2.0, 4.0, 2.0])
    assert a.boundary_with(b).length == b.boundary_with(a).length == pytest.approx(2.0)
    assert a.boundary_with(c).length == 0.0
    assert a.boundary_lengths([c, b]).tolist() == [0.0, a.boundary_with(b).length]
    assert a.boundary_lengths([]).tolist() == []
    found = slices().boundaries
    assert found.lengths == pytest.approx(np.array([[0.0, 2, 0], [2, 0, 2], [0, 2, 0]]))
    assert found.length == pytest.approx(4.0)
    assert found.touching.tolist() == (found.lengths > 0).tolist()


def test_means_of_a_field():
    a, b, _ = slices().parts
    assert a.boundary.mean("x") == pytest.approx(2.0)
    assert b.boundary.mean("x") == pytest.approx(3.5)
    assert b.boundary_with(a).mean("x") == pytest.approx(2.0)
    found = slices().boundaries
    assert found.mean("x") == pytest.approx(3.5)
    means = found.means("x")
    assert [means[0, 1], means[2, 1]] == pytest.approx([2.0, 5.0])
    assert np.isnan(means[0, 2])
    assert np.isnan(means[0, 0])


def test_the_girth_of_a_tube():
    shape = Shape.from_mesh(*shapes.tube(12, radius=1.5, length=4.0, rings=4))
    middle = (shape.points[:, 2].min() + shape.points[:, 2].max()) / 2
    part = Segmentation.from_labels(shape, (shape.points[:, 2] > middle).astype(int), 2).parts[0]
    assert part.boundary.length == pytest.approx(2 * 1.5 * 12 * np.sin(np.pi / 12))


def test_the_cut_through_a_solid_has_an_area():
    shape = Shape.from_voxels(np.ones((4, 3, 2), bool), pitch=0.5)
    labels = (shape.points[:, 0] > 1.0).astype(int)
    found = Segmentation.from_labels(shape, labels, 2)
    assert found.parts[0].boundary.length == pytest.approx(3 * 2 * 0.25)


def test_a_boundary_says_the_same_on_a_coarse_shape():
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(12, 10), 1))
    coarse = coarsen(shape, 40)
    labels = np.digitize(coarse.points[:, 0], np.quantile(coarse.points[:, 0], [0.3, 0.6]))
    rough = Segmentation.from_labels(coarse, labels, 3, lookup=Heights())
    exact = Segmentation.from_labels(shape, labels[coarse.members], 3, lookup=Heights())
    assert rough.boundaries.lengths == pytest.approx(exact.boundaries.lengths)
    assert exact.boundaries.around == pytest.approx(exact.boundaries.lengths.sum(axis=1))
    for one, other in zip(rough.parts, exact.parts, strict=True):
        assert one.boundary.mean("height") == pytest.approx(other.boundary.mean("height"))


def test_the_boundary_of_a_part_is_the_same_to_the_last_bit_however_the_rest_is_divided():
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(12, 10), 1))
    rng = np.random.default_rng(2)
    labels = rng.integers(0, 4, shape.n_elements)
    others = np.where(labels == 0, 5, rng.integers(0, 5, shape.n_elements))
    one = Segmentation.from_labels(shape, labels, 6, lookup=Heights()).parts[0].boundary
    other = Segmentation.from_labels(shape, others, 6, lookup=Heights()).parts[5].boundary
    assert one.length == other.length
    assert one.mean("height") == other.mean("height")


def test_what_all_boundaries_say_of_a_part_is_what_its_own_says_to_the_last_bit():
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(12, 10), 1))
    labels = np.random.default_rng(2).integers(0, 4, shape.n_elements)
    found = Segmentation.from_labels(shape, labels, 4, lookup=Heights())
    own = [part.boundary for part in found.parts]
    assert found.boundaries.around.tolist() == [each.length for each in own]
    means = found.boundaries.means_around("height", factor=2.0)
    assert means.tolist() == [each.mean("height", factor=2.0) for each in own]
    assert found.areas.tolist() == [part.area for part in found.parts]


def test_a_boundary_of_no_length_has_no_mean():
    shape = Shape.from_mesh(*shapes.cube())
    found = Segmentation.from_labels(shape, [0] * 6, 1, lookup=Heights())
    assert found.parts[0].boundary.length == 0.0
    assert repr(found.parts[0].boundary) == "Boundary(length 0)"
    for boundary in (found.parts[0].boundary, found.boundaries):
        with pytest.raises(MosegError, match="no length"):
            boundary.mean("height")
    assert repr(found.boundaries) == "Boundaries(1 parts, length 0)"
    assert np.isnan(found.boundaries.means_around("height")).all()


def test_without_neighbours_there_are_no_boundaries():
    cloud = Shape.from_points(np.eye(3), name="dots")
    part = Segmentation.from_labels(cloud, [0, 1, 1], 2).parts[0]
    with pytest.raises(ShapeError, match="'dots' has no boundaries"):
        _ = part.boundary
    linked = cloud.with_adjacency("knn")
    assert Segmentation.from_labels(linked, [0, 1, 1], 2).parts[0].boundary.length > 0
