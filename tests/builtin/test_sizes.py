"""Weights from expected shares of the area."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.sizes import CLASSES, PLAIN, Sizes
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import Centers
from moseg_core.shape.shape import Shape

UNKNOWN = np.nan


def test_weights_go_with_the_roots_of_known_shares():
    sizes = Sizes.of(np.array([0.81, 0.09, 0.01]), "expected")
    weights = sizes.weights(np.array([0, 1, 3]))  # classes are for those of which nothing is known
    assert (weights / weights[2]).tolist() == pytest.approx([9, 3, 1])
    assert weights.mean() == pytest.approx(1)


def test_labels_of_unknown_size_share_what_is_left_and_have_classes():
    sizes = Sizes.of(np.array([0.64, UNKNOWN, UNKNOWN]), "expected")
    weights = sizes.weights(np.array([PLAIN, PLAIN, 0]))
    assert (weights / weights[0]).tolist() == pytest.approx(
        [1, np.sqrt(0.18) / 0.8, 0.35 * np.sqrt(0.18) / 0.8]
    )
    # Where the known ones leave nothing, the others are small and still there.
    full = Sizes.of(np.array([0.7, 0.6, UNKNOWN]), "expected")
    assert 0 < full.base[2] < full.base[1]


@pytest.mark.parametrize("shares", [[0.9, 0.1], [UNKNOWN, 0.1], [UNKNOWN, UNKNOWN]])
def test_sizes_that_are_equal_or_evolve_ignore_what_is_known(shares):
    equal = Sizes.of(np.array(shares), "equal")
    assert (equal.weights(np.array([0, 3])) == 1.0).all()
    evolved = Sizes.of(np.array(shares), "evolved")
    for first in range(len(CLASSES)):
        weights = evolved.weights(np.array([first, PLAIN]))
        assert weights[0] / weights[1] == pytest.approx(CLASSES[first])


def test_many_individuals_at_once():
    sizes = Sizes.of(np.array([0.5, UNKNOWN]), "expected")
    classes = np.array([[0, 0], [0, 3]])
    together = sizes.weights(classes)
    assert together.tolist() == [sizes.weights(row).tolist() for row in classes]


def test_a_border_divides_the_way_between_two_centres_as_their_weights():
    shape = Shape.from_points([[x, 0, 0] for x in range(101)])
    weights = Sizes.of(np.array([0.64, 0.04]), "expected").weights(np.full(2, PLAIN))
    voronoi = Voronoi(shape, 2)
    at = Centers(positions=shape.points[[0, 100]], weights=weights)
    labels = voronoi.labels(voronoi.encode(at)[None])[0]
    assert (labels == 0).sum() == pytest.approx(80, abs=1)
