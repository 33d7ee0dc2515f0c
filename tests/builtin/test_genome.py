"""What individuals stand for: a place per label, or per label that no other follows."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.genome import Genome
from moseg_core.builtin.voronoi import Voronoi
from tests.made_up import STRIP, on_strip
from tests.reflections import known

NAMES = ("a", "b", "c")


def test_without_constraints_every_label_has_a_place_and_all_may_be_exchanged():
    genome = Genome.of(on_strip(names=NAMES))
    assert genome.labels.tolist() == [0, 1, 2]
    assert len(set(genome.roles.tolist())) == 1
    assert genome.sorted(np.array([5, 1, 3])).tolist() == [1, 3, 5]
    assert genome.key(np.array([5, 1, 3])) == genome.key(np.array([3, 5, 1]))
    assert genome.places(np.array([2, 0, 1])).tolist() == [2, 0, 1]


def test_a_vector_is_that_of_the_centres_and_weights():
    evaluator = on_strip(names=NAMES)
    genome = Genome.of(evaluator)
    at, weights = STRIP.points[[6, 1, 3]], np.array([1.0, 2.0, 0.5])
    for given, expected in (weights, weights), (None, np.ones(3)):
        found = evaluator.parameterization.decode(genome.vector(at, given))
        assert found.positions == pytest.approx(at)
        assert found.weights.tolist() == expected.tolist()
        centers = genome.centers(at, given)
        assert (centers.positions == at).all()  # not by way of unit coordinates
        assert (centers.weights == expected).all()


def test_a_centre_that_follows_has_no_place_and_is_filled_in_with_its_weight():
    evaluator = on_strip(names=NAMES, constraints=["mirror(a, b)"], registry=known())
    genome = Genome.of(evaluator)
    assert sorted(genome.labels.tolist()) == [1, 2]
    at, weights = STRIP.points[[1, 3]], np.array([2.0, 0.5])
    order = np.argsort(genome.labels)
    found = genome.centers(at[order], weights[order])
    assert found.positions[:, 0].tolist() == pytest.approx([6.5, 1.5, 3.5])
    assert found.weights.tolist() == pytest.approx([2.0, 2.0, 0.5])
    roles = dict(zip(genome.labels.tolist(), genome.roles.tolist(), strict=True))
    assert roles[1] != roles[2]


def test_of_a_label_with_several_centres_the_first_is_placed():
    def partition(shape, n):
        return Voronoi(shape, n, centers="b=2", labels=NAMES)

    for constraints in [], ["mirror(a, c)"]:
        evaluator = on_strip(
            names=NAMES, partition=partition, constraints=constraints, registry=known()
        )
        genome = Genome.of(evaluator)
        at = STRIP.points[[1, 3, 6]][genome.labels]
        found = genome.centers(at, np.ones(len(at)))
        assert found.positions.shape == (3, 3)
        assert found.positions[1:, 0].tolist() == pytest.approx([3.5, 6.5])
