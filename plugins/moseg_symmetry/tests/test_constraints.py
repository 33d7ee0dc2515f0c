from __future__ import annotations

import pickle

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from moseg_symmetry.constraints import Mirror, OnPlane

from moseg_core import Shape, ShapeError, UsageError, coarsen
from moseg_core.components.protocols import Constraint

N = 5
TILTED = "7,-1,2,1,2,-0.5"


@pytest.fixture(scope="module")
def shape():
    """Not at the origin, and not of diagonal 1."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    return Shape.from_mesh(ball.vertices * [3.0, 2.0, 1.0] + [7.0, 0.0, 1.0], ball.faces)


def rows():
    """Centres in unit coordinates; weights positive."""
    place = st.floats(-1.5, 1.5)
    row = st.tuples(place, place, place, st.floats(1e-3, 5.0))
    return st.lists(row, min_size=N, max_size=N).map(np.array)


@pytest.fixture(params=["x", "y", "z", TILTED], scope="module")
def plane(request):
    return request.param


@pytest.fixture(
    params=[(Mirror, (3, 1)), (Mirror, (0, 4)), (OnPlane, (2,)), (OnPlane, (4, 0, 3))],
    ids=lambda kind: f"{kind[0].__name__}{kind[1]}",
    scope="module",
)
def constraint(request, shape, plane):
    kind, labels = request.param
    return kind(shape, labels, plane=plane)


def test_answers_the_protocol(constraint):
    assert isinstance(constraint, Constraint)
    assert not set(constraint.determines) & set(constraint.reads)
    assert constraint.lower.shape == constraint.upper.shape
    assert (constraint.lower < constraint.upper).all()


def test_numbers_of_their_own(shape):
    mirror = Mirror(shape, [3, 1], plane="x")
    assert (mirror.determines, mirror.reads, len(mirror.lower)) == ((3,), (1,), 0)
    on_plane = OnPlane(shape, [4, 0], plane="x")
    assert (on_plane.determines, on_plane.reads) == ((4, 0), ())
    tiny = np.finfo(float).tiny
    assert on_plane.lower.tolist() == 2 * [-np.inf, -np.inf, tiny]
    assert on_plane.upper.tolist() == 6 * [np.inf]


@given(given_rows=rows(), data=st.data())
def test_expand_then_reduce_gives_the_numbers_back(constraint, given_rows, data):
    size = len(constraint.lower)
    free = np.array(data.draw(st.lists(st.floats(1e-3, 2.0), min_size=size, max_size=size)))
    before = given_rows.copy()
    expanded = constraint.expand(free, given_rows)
    again, feasible = constraint.reduce(expanded)
    np.testing.assert_allclose(again, free, atol=1e-14)
    np.testing.assert_allclose(feasible, expanded, atol=1e-14)
    assert (given_rows == before).all()  # nothing that was given is changed
    others = np.setdiff1d(np.arange(N), constraint.determines)
    assert (expanded[others] == given_rows[others]).all()


@given(given_rows=rows())
def test_reduce_is_a_projection(constraint, given_rows):
    before = given_rows.copy()
    free, feasible = constraint.reduce(given_rows)
    assert (given_rows == before).all()
    assert (free >= constraint.lower).all()
    np.testing.assert_allclose(constraint.expand(free, feasible), feasible, atol=1e-14)
    free_again, again = constraint.reduce(feasible)
    np.testing.assert_allclose(free_again, free, atol=1e-14)
    np.testing.assert_allclose(again, feasible, atol=1e-14)
    touched = {*constraint.determines, *constraint.reads}
    others = [label for label in range(N) if label not in touched]
    assert (feasible[others] == given_rows[others]).all()


@given(given_rows=rows(), other=rows())
def test_reduce_moves_least(constraint, given_rows, other):
    """No other feasible centres are nearer than those that reduce gives."""
    _, nearest = constraint.reduce(given_rows)
    _, feasible = constraint.reduce(other)
    for mixed in (feasible, nearest + 1e-3 * (feasible - nearest)):  # far and near
        moved = ((nearest - given_rows) ** 2).sum()
        assert moved <= ((mixed - given_rows) ** 2).sum() + 1e-12


def test_mirror_by_hand(shape):
    # The middle of the box is at x = 7 in the file, which is 0 in unit coordinates.
    centers = np.array([[0.3, 0.2, 0.1, 1.0], [-0.1, 0.0, 0.5, 3.0]])
    mirror = Mirror(shape, [1, 0], plane="7,0,0,1,0,0")
    expanded = mirror.expand(np.empty(0), centers)
    np.testing.assert_allclose(expanded[1], [-0.3, 0.2, 0.1, 1.0], atol=1e-15)
    _, feasible = mirror.reduce(centers)
    expected = [[0.2, 0.1, 0.3, 2.0], [-0.2, 0.1, 0.3, 2.0]]
    np.testing.assert_allclose(feasible, expected, atol=1e-15)


def test_planes_are_in_model_units(shape):
    # The plane x = 8 is off the middle by 1 of a diagonal of 2 sqrt(14).
    mirror = Mirror(shape, [1, 0], plane="8,0,0,2,0,0")
    expanded = mirror.expand(np.empty(0), np.zeros((2, 4)))
    off = 1.0 / shape.frame.scale
    np.testing.assert_allclose(expanded[1], [2 * off, 0, 0, 0], atol=1e-12)


@given(given_rows=rows())
def test_on_plane_lies_on_the_plane(shape, given_rows):
    constraint = OnPlane(shape, [1, 2], plane=TILTED)
    free, _ = constraint.reduce(given_rows)
    expanded = constraint.expand(free, given_rows)
    point, normal = np.split(np.array([float(x) for x in TILTED.split(",")]), 2)
    model = shape.frame.to_model(expanded[[1, 2], :3])
    np.testing.assert_allclose((model - point) @ normal, 0, atol=1e-12)
    # Label after label; a step of 1 is a step of 1.
    for k in range(6):
        step = np.zeros(6)
        step[k] = 0.125
        moved = constraint.expand(free + step, given_rows) - expanded
        assert not moved[[2, 1][k // 3]].any()
        assert np.linalg.norm(moved[[1, 2][k // 3]]) == pytest.approx(0.125, rel=1e-12)


def test_pickled(constraint):
    again = pickle.loads(pickle.dumps(constraint))
    centers = np.linspace(0.1, 2.0, 4 * N).reshape(N, 4)
    free, feasible = constraint.reduce(centers)
    free_again, feasible_again = again.reduce(centers)
    assert (free == free_again).all()
    assert (feasible == feasible_again).all()
    assert len(pickle.dumps(constraint)) < 10_000  # the shape stays behind


def test_coarse_and_full_level_have_one_plane(shape):
    coarse = coarsen(shape, 30)
    for text in ("x", TILTED):
        one, other = OnPlane(shape, [0], plane=text), OnPlane(coarse, [0], plane=text)
        assert (one.plane.point == other.plane.point).all()
        assert (one.plane.normal == other.plane.normal).all()


@pytest.mark.parametrize("labels", [[], [0], [0, 0], [0, 1, 2]])
def test_mirror_takes_two_labels(shape, labels):
    with pytest.raises(UsageError, match=r"'mirror' takes two different labels.*mirror\(leg2"):
        Mirror(shape, labels, plane="x")


@pytest.mark.parametrize("labels", [[], [0, 0], [0, 1, 0]])
def test_on_plane_takes_different_labels(shape, labels):
    with pytest.raises(UsageError, match="'on_plane' takes one or more different labels"):
        OnPlane(shape, labels, plane="x")


@pytest.mark.parametrize("kind", [Mirror, OnPlane])
def test_malformed_planes(shape, kind):
    with pytest.raises(UsageError, match="plane 'sideways' is not understood; allowed are 'auto'"):
        kind(shape, [0, 1], plane="sideways")


def test_given_planes_are_refused_in_another_space(shape):
    bent = shape.deformed(shape.geometry.vertices * [1, 2, 3], space="bent")
    for text in ("x", "0,0,0,1,0,0"):
        with pytest.raises(ShapeError, match=f"plane '{text}' .* space 'bent'"):
            Mirror(bent, [0, 1], plane=text)
        with pytest.raises(ShapeError, match="space 'bent'"):
            OnPlane(coarsen(bent, 30), [0], plane=text)
