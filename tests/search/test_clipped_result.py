"""Results with clipped boundaries: where these are, what stays as it is, what is refused."""

from __future__ import annotations

import sys
import types
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import ParameterizationSpec
from moseg_core.components.protocols import Centers
from moseg_core.errors import ShapeError, UsageError
from moseg_core.io.files import save
from moseg_core.io.read.ply import read_ply
from moseg_core.problem.problem import Problem
from moseg_core.search.clipped_result import check_parameterization, clip
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.clipping.checks import assert_valid, polygon_areas
from tests.made_up import STRIP, area, stranger
from tests.results import result_on

METHOD = {"parameterization": "core:voronoi"}


def strip_in_two(shape=STRIP, **more):
    """The first three squares and the other five.

    The centres are in the outermost ones, with weights of 1 and 2; they meet in the third square.
    """
    labels = (np.arange(8) >= 3).astype(np.int32)
    return result_on(shape, **{"labels": labels, "method": METHOD, **more})


def shares(points, centers):
    """(P, 2): how far points are from the two centres, over their weights."""
    apart = np.linalg.norm(points[:, None] - centers.positions, axis=2)
    return apart / centers.weights


def test_clipped_labels_are_those_of_the_bisector():
    found = strip_in_two()
    clipped = clip(found).clipped
    corners = np.split(clipped.mesh.corners, clipped.mesh.offsets[1:-1])
    middles = np.array([clipped.mesh.vertices[face].mean(axis=0) for face in corners])
    assert (clipped.labels == shares(middles, found.centers).argmin(axis=1)).all()
    fresh = shares(clipped.mesh.vertices[len(STRIP.geometry.vertices) :], found.centers)
    assert len(fresh) >= 2
    np.testing.assert_allclose(fresh[:, 0], fresh[:, 1], rtol=1e-9)
    # Only the third square is cut, and most of it stays with the first part.
    assert [(clipped.source == k).sum() > 1 for k in range(8)] == [k == 2 for k in range(8)]
    first = np.bincount(clipped.labels, polygon_areas(clipped.mesh))[0]
    assert first == pytest.approx(0.5 + 7 / 3, abs=0.03)
    assert_valid(STRIP.geometry, found.labels, clipped)


def test_a_clipped_result_is_the_same_result(tmp_path):
    found = strip_in_two()
    smooth = clip(found)
    assert found.clipped is None
    assert found.surface == (found.shape.geometry, found.labels)
    assert smooth.labels is found.labels
    assert (smooth.cost, smooth.centers) == (found.cost, found.centers)
    mesh, labels = smooth.surface
    assert mesh is smooth.clipped.mesh
    assert labels is smooth.clipped.labels
    save(smooth, tmp_path / "smooth.ply")
    geometry = read_ply(tmp_path / "smooth.ply").geometry
    assert geometry.n_polygons > STRIP.n_elements
    assert (geometry.vertices == mesh.vertices).all()


def test_in_another_space_that_space_is_asked(monkeypatch):
    found = strip_in_two()
    twice = STRIP.deformed(2 * STRIP.geometry.vertices, space="twice")
    moved = replace(found, centers=replace(found.centers, positions=2 * found.centers.positions))
    here = clip(found).clipped
    there = clip(moved, space=twice).clipped
    monkeypatch.setattr(type(found), "partitioned", property(lambda result: twice))
    embedded = clip(moved).clipped
    for other in (there, embedded):
        assert (other.labels == here.labels).all()
        np.testing.assert_allclose(other.mesh.vertices, here.mesh.vertices, atol=1e-9)


def test_a_space_of_other_faces_is_refused():
    square = Shape.from_mesh(*shapes.rectangle())
    with pytest.raises(ShapeError, match="for each of 8 polygons"):
        clip(strip_in_two(), space=square)


def test_several_levels_are_refused():
    found = strip_in_two()
    with pytest.raises(UsageError, match=r"results of one level only.*result\.levels\[''\]"):
        clip(replace(found, levels={"": found}))


def test_a_cloud_is_refused():
    cloud = Shape.from_points(STRIP.points, name="cloud")
    with pytest.raises(ShapeError, match=r"'cloud' is a .*; boundaries can be clipped on a mesh"):
        clip(strip_in_two(cloud))


# --- other parameterizations ---------------------------------------------------------------------


class Blocks(Voronoi):
    """Knows how far points are from its parts, by the greatest coordinate; no weights."""

    weighted_bisectors = False

    def distances(self, vector, points):
        apart = np.abs(points[:, None] - self.decode(vector).positions)
        return apart.max(axis=2)


class Secret:
    """Has weighted bisectors, and cannot be made: nobody needs to."""

    weighted_bisectors = True

    def __init__(self, shape, n_parts):
        raise RuntimeError("nobody needs to")


class Plain:
    """Knows nothing of where its parts meet."""

    def __init__(self, shape, n_parts):
        pass


@pytest.fixture
def by(monkeypatch):
    """The strip in two, found with one of these parameterizations."""
    module = types.ModuleType("strange_module")
    monkeypatch.setitem(sys.modules, "strange_module", module)
    kinds = {"blocks": Blocks, "secret": Secret, "plain": Plain}
    for name, kind in kinds.items():
        setattr(module, name, kind)
    components = tuple(
        Component(
            "strange",
            "moseg-strange 2.0",
            ParameterizationSpec(name=name, target=f"strange_module:{name}"),
        )
        for name in kinds
    )
    bundle = Bundle("strange", "moseg-strange", "2.0", "strange_module", components)
    known = Registry([*registry().bundles, bundle])

    def made(name):
        problem = Problem(
            ["first", "second"], "2*area(first)", objectives={"area": area}, registry=known
        )
        return strip_in_two(problem=problem, method={"parameterization": f"strange:{name}"})

    return made


def cut(clipped):
    """Where the new vertices of a clipped strip are along it."""
    return clipped.mesh.vertices[len(STRIP.geometry.vertices) :, 0]


def test_one_that_knows_distances_is_clipped_where_they_are_equal(by):
    centers = Centers(
        positions=np.array([[0.5, 0.5, 0], [4.9, 0.5, 0]]), weights=np.array([1, 3.0])
    )
    fresh = cut(clip(replace(by("blocks"), centers=centers)).clipped)
    assert len(fresh) >= 2
    np.testing.assert_allclose(fresh, 2.7, atol=1e-6)


def test_one_with_weighted_bisectors_is_clipped_along_them_without_being_made(by):
    fresh = cut(clip(by("secret")).clipped)
    assert len(fresh) >= 2
    np.testing.assert_allclose(cut(clip(strip_in_two()).clipped), fresh)


def test_one_that_knows_neither_is_refused_by_name(by):
    with pytest.raises(
        UsageError, match=r"'strange:plain' of moseg-strange 2\.0 cannot be clipped"
    ):
        clip(by("plain"))
    for kind in (Blocks, Secret):
        check_parameterization(stranger("parameterization", kind))
    with pytest.raises(UsageError, match=r"parameterization 'strange:made' .* cannot be clipped"):
        check_parameterization(stranger("parameterization", Plain))


def test_where_a_part_has_several_centres_the_nearest_counts():
    centers = Centers(
        positions=np.array([[0.5, 0.5, 0], [4.9, 0.5, 0], [7.5, 0.5, 0]]),
        weights=np.array([1.0, 1.0, 3.0]),
        parts=np.array([0, 1, 1]),
    )
    method = {"parameterization": 'core:voronoi(centers="second=2")'}
    found = strip_in_two(centers=centers, method=method)
    clipped = clip(found).clipped
    fresh = clipped.mesh.vertices[len(STRIP.geometry.vertices) :]
    assert len(fresh) >= 2
    apart = np.linalg.norm(fresh[:, None] - centers.positions, axis=2) / centers.weights
    np.testing.assert_allclose(apart[:, 0], apart[:, 1:].min(axis=1), atol=1e-5)
    assert_valid(STRIP.geometry, found.labels, clipped)
