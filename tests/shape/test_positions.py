"""Which vertices are at one position, against a literal reference."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moseg_core.shape.positions import find_positions


def reference(points, tolerance):
    """One place after the other: the nearest stand-in or, where none is near, itself."""
    stand_ins, chosen = [], {}
    points = np.asarray(points, float) + 0.0
    for point in points:
        if tuple(point) in chosen:
            continue
        distances = [np.linalg.norm(point - other) for other in stand_ins]
        equal = [k for k, distance in enumerate(distances) if distance <= tolerance]
        if not equal:
            equal = [len(stand_ins)]
            stand_ins.append(point)
            distances.append(0.0)
        chosen[tuple(point)] = min(equal, key=lambda k: (distances[k], k))
    order = sorted(range(len(stand_ins)), key=lambda k: tuple(stand_ins[k]))
    return [order.index(chosen[tuple(point)]) for point in points]


GRID = st.integers(-3, 3).map(lambda k: k / 2)


@given(
    points=st.lists(st.tuples(GRID, GRID, GRID), min_size=1, max_size=40),
    tolerance=st.sampled_from([0.0, 0.4, 0.5, 0.8, 1.1, 30.0]),
)
def test_positions_are_those_of_the_reference(points, tolerance):
    found = find_positions(np.array(points), tolerance)
    assert found.number.tolist() == reference(points, tolerance)


@pytest.mark.parametrize("tolerance", [0.0, 1e-3, 0.02, 0.2])
@pytest.mark.parametrize("middle", [0.0, 1e6])
def test_random_points_far_and_near(tolerance, middle):
    rng = np.random.default_rng(3)
    points = middle + rng.random((300, 3))
    points = np.concatenate([points, points[:40], points[:40] + 1e-4])
    assert find_positions(points, tolerance).number.tolist() == reference(points, tolerance)


def test_equal_positions_are_numbered_as_numpy_does():
    points = np.random.default_rng(0).integers(0, 4, (500, 3)).astype(float)
    points[::7] *= -1.0  # with negative zeros
    _, expected = np.unique(points + 0.0, axis=0, return_inverse=True)
    for tolerance in (0.0, 1e-8):
        found = find_positions(points, tolerance)
        np.testing.assert_array_equal(found.number, expected.reshape(-1))
        assert found.n_near == 0


def test_a_chain_of_near_vertices_does_not_shrink_to_one():
    line = np.zeros((1001, 3))
    line[:, 0] = np.arange(1001) * 1e-3
    found = find_positions(line, 1.5e-3)
    assert found.number.max() == 500
    places = line[np.unique(found.number, return_index=True)[1]][found.number]
    assert np.abs(places - line).max() <= 1.5e-3
    assert found.n_near == 500


def test_crowds_take_no_quadratic_time_or_memory():
    crowd = np.random.default_rng(1).random((200_000, 3)) * 1e-9
    found = find_positions(np.concatenate([crowd, np.eye(3)]), 1e-8)
    assert (found.number.max(), found.n_near) == (3, 199_999)


def test_vertices_out_of_every_grid_are_joined_where_equal():
    points = np.array([[1e40, 0, 0], [0, 0, 0], [0, 1e-9, 0], [1e40, 0, 0], [-1e300, 0, 0]])
    assert find_positions(points, 1e-8).number.tolist() == [2, 1, 1, 2, 0]


def test_two_sheets_stay_two_unless_they_are_nearer_than_the_tolerance():
    x, y = np.meshgrid(np.arange(20.0), np.arange(20.0))
    sheet = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    sheets = np.concatenate([sheet, sheet + np.array([0, 0, 1e-6])])
    assert find_positions(sheets, 1e-7).n_near == 0
    assert find_positions(sheets, 1e-5).n_near == 400
