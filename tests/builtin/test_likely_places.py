"""Chances of places against the formula element by element, and what is drawn by them."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.builtin.likely_places import LikelyPlaces
from moseg_core.builtin.places import Places
from moseg_core.builtin.sized_evolution import SizedEvolution
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.protocols import never_stop
from moseg_core.problem.problem import Problem
from moseg_core.search.evaluator import ProblemEvaluator
from moseg_core.shape.coarse import coarsen
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.builtin.along import area, far, registry_with_along

STRIP = Shape.from_mesh(*shapes.jitter(shapes.rectangle(24, 3, 24, 3), 2), name="strip")
LABELS = ["left", "right1", "right2", "any"]
TEXT = "far(left, axis=0) + 0.5*far(right*, axis=0, times=-1) + area(any)"


@pytest.fixture
def source(monkeypatch):
    return registry_with_along(monkeypatch)


def problem(source, text=TEXT):
    return Problem(LABELS, text, objectives={"far": far, "area": area}, registry=source)


def likely(source, *, text=TEXT, shape=STRIP, count=12):
    elements = Places.spread(shape, count).elements
    return LikelyPlaces.of(problem(source, text), shape, elements, np.arange(4))


def literal_chances(shape, elements, costs):
    points = shape.points[elements]
    nearest = [((points - p) ** 2).sum(axis=1).argmin() for p in shape.points]
    mean = (shape.areas * costs).sum() / shape.areas.sum()
    sigma = np.sqrt((shape.areas * (costs - mean) ** 2).sum() / shape.areas.sum())
    areas, means = [], []
    for place in range(len(points)):
        own = [e for e in range(shape.n_elements) if nearest[e] == place]
        areas.append(shape.areas[own].sum())
        means.append((shape.areas[own] * costs[own]).sum() / areas[-1])
    return np.array(areas) * np.exp(-6 * (np.array(means) - min(means)) / sigma), np.array(areas)


@pytest.mark.parametrize("shape", [STRIP, coarsen(STRIP, 40)], ids=["input", "super-elements"])
def test_chances_are_those_of_the_formula_whatever_the_weight(source, shape):
    found = likely(source, shape=shape)
    elements = Places.spread(shape, 12).elements
    x = shape.points[:, 0]
    if shape.members is not None:  # a super-element has the mean of its members
        whole = STRIP.areas * STRIP.points[:, 0]
        x = np.bincount(shape.members, whole) / np.bincount(shape.members, STRIP.areas)
    left, areas = literal_chances(shape, elements, x)
    right, _ = literal_chances(shape, elements, -x)
    assert found.chances[:, 0] == pytest.approx(left)
    assert found.chances[:, 1] == pytest.approx(right)
    assert found.chances[:, 2] == pytest.approx(right)
    assert found.chances[:, 3] == pytest.approx(areas)
    assert found.alike.tolist() == [0, 1, 1, 2]


def test_a_problem_that_says_nothing_of_places_has_no_likely_ones(source):
    assert likely(source, text="area(*)") is None


def test_a_field_that_is_the_same_everywhere_leaves_all_places_alike(source):
    even = likely(source, text="far(left, axis=0, times=0) + area(any)")
    assert even.chances[:, 0].tolist() == even.chances[:, 3].tolist()


def test_places_differ_and_lie_where_their_labels_are_likely(source):
    found, rng = likely(source), np.random.default_rng(0)
    drawn = np.stack([found.draw(rng) for _ in range(300)])
    assert all(len(set(row)) == 4 for row in drawn.tolist())
    x = found.points[drawn][:, :, 0]
    assert x[:, 0].mean() < 5
    assert x[:, 1:3].mean() > 18
    assert 9 < x[:, 3].mean() < 15


def test_alike_labels_keep_apart(source):
    found, rng = likely(source, count=40), np.random.default_rng(0)
    both = np.stack([found.draw(rng)[1:3] for _ in range(300)])
    apart = np.linalg.norm(np.diff(found.points[both], axis=1), axis=2).mean()
    chance = found.chances[:, 1] / found.chances[:, 1].sum()
    pairs = rng.choice(len(chance), (300, 2), p=chance)
    free = np.linalg.norm(np.diff(found.points[pairs], axis=1), axis=2).mean()
    assert apart > 1.3 * free


def test_as_many_places_as_labels_are_all_drawn(source):
    found = likely(source, count=4)
    drawn = found.draw(np.random.default_rng(3))
    assert sorted(drawn.tolist()) == [0, 1, 2, 3]


def test_an_evolution_begins_with_them(source):
    """Without children, the first generation is all there is; one of likely places costs less."""

    def best(informed):
        evaluator = ProblemEvaluator(STRIP, problem(source), Voronoi(STRIP, 4))
        seeder = SizedEvolution(
            population=4, generations=0, relocations=0, informed=informed, labelled=True
        )
        rng = np.random.default_rng(0)
        return seeder(evaluator, rng=rng, report=never_stop).history[-1]["best"]

    assert best(0.5) <= best(0.0)
    assert best(1.0) != best(0.0)
