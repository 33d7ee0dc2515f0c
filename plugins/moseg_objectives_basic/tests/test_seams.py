from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.seams import (
    creased_boundaries,
    creased_boundary,
    separate,
    separate_parts,
    short_boundaries,
    short_boundary,
)

from moseg_core import Problem, Segmentation, Shape, coarsen, field_values


def segmented(shape, labels):
    return Segmentation.from_labels(shape, labels, int(max(labels)) + 1)


def test_a_disc_in_a_plane(make):
    shape = Shape.from_mesh(*make.disc(8, 64))
    labels = (np.linalg.norm(shape.points, axis=1) > 0.5).astype(int)
    found = segmented(shape, labels)
    assert short_boundary(found.parts[0]) == pytest.approx(0.5, rel=1e-3)
    assert short_boundary(found.parts[1]) == pytest.approx(1 / (1 + math.sqrt(3)), rel=1e-3)
    assert short_boundaries(found) == pytest.approx(math.pi / math.sqrt(8), rel=1e-2)
    # In a plane nothing is creased, and a boundary counts as long as it is.
    for part in found.parts:
        assert separate(part) == pytest.approx(short_boundary(part))
    assert separate_parts(found) == pytest.approx((0.5 + 1 / (1 + math.sqrt(3))) / 2, rel=1e-3)


def test_a_part_without_boundary(make):
    found = segmented(Shape.from_mesh(*make.ball(2)), [0] * 320)
    assert short_boundary(found.parts[0]) == short_boundaries(found) == 0
    assert creased_boundary(found.parts[0]) == creased_boundaries(found) == 0
    assert separate(found.parts[0]) == separate_parts(found) == 0


@pytest.mark.parametrize("n", [6, 12])
def test_of_a_solid_cuts_have_areas(n):
    """Half a cube: a cut of 1 and a volume of 1/2."""
    cube = Shape.from_voxels(np.ones((n, n, n), bool), pitch=1 / n)
    found = segmented(cube, (cube.points[:, 0] > cube.points[:, 0].mean()).astype(int))
    ball = math.cbrt(36 * math.pi / 4)
    assert short_boundary(found.parts[0]) == pytest.approx(1 / (1 + ball))
    assert short_boundaries(found) == pytest.approx(1 / cube.box_diagonal**2)


@pytest.fixture(scope="module")
def dumbbell():
    """Two overlapping balls: as one surface, which meets in a sharp crease."""
    mesh = trimesh.creation.icosphere(subdivisions=4)
    left = np.array(mesh.vertices)
    kept = mesh.faces[(left[mesh.faces][:, :, 0] < 0.5).any(axis=1)]
    left[:, 0] = np.minimum(left[:, 0], 0.5)
    right = left * [-1, 1, 1] + [1, 0, 0]
    faces = np.concatenate([kept, kept[:, ::-1] + len(left)])
    return Shape.from_mesh(np.concatenate([left, right]), faces)


def test_a_boundary_in_a_crease_is_cheaper_than_beside_it(dumbbell):
    in_crease, beside = (
        segmented(dumbbell, (dumbbell.points[:, 0] > x).astype(int)) for x in (0.5, 0.9)
    )
    assert creased_boundary(in_crease.parts[0]) < 0.25
    assert creased_boundary(beside.parts[0]) > 0.63
    assert creased_boundaries(in_crease) == pytest.approx(creased_boundary(in_crease.parts[1]))


def test_a_part_that_ends_in_a_crease_is_more_separate(dumbbell):
    in_crease, beside = (
        segmented(dumbbell, (dumbbell.points[:, 0] > x).astype(int)) for x in (0.5, 0.9)
    )
    # Shorter by a little, and worth 0.15 to 0.5 of its length where a plane one is worth all of it.
    for k, part in enumerate(in_crease.parts):
        assert separate(part) < separate(beside.parts[k])
        long, short = short_boundary(part), separate(part)
        assert 0.15 < (short / (1 - short)) / (long / (1 - long)) < 0.5
    assert separate_parts(in_crease) < separate_parts(beside)


def test_separate_by_the_book_on_every_level(dumbbell):
    coarse = coarsen(dumbbell, 200)
    rough = (coarse.points[:, 0] > 0.6).astype(int)
    labels = rough[coarse.members]
    concave, links = field_values(dumbbell, "basic:concavity"), dumbbell.links
    factor = np.clip(1.0 - concave, 0.15, 1.5)
    length = sum(
        (factor[i] + factor[j]) / 2 * weight
        for i, j, weight in zip(links.first, links.second, links.lengths, strict=True)
        if labels[i] != labels[j]
    )
    areas = [dumbbell.areas[labels == k].sum() for k in (0, 1)]
    expected = [length / (length + math.sqrt(4 * math.pi * area)) for area in areas]
    for found in (segmented(coarse, rough), segmented(dumbbell, labels)):
        assert [separate(part) for part in found.parts] == pytest.approx(expected)
        assert separate_parts(found) == pytest.approx(np.mean(expected))


def test_every_part_counts_alike_however_large(make):
    shape = Shape.from_mesh(*make.disc(8, 64))
    radius = np.linalg.norm(shape.points, axis=1)
    found = segmented(shape, np.digitize(radius, [0.25, 0.75]))
    assert separate_parts(found) == pytest.approx(np.mean([separate(p) for p in found.parts]))
    both = Problem(["a", "b", "c"], "separate_parts + separate(*)")
    mean, each = both.evaluate(shape, np.digitize(radius, [0.25, 0.75])).terms
    assert each.value == pytest.approx(3 * mean.value)


def test_the_mean_along_the_boundary_on_every_level(dumbbell):
    coarse = coarsen(dumbbell, 200)
    rough = (coarse.points[:, 0] > 0.6).astype(int)
    labels = rough[coarse.members]
    values, links = field_values(dumbbell, "basic:uncreased"), dumbbell.links
    crossing = labels[links.first] != labels[links.second]
    between = (values[links.first] + values[links.second])[crossing] / 2
    expected = np.average(between, weights=links.lengths[crossing])
    for found in (segmented(coarse, rough), segmented(dumbbell, labels)):
        assert creased_boundary(found.parts[0]) == pytest.approx(expected)
        assert creased_boundaries(found) == pytest.approx(expected)
        length = links.lengths[crossing].sum()
        assert found.parts[0].boundary.length == pytest.approx(length)
        assert short_boundaries(found) == pytest.approx(length / dumbbell.box_diagonal)


def test_all_boundaries_together(make):
    vertices = [[x, y, 0] for x in range(5) for y in (0, 3)]
    faces = [[2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1] for k in range(4)]
    strip = Shape.from_mesh(vertices, faces)
    found = Problem(["a", "b", "c"], "short_boundaries").evaluate(strip, [0, 1, 1, 2])
    assert found.cost.value == pytest.approx(6 / 5)


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        assert 0 <= short_boundary(part) < 1, name
        assert 0 <= creased_boundary(part) <= 1, name
        assert 0 <= separate(part) < 1, name
