"""Labellings, some of whose elements have no label."""

from __future__ import annotations

import numpy as np

from moseg_core.io.labels.labelling import Labelling
from moseg_core.shape.shape import Shape
from tests import shapes

STRIP = Shape.from_mesh(*shapes.strip(8))


def test_elements_without_a_label():
    found = Labelling(labels=np.array([-1, 0, -1]), names=("a",))
    assert found.unlabelled.tolist() == [True, False, True]


def test_those_without_a_label_get_that_of_the_nearest_that_has_one():
    rng = np.random.default_rng(0)
    for _ in range(20):
        labels = rng.integers(-1, 3, STRIP.n_elements)
        labels[rng.integers(STRIP.n_elements)] = 2
        filled = Labelling(labels=labels, names=None).filled(STRIP)
        known = np.flatnonzero(labels >= 0)
        for element, label in enumerate(filled):
            apart = np.linalg.norm(STRIP.points[known] - STRIP.points[element], axis=1)
            near = known[apart <= apart.min() + 1e-12]
            assert label in labels[near]
    assert (labels == -1).any()  # the input is left as it was


def test_a_whole_labelling_stays_as_it_is():
    labels = np.arange(STRIP.n_elements)
    assert Labelling(labels=labels, names=None).filled(STRIP) is labels
