"""The objectives on point clouds and voxel grids: near their values on meshes, or refused."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from moseg_objectives_basic.ellipsoid import ellipsoidal
from moseg_objectives_basic.surface_distance import surface_samples
from moseg_objectives_basic.symmetry import planar_symmetric

from moseg_core import Problem, Segmentation, Shape, ShapeError, coarsen, registry

BALL = trimesh.creation.icosphere(subdivisions=4)


def whole(shape):
    return Segmentation.from_labels(shape, np.zeros(shape.n_elements, int), 1).parts[0]


def ellipsoid_of_cells(radii, n, elements="solid"):
    """Cells of side 1 / n whose middle is inside."""
    size = np.ceil(n * np.array(radii)).astype(int) + 1
    places = (np.indices(2 * size).transpose(1, 2, 3, 0) + 0.5 - size) / n
    inside = ((places / radii) ** 2).sum(axis=-1) < 1
    return Shape.from_voxels(inside, pitch=1 / n, origin=-size / n, elements=elements)


def sampled(mesh, n, seed=0):
    return Shape.from_points(trimesh.sample.sample_surface(mesh, n, seed=seed)[0])


def test_samples_of_a_cloud_are_its_points():
    part = whole(Shape.from_points(np.eye(3), areas=[1, 2, 3]))
    points, weights = surface_samples(part)
    np.testing.assert_array_equal(points, np.eye(3))
    assert weights.tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize("radii", [(1, 1, 1), (3, 1, 1), (3, 2, 1)])
def test_a_cloud_resembles_an_ellipsoid_as_its_mesh_does(radii):
    mesh = BALL.copy()
    mesh.apply_scale(radii)
    exact = ellipsoidal(whole(Shape.from_mesh(mesh)))
    found = ellipsoidal(whole(sampled(mesh, 20_000)))
    assert found == pytest.approx(exact, rel=0.25, abs=5e-5)


@pytest.mark.parametrize("radii", [(1, 1, 1), (3, 1, 1), (3, 2, 1)])
def test_a_solid_ellipsoid_is_one_whatever_its_proportions(radii):
    coarse, fine = (ellipsoidal(whole(ellipsoid_of_cells(radii, n))) for n in (6, 12))
    assert fine < 5e-4
    # The steps of the staircase halve, and the squares of what they are off.
    assert fine < coarse / 2.5


def test_a_solid_block_is_none():
    part = whole(Shape.from_voxels(np.ones((12, 12, 12), bool)))
    assert ellipsoidal(part) > 4 * ellipsoidal(whole(ellipsoid_of_cells((1, 1, 1), 6)))


def test_a_part_without_surface_is_still_measured():
    middle = np.zeros((5, 5, 5), int)
    middle[1:4, 1:4, 1:4] = 1
    block = Shape.from_voxels(np.ones((5, 5, 5), bool))
    inner = Segmentation.from_labels(block, middle.reshape(-1), 2).parts[1]
    assert len(inner.triangles) == 0
    assert 0 < ellipsoidal(inner) < 1


@pytest.mark.parametrize("kind", ["cloud", "solid", "surface"])
def test_coarse_parts_measure_like_fine_ones(kind):
    shape = (
        sampled(BALL, 6000) if kind == "cloud" else ellipsoid_of_cells((2, 1, 1), 10, elements=kind)
    )
    coarse = coarsen(shape, 600)
    labels = (coarse.points @ [1.0, 0.3, 0.1] > 0.2).astype(int)
    rough = Segmentation.from_labels(coarse, labels, 2).parts
    exact = Segmentation.from_labels(shape, labels[coarse.members], 2).parts
    for a, b in zip(rough, exact, strict=True):
        assert ellipsoidal(a) == pytest.approx(ellipsoidal(b), rel=0.05, abs=5e-5)
        if kind == "surface":
            assert planar_symmetric(a) == pytest.approx(planar_symmetric(b), rel=0.05, abs=5e-5)


OBJECTIVES = {
    component.spec.name: component.load().traits
    for component in registry().components("objective")
    if component.id.startswith("basic:")
}


@pytest.mark.parametrize("kind", ["cloud", "solid", "surface"])
@pytest.mark.parametrize("name", sorted(OBJECTIVES))
def test_every_objective_has_a_value_or_is_refused_by_name(name, kind):
    traits = OBJECTIVES[name]
    shape = sampled(BALL, 300).with_volume("hull")
    if kind != "cloud":
        shape = ellipsoid_of_cells((2, 1, 1), 4, elements=kind)
    labels = (shape.points @ [1.0, 0.3, 0.1] > 0.2).astype(int)
    takes = {"global": "", "unary": "(a)", "nary": "(a, b)"}
    problem = Problem(["a", "b"], name + takes[traits.arity])
    lacks = None
    if kind != "surface" and "surface" in traits.requires:
        lacks = "a surface, but"
    if kind == "cloud" and "adjacency" in traits.requires:
        lacks = "(a surface, but|to know which elements touch)"
    if lacks:
        with pytest.raises(ShapeError, match=f"'{name}' needs {lacks}"):
            problem.evaluate(shape, labels)
        return
    value = problem.evaluate(shape, labels).terms[0].value
    assert traits.range[0] <= value <= traits.range[1]
