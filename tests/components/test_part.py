"""Parts: measured against closed forms, against a slow loop, and against themselves moved."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_core.components.discovery.lookup import FoundMeasure
from moseg_core.components.memo import Memo
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import UsageError
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.references import connected_pieces, edge_neighbors, triangle_moments


def parts_of(mesh, labels=None, **more):
    shape = Shape.from_mesh(*mesh)
    labels = np.zeros(shape.n_elements, int) if labels is None else np.asarray(labels)
    return Segmentation.from_labels(shape, labels, int(labels.max()) + 1, **more).parts


def whole(mesh):
    return parts_of(mesh)[0]


# --- closed forms --------------------------------------------------------------------------------


@pytest.mark.parametrize(("nx", "ny"), [(1, 1), (7, 3)])
def test_a_rectangle(nx, ny):
    part = whole(shapes.rectangle(3.0, 2.0, nx, ny))
    assert part.area == pytest.approx(6.0, rel=1e-14)
    assert part.centroid == pytest.approx([1.5, 1.0, 0.0], rel=1e-14)
    assert part.scales == pytest.approx([3 / 12**0.5, 2 / 12**0.5, 0.0], rel=1e-14)
    assert np.abs(part.axes) == pytest.approx(np.eye(3), abs=1e-14)
    assert part.box_diagonal == pytest.approx(13**0.5, rel=1e-14)


@pytest.mark.parametrize("sides", [(1, 1, 1), (3, 2, 1), (1, 5, 2)])
def test_the_surface_of_a_box(sides):
    part = whole(shapes.box(*sides))
    area = 2 * sum(p * q for p, q in itertools.combinations(sides, 2))
    variances = []
    for k in range(3):
        a = sides[k]
        ends = 2 * np.prod(sides) / a  # the two faces across the axis, at -a/2 and a/2
        variances.append((ends * a**2 / 4 + (area - ends) * a**2 / 12) / area)
    assert part.area == pytest.approx(area, rel=1e-13)
    assert part.centroid == pytest.approx(np.array(sides) / 2, rel=1e-13)
    assert part.scales**2 == pytest.approx(sorted(variances, reverse=True), rel=1e-13)
    if sides == (1, 1, 1):
        assert part.scales**2 == pytest.approx([5 / 36] * 3, rel=1e-13)
    else:
        order = np.argsort(variances)[::-1]
        assert np.abs(part.axes) == pytest.approx(np.eye(3)[order], abs=1e-12)
        assert part.box_diagonal == pytest.approx(np.linalg.norm(sides), rel=1e-13)


@pytest.mark.parametrize("thickness", [1e-2, 1e-4, 1e-6])
def test_a_thin_plate_is_not_taken_for_flat(thickness):
    vertices, faces = shapes.box(3, 2, 1)
    part = whole((vertices * [1.0, 1.0, thickness], faces))
    # The two large faces lie thickness / 2 from the middle, the rim is next to nothing.
    rim = 10 * thickness / (12 + 10 * thickness)
    expected = thickness**2 * ((1 - rim) / 4 + rim / 12)
    assert part.scales[2] ** 2 == pytest.approx(expected, rel=1e-2)


def test_a_sphere():
    errors = []
    for subdivisions in (1, 2, 3):
        part = whole(shapes.sphere(subdivisions, radius=2.0))
        assert part.centroid == pytest.approx([0, 0, 0], abs=1e-12)
        assert part.scales == pytest.approx([part.scales[0]] * 3, rel=1e-12)
        errors.append(1 - part.scales[0] ** 2 / (4 / 3))
        assert part.area < 16 * np.pi
    # The inscribed polyhedra tend to r^2 / 3 in every direction, four times nearer each time.
    assert 0 < errors[2] < 0.02
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.05)


@pytest.mark.parametrize("n", [3, 5, 24])
@pytest.mark.parametrize("length", [0.5, 6.0])
def test_the_side_of_a_cylinder(n, length):
    part = whole(shapes.tube(n, 1.5, length, rings=3))
    side, apothem = 3.0 * np.sin(np.pi / n), 1.5 * np.cos(np.pi / n)
    across = (apothem**2 + side**2 / 12) / 2  # tends to r^2 / 2
    along = length**2 / 12
    assert part.area == pytest.approx(n * side * length, rel=1e-13)
    assert part.centroid == pytest.approx([0, 0, length / 2], abs=1e-13)
    assert part.scales**2 == pytest.approx(sorted([along, across, across])[::-1], rel=1e-12)
    axis = part.axes[0 if along > across else 2]
    assert np.abs(axis) == pytest.approx([0, 0, 1], abs=1e-12)


def test_a_triangle():
    # Second moments of the corners about the centroid, divided by 12.
    corners = np.array([[0.0, 0, 0], [4, 0, 0], [1, 3, 0]])
    part = whole((corners, [(0, 1, 2)]))
    spread = corners - corners.mean(axis=0)
    values = np.linalg.eigvalsh(spread.T @ spread / 12)[::-1]
    assert part.area == pytest.approx(6.0)
    assert part.scales == pytest.approx(np.sqrt(np.abs(values)), abs=1e-8)


# --- a slow loop ---------------------------------------------------------------------------------


@given(st.integers(0, 2**32), st.integers(1, 4))
@settings(max_examples=25, deadline=None)
def test_any_part_of_a_mixed_mesh_measures_as_its_triangles_do(seed, n):
    vertices, faces = shapes.jitter(shapes.bent_capsule(7, 6), seed)
    vertices = vertices + np.array([2.0, -1.0, 5.0])
    shape = Shape.from_mesh(vertices, faces)
    labels = np.random.default_rng(seed).integers(0, n, len(faces))
    labels[:n] = range(n)
    for k, part in enumerate(Segmentation.from_labels(shape, labels, n).parts):
        own = shape.geometry.triangles[labels[shape.geometry.triangle_polygon] == k]
        area, mean, covariance = triangle_moments(vertices[own].tolist())
        assert part.area == pytest.approx(area, rel=1e-12)
        assert part.centroid == pytest.approx(mean, rel=1e-12)
        rebuilt = part.axes.T @ np.diag(part.scales**2) @ part.axes
        assert rebuilt == pytest.approx(np.array(covariance), abs=1e-12)
        assert part.axes @ part.axes.T == pytest.approx(np.eye(3), abs=1e-12)
        assert (np.diff(part.scales) <= 0).all()


# --- tessellation --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "mesh",
    [shapes.box(3, 2, 1), shapes.prism(7), shapes.fan(shapes.bent_capsule(6, 5))],
    ids=["box", "prism", "capsule"],
)
def test_measures_do_not_depend_on_the_tessellation(mesh):
    mesh = shapes.moved(mesh, shapes.rotation(2), 1.7, [3.0, -4.0, 5.0])
    one = whole(mesh)
    finer = mesh
    for seed in range(3):
        finer = shapes.subdivided(finer, seed)
        other = whole(finer)
        assert other.n_elements >= 3 * one.n_elements
        assert other.area == pytest.approx(one.area, rel=1e-12)
        assert other.centroid == pytest.approx(one.centroid, rel=1e-12)
        assert other.scales == pytest.approx(one.scales, rel=1e-12)
        gaps = -np.diff(one.scales) / one.scales[0]
        for i in range(3):
            if min([*gaps[i : i + 1], *gaps[max(i - 1, 0) : i]], default=1) > 1e-3:
                assert abs(one.axes[i] @ other.axes[i]) == pytest.approx(1.0, abs=1e-12)


def test_a_part_of_polygons_is_the_same_as_of_their_triangles():
    vertices, faces = shapes.prism(9)
    labels = np.arange(len(faces)) % 2
    cut = np.repeat(labels, [len(face) - 2 for face in faces])
    for one, two in zip(
        parts_of((vertices, faces), labels),
        parts_of(shapes.fan((vertices, faces)), cut),
        strict=True,
    ):
        assert two.area == pytest.approx(one.area, rel=1e-13)
        assert two.scales == pytest.approx(one.scales, rel=1e-12)
        assert two.box_diagonal == pytest.approx(one.box_diagonal, rel=1e-12)


# --- motion --------------------------------------------------------------------------------------


@given(st.integers(0, 2**32), st.floats(0.01, 100), st.floats(-20, 20), st.booleans())
@settings(max_examples=40, deadline=None)
def test_measures_move_with_the_shape(seed, scale, shift, mirrored):
    mesh = shapes.jitter(shapes.bent_capsule(8, 6), seed, 0.03)
    labels = np.repeat([0, 1], [30, len(mesh[1]) - 30])
    turn = shapes.rotation(seed)
    if mirrored:
        turn = turn @ np.diag([1.0, -1.0, 1.0])
    away = np.array([shift, -shift, 1.0]) * scale
    there = shapes.moved(mesh, turn, scale, away)
    for one, two in zip(parts_of(mesh, labels), parts_of(there, labels), strict=True):
        assert two.area == pytest.approx(scale**2 * one.area, rel=1e-11)
        expected = scale * turn @ one.centroid + away
        assert two.centroid == pytest.approx(expected, abs=1e-11 * scale * (1 + abs(shift)))
        assert two.scales == pytest.approx(scale * one.scales, rel=1e-9)
        assert two.box_diagonal == pytest.approx(scale * one.box_diagonal, rel=1e-9)
        assert np.abs(two.axes @ turn @ one.axes.T) == pytest.approx(np.eye(3), abs=1e-8)


def test_flat_parts_far_from_the_origin_stay_flat():
    # The sides of a tilted box, in the coordinates of a map: vertices there are rounded by 1e-10.
    vertices, faces = shapes.subdivided(shapes.box(3, 2, 4), 3)
    vertices = vertices @ shapes.rotation(3).T
    corners = vertices[np.array(faces)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    _, side = np.unique(normals.round(6), axis=0, return_inverse=True)
    for shift in (0.0, 1e6):
        sides = parts_of((vertices + shift, faces), side.reshape(-1))
        assert len(sides) == 6
        assert max(part.scales[2] for part in sides) < 1e-7


# --- the surface itself --------------------------------------------------------------------------


@given(st.integers(0, 2**32))
@settings(max_examples=20, deadline=None)
def test_vertices_and_triangles_are_those_of_the_part(seed):
    vertices, faces = shapes.jitter(shapes.prism(6), seed)
    labels = np.random.default_rng(seed).integers(0, 2, len(faces))
    labels[0] = 1
    for k, part in enumerate(parts_of((vertices, faces), labels)):
        own = [face for face, label in zip(faces, labels, strict=True) if label == k]
        used = sorted({v for face in own for v in face})
        assert sorted(map(tuple, part.vertices)) == sorted(map(tuple, vertices[used]))
        assert len(part.triangles) == sum(len(face) - 2 for face in own)
        if len(used):
            assert np.array_equal(np.unique(part.triangles), np.arange(len(used)))
            area, *_ = triangle_moments(part.vertices[part.triangles].tolist())
            assert area == pytest.approx(part.area, rel=1e-12)


def test_a_part_as_a_mesh_of_its_own():
    vertices, faces = shapes.prism(6, 1.0, 2.0)
    side, ends = parts_of((vertices, faces), [0] * 6 + [1, 1])
    mesh = side.to_mesh()
    assert mesh.area == pytest.approx(side.area)
    assert len(mesh.faces) == 12
    assert len(mesh.vertices) == 12
    assert not mesh.is_watertight
    assert ends.to_mesh().body_count == 2
    closed = whole((vertices, faces)).to_mesh()
    assert closed.is_watertight
    assert closed.volume == pytest.approx(3 * 3**0.5)  # and so oriented outward


@given(st.integers(0, 2**32))
@settings(max_examples=30, deadline=None)
def test_pieces_are_counted_over_shared_edges(seed):
    vertices, faces = shapes.tee(3, 3)
    near = edge_neighbors(vertices, faces)
    labels = np.random.default_rng(seed).integers(0, 3, len(faces))
    labels[:3] = range(3)
    for k, part in enumerate(parts_of((vertices, faces), labels)):
        expected = connected_pieces(near, np.flatnonzero(labels == k).tolist())
        assert part.n_components == len(expected)


def test_pieces_of_nothing_and_of_what_has_no_neighbours():
    shape = Shape.from_mesh(*shapes.soup(1, 4))
    one, none = Segmentation.from_labels(shape, [0] * 4, 2).parts
    assert (one.n_components, none.n_components) == (4, 0)
    unknown = dataclasses.replace(shape, adjacency=None)
    assert Segmentation.from_labels(unknown, [0] * 4, 1).parts[0].n_components == 1


# --- measures ------------------------------------------------------------------------------------


class Measures:
    """A resolver over functions that count how often they are called."""

    def __init__(self):
        self.calls = []

    def measure(self, name):
        bare = name.partition(":")[2] or name

        def function(part, *, power=1.0):
            self.calls.append((bare, part.n_elements, power))
            return part.area**power

        return FoundMeasure(id=f"here:{bare}", function=function, keep=bare != "tree")


def test_a_measure_is_computed_once_whatever_it_is_called():
    measures = Measures()
    part, other = parts_of(shapes.cube(), [0, 0, 0, 0, 1, 1], lookup=measures)
    assert [part.measure("size"), part.measure("here:size"), part.measure("size")] == [4.0] * 3
    assert part.measure("size", power=2.0) == 16.0
    assert part.measure("size", power=2.0) == 16.0
    assert other.measure("size") == 2.0
    assert measures.calls == [("size", 4, 1.0), ("size", 4, 2.0), ("size", 2, 1.0)]


def test_what_is_to_be_kept_outlives_the_part_and_the_rest_does_not():
    shape = Shape.from_mesh(*shapes.cube())
    memo, measures = Memo(), Measures()

    def part_of(labels, k):
        found = Segmentation.from_labels(shape, labels, 3, memo=memo, lookup=measures)
        return found.parts[k]

    for labels, k in (([0, 0, 1, 1, 1, 1], 0), ([2, 2, 0, 1, 0, 1], 2)):
        part = part_of(labels, k)
        for name in ("size", "tree", "size", "tree"):
            assert part.measure(name) == 2.0
    # The same elements by another label: the size is known, the tree is made again.
    assert [name for name, *_ in measures.calls] == ["size", "tree", "tree"]


@pytest.mark.parametrize("change", [{"space": "mds"}, {"resolution": "preview"}])
def test_versions_of_a_shape_do_not_share_values(change):
    shape = Shape.from_mesh(*shapes.cube())
    memo, measures = Memo(), Measures()
    for version in (shape, dataclasses.replace(shape, **change), shape):
        found = Segmentation.from_labels(version, [0] * 6, 1, memo=memo, lookup=measures)
        found.parts[0].measure("size")
    assert len(measures.calls) == 2


def test_an_unknown_measure_is_a_usage_error():
    with pytest.raises(UsageError, match="unknown measure 'sise'"):
        whole(shapes.cube()).measure("sise")


@given(st.integers(0, 2**32), st.integers(2, 5))
@settings(max_examples=30, deadline=None)
def test_a_part_measures_the_same_to_the_last_bit_whatever_the_others_are(seed, n):
    shape = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(7, 6), 3))
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, n, shape.n_elements)
    labels[:3] = 0
    others = np.where(labels == 0, 7, rng.integers(0, 7, shape.n_elements))

    def bits(part):
        values = [part.area, *part.centroid, *part.scales, *part.axes.reshape(-1)]
        return [*values, part.box_diagonal, part.measure("size", power=0.3)], part.membership

    def parts(labels, memo):
        return Segmentation.from_labels(shape, labels, 8, memo=memo, lookup=Measures()).parts

    memo = Memo()
    first = bits(parts(labels, memo)[0])
    assert bits(parts(others, memo)[7]) == first
    assert memo.hits == 1
    assert bits(parts(others, Memo(size=0))[7]) == first


# --- labels --------------------------------------------------------------------------------------


def test_a_part_does_not_know_its_label():
    # Values are remembered by the set of elements: nothing that an objective can read may depend
    # on what the set is called, or on how the rest is divided.
    shape = Shape.from_mesh(*shapes.tee())
    half = np.arange(shape.n_elements) % 2
    first = Segmentation.from_labels(shape, half, 2).parts[1]
    other = Segmentation.from_labels(
        shape, np.where(half == 1, 0, 1 + np.arange(len(half)) // 9), 7
    )
    second = other.parts[0]
    names = {name for name in dir(first) if not name.startswith("_")}
    assert {"area", "elements", "measure", "triangles"} <= names
    for name in sorted(names - {"memo"}):
        one, two = getattr(first, name), getattr(second, name)
        if name == "lookup" or (callable(one) and name != "shape"):
            continue
        assert np.array_equal(one, two), name


def test_an_objective_cannot_read_a_label():
    part = whole(shapes.cube())
    for name in ("index", "label", "labels", "level_labels"):
        assert not hasattr(part, name)
