from __future__ import annotations

import math

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic.convexity import closed_volume, convex, hull_volume
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from moseg_core import Problem, Segmentation, Shape

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])
TURNS = [Rotation.identity(), GENERIC]


def ell(length=1.0):
    """A prism over three unit squares; the two L-shaped ends come first."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    vertices = np.concatenate([np.c_[outline, np.full(6, z)] for z in (0, length)])
    k = np.arange(6)
    sides = np.stack([k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6], axis=1)
    return vertices, [k[::-1].tolist(), (k + 6).tolist(), *sides.tolist()]


def reversed_faces(mesh):
    return mesh[0], [list(face)[::-1] for face in mesh[1]]


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("left_out", [(), (0,), (1,), (0, 1)])
def test_ell_is_a_seventh_short_of_its_hull(make, turn, left_out):
    """Whole, and open at its ends, where the fan over the outline overlaps itself."""
    vertices, faces = ell(2.5)
    faces = [face for k, face in enumerate(faces) if k not in left_out]
    for mesh in ((vertices, faces), reversed_faces((vertices, faces))):
        part = make.part(make.moved(mesh, turn=turn, shift=30.0))
        assert closed_volume(part) == pytest.approx(3 * 2.5, rel=1e-12)
        assert convex(part) == pytest.approx(0.5 / 3.5, rel=1e-11)


@pytest.mark.parametrize("turn", TURNS)
def test_open_cylinders(make, turn):
    vertices, faces = make.tube(1, 3, 40, caps=True)
    area = 40 / 2 * math.sin(2 * math.pi / 40)
    for kept in (faces, faces[:80], faces[:40]):
        part = make.part(make.moved((vertices, kept), turn=turn, shift=5.0))
        assert closed_volume(part) == pytest.approx(3 * area, rel=1e-12)
        assert convex(part) < 1e-12


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("low", [-0.8, 0.0, 0.9])
def test_caps_of_a_sphere(make, turn, low):
    heights = np.linspace(low, 1, 12)
    profile = np.stack([np.sqrt(np.maximum(0, 1 - heights**2)), heights], axis=1)
    mesh = trimesh.creation.revolve(profile, sections=30)
    part = make.part(make.moved((mesh.vertices, mesh.faces), turn=turn, shift=2.0))
    assert part.shape.volume is None
    assert convex(part) < 1e-11
    assert closed_volume(part) == pytest.approx(hull_volume(part), rel=1e-11)


@given(seed=st.integers(0, 2**32 - 1), cuts=st.integers(1, 6), stretch=st.floats(0.01, 1))
@settings(max_examples=30, deadline=None)
def test_convex_parts_cut_along_planes(make, seed, cuts, stretch):
    """Hulls of points on an ellipsoid, with up to six round lids taken off."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(60, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    turn = Rotation.random(rng=rng).as_matrix()
    normals = np.concatenate([turn, -turn])[:cuts]
    points = points[(points @ normals.T < 0.85).all(axis=1)]
    ring = np.exp(2j * np.pi * rng.random((cuts, 12)))[:, :, None] * math.sqrt(1 - 0.9**2)
    first, second = (np.tile(np.roll(turn, k, axis=0), (2, 1))[:cuts] for k in (1, 2))
    rings = ring.real * first[:, None] + ring.imag * second[:, None] + 0.9 * normals[:, None]
    hull = ConvexHull(np.concatenate([rings.reshape(-1, 3), points]))
    owner = np.concatenate([np.arange(cuts).repeat(12), -1 - np.arange(len(points))])
    lid = (np.ptp(owner[hull.simplices], axis=1) == 0) & (owner[hull.simplices[:, 0]] >= 0)
    assert lid.sum() == 10 * cuts
    # Qhull's triangles are not oriented alike.
    corners = hull.points[hull.simplices]
    inward = np.linalg.det(corners) < 0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    part = make.part((hull.points * [1.0, 0.8, stretch], faces[~lid]))
    assert part.shape.volume is None
    assert closed_volume(part) == pytest.approx(hull.volume * 0.8 * stretch, rel=1e-11)
    assert convex(part) < 1e-11


def test_plane_parts_are_convex(make):
    outline = ell()[0][:6], [[0, 1, 2, 3, 4, 5]]
    rng = np.random.default_rng(0)
    for far in (0.0, 1.0, 1e3, 1e5):
        for _ in range(5):
            turn, shift = Rotation.random(rng=rng), far * rng.normal(size=3)
            assert convex(make.part(make.moved(outline, turn=turn, shift=shift))) == 0


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("gap", [0.0, 0.5, 3.0])
def test_two_cubes_apart(make, turn, gap):
    cubes = [make.box(1, 1, 1), make.moved(make.box(1, 1, 1), shift=[1 + gap, 0, 0])]
    vertices = np.concatenate([cube[0] for cube in cubes])
    for left_out in ((), (0,), (1, 6), (0, 7)):
        faces = [[v + 8 * k for v in face] for k in (0, 1) for face in cubes[k][1]]
        faces = [face for k, face in enumerate(faces) if k not in left_out]
        part = make.part(make.moved((vertices, faces), turn=turn))
        assert closed_volume(part) == pytest.approx(2, rel=1e-12)
        assert convex(part) == pytest.approx(gap / (2 + gap), abs=1e-12)


def test_opposite_sides_of_a_box_enclose_nothing(make):
    vertices, faces = make.box(3, 2, 1)
    part = make.part(make.moved((vertices, faces[:2]), turn=GENERIC))
    assert convex(part) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("turn", TURNS)
def test_cavity_counts_as_missing(make, turn):
    outer, inner = make.box(3, 3, 3), make.box(1, 1, 2)
    faces = list(outer[1]) + [[v + 8 for v in face[::-1]] for face in inner[1]]
    mesh = np.concatenate([outer[0], inner[0]]), faces
    part = make.part(make.moved(mesh, turn=turn))
    assert convex(part) == pytest.approx(2 / 27, rel=1e-11)


@pytest.mark.parametrize("turn", TURNS)
def test_loops_that_touch_in_a_vertex_are_capped_apart(make, turn):
    """An octahedron without two faces, or four, that share corners and no edge."""
    corners = np.concatenate([np.eye(3), -np.eye(3)])
    solid = trimesh.convex.convex_hull(corners * [1.0, 1.2, 1.5])
    upper = solid.vertices[solid.faces].mean(axis=1) > 0
    for pattern in ([(1, 1, 1), (0, 0, 1)], [(1, 1, 1), (0, 0, 1), (0, 1, 0), (1, 0, 0)]):
        open_ = ~np.any([(upper == np.array(p, bool)).all(axis=1) for p in pattern], axis=0)
        assert open_.sum() == 8 - len(pattern)
        mesh = np.asarray(solid.vertices), np.asarray(solid.faces)[open_]
        part = make.part(make.moved(mesh, turn=turn))
        if len(pattern) == 2:
            assert convex(part) < 1e-12
        else:
            # Each two of the four touch; no vertex separates them, and one fan closes them all.
            assert 0 < convex(part) < 1


def test_loop_that_is_not_plane(make):
    """A cube without two neighbouring sides: the fan runs through the middle of the six edges."""
    vertices, faces = make.box(1, 1, 1)
    part = make.part((vertices, [faces[k] for k in (0, 2, 3, 4)]))
    loop = [face for k, face in enumerate(faces) if k not in (0, 2, 3, 4)]
    rim = {frozenset((f[k], f[k - 1])) for f in loop for k in range(4)}
    shared = set.intersection(*({frozenset((f[k], f[k - 1])) for k in range(4)} for f in loop))
    middles = [vertices[list(edge)].mean(axis=0) for edge in rim - shared]
    center = np.mean(middles, axis=0)
    # What lies between the fan and the two sides: pyramids over them with the fan's apex.
    normals = [
        np.cross(vertices[f[1]] - vertices[f[0]], vertices[f[2]] - vertices[f[1]]) for f in loop
    ]
    missing = sum(
        float((vertices[f[0]] - center) @ normal) / 3
        for f, normal in zip(loop, normals, strict=True)
    )
    assert missing > 0.1
    assert closed_volume(part) == pytest.approx(1 - missing, rel=1e-12)
    assert convex(part) == pytest.approx(missing, rel=1e-12)


def test_division_of_a_loops_edges_does_not_matter(make):
    """A cube without two neighbouring sides, one edge of the hole in five unequal pieces."""
    vertices, faces = make.box(1, 1, 1)
    kept = [list(faces[k]) for k in (0, 2, 3, 4)]
    whole = closed_volume(make.part((vertices, kept)))
    inner = {frozenset((f[k], f[k - 1])) for k in range(4) for f in kept[1:]}
    place = next(k for k in range(4) if frozenset((kept[0][k], kept[0][k - 1])) not in inner)
    start, stop = vertices[kept[0][place - 1]], vertices[kept[0][place]]
    cuts = np.array([0.05, 0.1, 0.2, 0.7])[:, None] * (stop - start) + start
    kept[0][place:place] = [8, 9, 10, 11]
    divided = closed_volume(make.part((np.concatenate([vertices, cuts]), kept)))
    assert divided == pytest.approx(whole, rel=1e-12)


def test_closed_parts_have_the_volume_of_the_shape(make):
    for mesh in (make.ball(2), make.box(3, 2, 1), ell()):
        part = make.part(make.moved(mesh, turn=GENERIC, shift=7.0))
        assert closed_volume(part) == pytest.approx(part.shape.volume, rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_two_parts_share_their_caps(make, seed):
    """However the boundary between them zigzags, their volumes add up to the whole."""
    vertices, faces = make.ball(2)
    vertices = Rotation.random(rng=seed).apply(vertices) * [2, 1, 0.7]
    labels = (vertices[faces].mean(axis=1)[:, 0] > 0.4).astype(int)
    parts = Segmentation.from_labels(Shape.from_mesh(vertices, faces), labels, 2).parts
    volume = parts[0].shape.volume
    assert sum(map(closed_volume, parts)) == pytest.approx(volume, rel=1e-12)
    # The dents of a coarse cap count, but not for much.
    assert 0 < convex(parts[0]) < 0.25


def test_repeated_vertices_are_one(make):
    """As in an STL file, where each triangle has corners of its own."""
    vertices, faces = make.ball(2)
    open_ = faces[vertices[faces].mean(axis=1)[:, 2] < 0.4]
    soup = vertices[open_].reshape(-1, 3), np.arange(3 * len(open_)).reshape(-1, 3)
    shared, apart = make.part((vertices, open_)), make.part(soup)
    assert closed_volume(apart) == pytest.approx(closed_volume(shared), rel=1e-12)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_invariances(data, make, seed):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    before = original.values("convex(a, b, c)")
    assert (before < 1).all()
    np.testing.assert_allclose(
        motion(original).values("convex(a, b, c)"), before, rtol=0, atol=1e-9
    )
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values("convex(a, b, c)"), before, rtol=0, atol=1e-11)


def test_open_shapes_are_not_refused(make):
    vertices, faces = make.tube(1, 3, 12, caps=False)
    shape = Shape.from_mesh(vertices, faces)
    found = Problem(["a"], "convex(a)").evaluate(shape, [0] * 12)
    assert found.cost.value < 1e-12


def test_a_ring_is_less_convex_than_its_quarters(make):
    mesh = trimesh.creation.torus(3, 1, major_sections=48, minor_sections=24)
    ring = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    angle = np.arctan2(*ring[0][ring[1]].mean(axis=1)[:, 1::-1].T)
    labels = np.digitize(angle, [-np.pi / 2, 0, np.pi / 2])
    quarters = Segmentation.from_labels(Shape.from_mesh(*ring), labels, 4).parts
    assert 0.01 < max(map(convex, quarters)) < 0.5 * convex(make.part(ring))


def test_nasty_parts_stay_in_range(nasty):
    for name, part in nasty.items():
        assert 0 <= convex(part) <= 1, name
        assert 0 <= closed_volume(part) < math.inf, name
    assert convex(nasty["one side of a box"]) == 0
    assert convex(nasty["one triangle"]) == 0
