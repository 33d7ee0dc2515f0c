from __future__ import annotations

import dataclasses
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moseg_objectives_basic import convexity, hulls
from moseg_objectives_basic.convexity import convex_parts, hull_volume
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

import moseg_core as moseg
from moseg_core import MosegError, Problem, Segmentation, Shape, ShapeError

GENERIC = Rotation.from_rotvec([0.4, -1.1, 0.7])


def bricks(cells):
    """The outer faces of unit cubes that stand on the given integer corners, a quad each.

    Returns the mesh and for each face the number of its cube.
    """
    cells = [tuple(cell) for cell in cells]
    vertices, faces, owner = [], [], []
    for number, cell in enumerate(cells):
        for axis in range(3):
            for side in (0, 1):
                beyond = list(cell)
                beyond[axis] += 2 * side - 1
                if tuple(beyond) in cells:
                    continue
                u, v = (axis + 1) % 3, (axis + 2) % 3
                ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
                for p, q in ring if side else ring[::-1]:
                    corner = list(cell)
                    corner[axis] += side
                    corner[u] += p
                    corner[v] += q
                    vertices.append(corner)
                faces.append(list(range(len(vertices) - 4, len(vertices))))
                owner.append(number)
    return (np.array(vertices, float), faces), np.array(owner)


ELL = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


def value(mesh, labels):
    shape = Shape.from_mesh(*mesh)
    names = [f"p{k}" for k in range(max(labels) + 1)]
    return Problem(names, "convex_parts").evaluate(shape, labels).cost.value


@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
@pytest.mark.parametrize("shift", [0.0, 1e3])
def test_convex_shapes_whole_or_cut_across(make, turn, shift):
    mesh, owner = bricks([(k, 0, 0) for k in range(5)])
    mesh = make.moved(mesh, turn=turn, shift=shift)
    assert value(mesh, np.zeros(len(owner), int)) < 1e-20
    for cut in range(1, 5):
        assert value(mesh, (owner >= cut).astype(int)) < 1e-20


@pytest.mark.parametrize("turn", [Rotation.identity(), GENERIC])
def test_l_shape(make, turn):
    mesh, owner = bricks(ELL)
    mesh = make.moved(mesh, turn=turn)
    # Its hull lacks only half of the missing quarter: 3.5 against 3.
    assert value(mesh, np.zeros(len(owner), int)) == pytest.approx((0.5 / 3) ** 2, rel=1e-12)
    # Either arm takes the corner: convex both, and the hulls fill the volume once.
    for arm in (1, 2):
        assert value(mesh, (owner == arm).astype(int)) < 1e-20
    # Two cubes that meet along an edge have a hull of 3.
    tips = (owner == 0).astype(int)
    inner = Segmentation.from_labels(Shape.from_mesh(*mesh), tips, 2).parts
    assert hull_volume(inner[0]) == pytest.approx(3, rel=1e-12)
    assert hull_volume(inner[1]) == pytest.approx(1, rel=1e-12)
    assert value(mesh, tips) == pytest.approx(((4 - 3) / 3) ** 2, rel=1e-12)


def test_hulls_that_overlap_count_twice(make):
    # Two opposite sides of a cube span all of it, and so do the other four.
    box = make.box(1, 1, 1)
    assert value(box, [0, 0, 1, 1, 1, 1]) == pytest.approx(1, rel=1e-12)


def test_flat_parts_leave_the_volume_unfilled(make):
    assert value(make.box(3, 2, 1), [0, 1, 2, 3, 4, 5]) == 1


def test_thin_shapes_are_measured_in_their_own_proportions(make):
    for thickness in (1e-3, 1e-6, 1e-7):  # what is thinner is joined when it is loaded
        plate = make.moved(make.box(1, 1, thickness), turn=GENERIC)
        # The corners themselves are rounded to 1e-16.
        assert value(plate, [0] * 6) < (1e-14 / thickness) ** 2


@pytest.mark.parametrize("seed", range(12))
def test_hulls_far_narrower_than_long(make, seed):
    rng = np.random.default_rng(seed)
    lattice = rng.integers(0, 4, size=(60, 3)).astype(float)
    turned = Rotation.random(rng=rng).apply(lattice * [1, 1e-8, 1e-11])
    expected = ConvexHull(lattice).volume * 1e-19
    found = hull_volume(make.part((turned, np.arange(60).reshape(-1, 3))))
    assert found == pytest.approx(expected, rel=1e-3)


def test_what_qhull_says_of_points_in_a_plane_is_no_error(make, monkeypatch):
    def refuse(points):
        # Points in the plane x + y + z = 0, whatever the part.
        return ConvexHull(np.array([[1, -1, 0], [0, 1, -1], [-1, 0, 1], [2, -1, -1], [0, 0, 0]]))

    part = make.part(make.box(1, 1, 1))
    monkeypatch.setattr(hulls, "ConvexHull", refuse)
    assert hull_volume(part) == 0


def test_other_failures_are_not_taken_for_a_volume(make, monkeypatch):
    def fail(points):
        raise QhullError("QH6271 qhull topology error\nand forty lines of advice")

    monkeypatch.setattr(hulls, "ConvexHull", fail)
    with pytest.raises(MosegError, match="convex hull of a part cannot be computed: QH6271") as e:
        hull_volume(make.part(make.box(1, 1, 1)))
    assert "\n" not in str(e.value)


def test_open_shape_is_refused_by_name(make):
    open_box = make.box(1, 1, 1)[0], make.box(1, 1, 1)[1][:5]
    with pytest.raises(ShapeError, match="convex_parts"):
        value(open_box, [0] * 5)
    with pytest.raises(ShapeError, match="convex_parts"):
        convex_parts(make.segmented([open_box]))


@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.sampled_from([6, 12, 60, 600]),
    stretch=st.tuples(st.floats(-4, 0), st.floats(-4, 0)),
    exponent=st.floats(-9, 9),
)
@settings(max_examples=80, deadline=None)
def test_hull_volume_of_random_points(make, seed, count, stretch, exponent):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 3))
    thin = np.array([1, 10.0 ** stretch[0], 10.0 ** stretch[1]])
    expected = ConvexHull(points).volume * thin.prod() * 10.0 ** (3 * exponent)
    turned = Rotation.random(rng=rng).apply(points * thin) * 10.0**exponent
    soup = turned, np.arange(count).reshape(-1, 3)
    # Turning rounds the points by 1e-16 of the length, that is 1e-12 of the least thickness.
    assert hull_volume(make.part(soup)) == pytest.approx(expected, rel=1e-9)


@given(seed=st.integers(0, 2**32 - 1), count=st.sampled_from([2, 3, 4]))
@settings(max_examples=20, deadline=None)
def test_hull_volume_by_its_definition(make, seed, count):
    """The facets are the triangles that have all other points on one side."""
    points = np.random.default_rng(seed).normal(size=(3 * count, 3))
    volume = 0.0
    for a, b, c in itertools.combinations(points, 3):
        normal = np.cross(b - a, c - a)
        heights = (points - a) @ normal
        if (heights < 1e-12).all() or (heights > -1e-12).all():
            volume += abs((points.mean(axis=0) - a) @ normal) / 6
    soup = points, np.arange(3 * count).reshape(-1, 3)
    assert hull_volume(make.part(soup)) == pytest.approx(volume, rel=1e-9)


@given(data=st.data())
@settings(max_examples=25, deadline=None)
def test_points_on_sides_and_edges_do_not_count(data, make):
    original = data.draw(make.shapes)
    before = [hull_volume(part) for part in original.segmentation().parts]
    twice = make.quartered(make.quartered(original))
    after = [hull_volume(part) for part in twice.segmentation().parts]
    np.testing.assert_allclose(after, before, rtol=1e-12)


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 200), far=st.sampled_from([0, 1, 1e3]))
@settings(max_examples=60, deadline=None)
def test_planar_parts_have_no_volume(make, seed, count, far):
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 12, size=(3 * count, 3)) * [1.0, 1.0, 0.0]
    points[:3] = [[0, 0, 0], [5, 0, 0], [0, 4, 0]]
    turned = Rotation.random(rng=rng).apply(points) + far * rng.normal(size=3)
    assert 0 <= hull_volume(make.part((turned, np.arange(3 * count).reshape(-1, 3)))) <= 1e-9
    if far == 0:
        part = make.part((points, np.arange(3 * count).reshape(-1, 3)))
        assert hull_volume(part) == 0


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(2, 300))
@settings(max_examples=60, deadline=None)
def test_lattice_points_rotated(make, seed, count):
    """Many points in common planes and on common lines, the rule on real meshes."""
    rng = np.random.default_rng(seed)
    lattice = rng.integers(0, 4, size=(3 * count, 3)).astype(float)
    lattice[:6] = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3], [3, 3, 0], [1, 2, 3]]
    # Turned points lie in a plane only up to rounding; the volume barely moves.
    turned = Rotation.random(rng=rng).apply(lattice)
    soup = np.arange(3 * count).reshape(-1, 3)
    exact = ConvexHull(lattice).volume
    assert hull_volume(make.part((lattice, soup))) == pytest.approx(exact, rel=1e-12)
    assert hull_volume(make.part((turned, soup))) == pytest.approx(exact, rel=1e-12)


@given(data=st.data(), seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_invariances(data, make, seed):
    original, motion = data.draw(make.shapes), data.draw(make.motions)
    before = original.values("convex_parts")
    np.testing.assert_allclose(motion(original).values("convex_parts"), before, rtol=1e-9)
    for again in (make.quartered(original), make.punctured(original, seed)):
        np.testing.assert_allclose(again.values("convex_parts"), before, rtol=1e-11)


def test_nasty_parts_have_finite_hulls(nasty):
    for name, part in nasty.items():
        assert 0 <= hull_volume(part) < math.inf, name
        if part.shape.volume is not None:
            rest = np.ones(part.shape.n_elements, int)
            rest[part.elements] = 0
            whole = Segmentation.from_labels(part.shape, rest, rest.max() + 1)
            assert 0 <= convex_parts(whole) < math.inf, name
    assert hull_volume(nasty["plate"]) == pytest.approx(1e-9, rel=1e-6)
    assert hull_volume(nasty["one side of a box"]) == 0


def test_loose_triangles_with_jitter_are_as_convex_as_those_that_share_vertices(make):
    vertices, faces = make.ball(2)
    points = np.asarray(vertices)[np.array(faces).reshape(-1)]
    loose = points + np.random.default_rng(0).uniform(-1e-10, 1e-10, points.shape)
    shape = Shape.from_mesh(loose, np.arange(len(loose)).reshape(-1, 3))
    upper = (shape.points[:, 2] > 0).astype(int)
    problem = Problem(["a", "b"], "convex(a)")
    expected = problem.evaluate(Shape.from_mesh(vertices, faces), upper).cost.value
    assert problem.evaluate(shape, upper).cost.value == pytest.approx(expected, abs=1e-8)
    assert problem.evaluate(shape, 0 * upper).cost.value == pytest.approx(0.0, abs=1e-8)


def test_a_ball_with_a_cap_from_both_sides_is_convex(make):
    vertices, faces = make.ball(3)
    cap = faces[vertices[faces, 2].mean(axis=1) > 0.5]
    shape = Shape.from_mesh(vertices, np.concatenate([faces, cap[:, ::-1]]))
    found = Problem(["a"], "convex(a)").evaluate(shape, [0] * shape.n_elements)
    assert found.cost.value == pytest.approx(0.0, abs=1e-9)


def test_a_search_leaves_out_hulls_and_finds_the_same(monkeypatch):
    shape, fast = moseg.load(moseg.sample_path("hammer")), convexity.fast_hull_volume
    problem = Problem(["a", "b", "c"], "convex_parts + 3*narrow(a) + narrow(b) + compact(c)")
    found, asked = [], []
    for at_least in convex_parts.traits.at_least, None:
        calls = []

        def counted(points, calls=calls):
            calls.append(len(points))
            return fast(points)

        traits = dataclasses.replace(convex_parts.traits, at_least=at_least)
        monkeypatch.setattr(convex_parts, "traits", traits)
        monkeypatch.setattr(convexity, "fast_hull_volume", counted)
        found.append(moseg.segment(shape, problem, resolution=500, restarts=1, seed=1))
        asked.append(len(calls))
    assert found[0].labels.tolist() == found[1].labels.tolist()
    assert found[0].history == found[1].history
    assert found[0].evaluation.cost == found[1].evaluation.cost
    assert 0 < asked[0] < 0.7 * asked[1]
