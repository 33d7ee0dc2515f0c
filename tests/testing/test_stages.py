"""Shapes and problems that components are tried on: in generic position, as they say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.distance import pdist, squareform

from moseg_core.cost import Cost
from moseg_core.testing import stages
from moseg_core.testing.parameterizations import within


@pytest.mark.parametrize("shape", [stages.pebble(), stages.pebble(0), stages.horseshoe()])
def test_surfaces_are_closed_in_one_piece_with_no_element_equally_far_from_two(shape):
    assert shape.volume > 0
    assert shape.adjacency.components()[0] == 1
    apart = np.sort(squareform(pdist(shape.points)), axis=1)
    assert np.diff(apart, axis=1).min() > 1e-9 * shape.frame.scale
    assert len(np.unique(shape.areas.round(12))) == shape.n_elements


def test_a_pebble_has_four_times_the_faces_for_each_split():
    assert [stages.pebble(k).n_elements for k in range(4)] == [8, 32, 128, 512]


def test_a_pebble_is_far_from_the_origin():
    shape = stages.pebble()
    assert np.linalg.norm(shape.frame.center) > 2 * shape.frame.scale


def test_an_even_pebble_is_its_own_mirror_image_and_the_other_is_not():
    def mirrored(shape):
        points = shape.points - shape.frame.center
        apart = np.linalg.norm((points * [-1, 1, 1])[:, None] - points, axis=2)
        return apart.min(axis=1).max()

    assert mirrored(stages.even_pebble()) < 1e-12
    assert mirrored(stages.pebble()) > 0.1


def test_elements_come_in_the_order_asked_for():
    order = np.random.default_rng(0).permutation(128)
    other = stages.pebble(order=order)
    assert np.array_equal(other.points, stages.pebble().points[order])
    places = np.random.default_rng(0).permutation(stages.dots().n_elements)
    assert np.array_equal(stages.dots(order=places).points, stages.dots().points[places])


def test_the_turn_is_a_rotation_about_no_axis_of_the_file():
    turn = stages.turn()
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(turn) == pytest.approx(1.0)
    assert np.abs(turn).max() < 0.95


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_vectors_of_a_stage_leave_no_part_empty(n):
    stage = stages.evaluator(n)
    for vector in stages.vectors(stage, 3):
        assert len(np.unique(stage.labels(vector))) == n
        assert stage.evaluate(vector).cost.empty == 0


def test_unary_terms_and_all_terms_do_not_agree_on_the_labels():
    stage = stages.evaluator(4)
    found = []
    for vector in stages.vectors(stage, 6, seed=1):
        segmentation = stage.segmentation(stage.labels(vector))
        unary = stage.unary_costs(vector).assign()
        orders = np.stack(np.meshgrid(*[range(4)] * 4)).reshape(4, -1).T
        whole = [o for o in orders if len(set(o.tolist())) == 4]
        best = min(whole, key=lambda o: stage.order_cost(segmentation, o))
        found.append(unary.tolist() != best.tolist())
    assert any(found)


def test_vectors_within_bounds_reach_them_and_go_far():
    lower = np.array([0.0, -np.inf, -np.inf, 1.0])
    upper = np.array([1.0, np.inf, 2.0, 1.0])
    found = within(lower, upper, np.ones(4), 12)
    assert found.shape == (12, 4)
    assert ((found >= lower) & (found <= upper)).all()
    assert (found[-1] == lower).tolist() == [True, False, False, True]
    assert np.abs(found[:, 1]).max() > 100


def test_unlike_says_by_how_much():
    assert stages.unlike([1.0, 2.0], [1.0, 2.0]) is None
    assert stages.unlike([1.0, 2.0], [1.0, 2.5]) == 0.5
    assert stages.unlike([1.0], [1.05], tolerance=0.1) is None
    assert stages.unlike([1.0], [1.0, 2.0]) == math.inf
    assert stages.unlike(None, [1.0]) == math.inf
    assert stages.unlike([np.nan], [1.0], tolerance=1.0) is not None


def test_nan_is_as_bad_as_can_be():
    assert stages.clean(Cost(1, math.nan)) == Cost(1, math.inf)
    assert stages.clean(Cost(1, 2.0)) == Cost(1, 2.0)
