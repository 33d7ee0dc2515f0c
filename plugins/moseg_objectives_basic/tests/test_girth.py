from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.girth import even_parts, even_thickness, thick, thin

from moseg_core import Segmentation, Shape, coarsen, field_values


@pytest.fixture(scope="module")
def lollipop():
    """A thick and a thin rod in line, as one closed surface each, and which faces are of which."""
    meshes = [trimesh.creation.box((4, 1, 1)), trimesh.creation.box((4, 0.25, 0.25))]
    meshes[1].apply_translation([4, 0, 0])
    fine = [trimesh.remesh.subdivide_to_size(m.vertices, m.faces, 0.15) for m in meshes]
    vertices = np.concatenate([v for v, _ in fine])
    faces = np.concatenate([fine[0][1], fine[1][1] + len(fine[0][0])])
    return Shape.from_mesh(vertices, faces), np.repeat([0, 1], [len(f) for _, f in fine])


def test_a_part_beside_the_whole(lollipop):
    shape, labels = lollipop
    values = field_values(shape, "basic:thickness")
    whole = np.average(values, weights=shape.areas)
    for k, part in enumerate(Segmentation.from_labels(shape, labels, 2).parts):
        own = labels == k
        mean = np.average(values[own], weights=shape.areas[own])
        spread = np.sqrt(np.average((values[own] - mean) ** 2, weights=shape.areas[own]))
        assert thin(part) == pytest.approx(mean / (mean + whole))
        assert thick(part) == pytest.approx(1 - thin(part))
        assert even_thickness(part) == pytest.approx(spread / (spread + mean))
    both = Segmentation.from_labels(shape, 0 * labels, 1).parts[0]
    assert thin(both) == pytest.approx(0.5)


def test_thin_and_thick_parts(lollipop):
    shape, labels = lollipop
    thick_part, thin_part = Segmentation.from_labels(shape, labels, 2).parts
    # Four times as thick, along all but the ends.
    ratio = thin(thick_part) / thick(thick_part) / (thin(thin_part) / thick(thin_part))
    assert ratio == pytest.approx(4, rel=0.2)
    assert even_thickness(thin_part) < even_thickness(
        Segmentation.from_labels(shape, 0 * labels, 1).parts[0]
    )


def test_even_parts_of_two_balls(make):
    """Balls of radius 1 and 2: each as thick everywhere, and apart by a factor of two."""
    far = make.moved(make.ball(3), scale=2.0, shift=[9, 0, 0])
    found = make.segmented([make.ball(3), far])
    assert even_parts(found) == pytest.approx(0, abs=1e-3)
    together = Segmentation.from_labels(found.shape, 0 * found.labels, 1)
    # A fifth of the area is thinner by the factor of two than the rest.
    assert even_parts(together) == pytest.approx(0.2 * 0.8 * np.log(2) ** 2, rel=0.01)


def test_even_parts_by_the_book(lollipop):
    shape, labels = lollipop
    logarithms = np.log(field_values(shape, "basic:thickness"))
    for given in (labels, (shape.points[:, 0] > 1).astype(int), 0 * labels):
        expected = 0.0
        for k in range(given.max() + 1):
            own = given == k
            mean = np.average(logarithms[own], weights=shape.areas[own])
            expected += (shape.areas[own] * (logarithms[own] - mean) ** 2).sum() / shape.area
        found = Segmentation.from_labels(shape, given, int(given.max()) + 1)
        assert even_parts(found) == pytest.approx(expected)


def test_the_same_on_a_coarse_shape(lollipop):
    shape, labels = lollipop
    coarse = coarsen(shape, 300)
    rough = np.array(
        [np.bincount(labels[coarse.members == k]).argmax() for k in range(coarse.n_elements)]
    )
    on_coarse = Segmentation.from_labels(coarse, rough, 2)
    on_fine = Segmentation.from_labels(shape, rough[coarse.members], 2)
    assert even_parts(on_coarse) == pytest.approx(even_parts(on_fine), rel=1e-9)
    for a, b in zip(on_coarse.parts, on_fine.parts, strict=True):
        for word in (thin, thick, even_thickness):
            assert word(a) == pytest.approx(word(b), rel=1e-9)


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        for word in (thin, thick, even_thickness):
            assert 0 <= word(part) <= 1, name


def test_even_parts_has_a_value_for_nasty_shapes(nasty):
    for name, part in nasty.items():
        shape = part.shape
        found = Segmentation.from_labels(shape, np.arange(shape.n_elements) % 2, 2)
        if all(p.n_elements for p in found.parts):
            assert 0 <= even_parts(found) < np.inf, name
