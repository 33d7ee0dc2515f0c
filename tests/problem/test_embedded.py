"""Partitions in an embedding: where centres are, and what is asked of them (Sec. 9)."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from moseg_core.components.discovery.registry import Bundle, Component, Registry, registry
from moseg_core.components.discovery.specs import EmbeddingSpec
from moseg_core.errors import ExpressionError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests.shapes import tee

TEE = Shape.from_mesh(*tee(6, 5), name="tee")
NAMES = ("bar", "stem")
SHORT = "pattern_search(max_evaluations=1)"


class Turned:
    """The shape far away and upside down, and a hundred times as large."""

    def __call__(self, shape: Shape) -> Shape:
        return shape.deformed(5000 - 100 * shape.geometry.vertices, space="turned")


def known() -> Registry:
    """Everything installed, and this embedding as the bundle ``test``."""
    spec = EmbeddingSpec(name="turned", target=f"{__name__}:Turned")
    found = (Component("test", "tests 1.0", spec),)
    rest = [bundle for bundle in registry().bundles if bundle.name in ("core", "basic")]
    return Registry([*rest, Bundle("test", "tests", "1.0", __name__, found)])


def problem(**options):
    return Problem(NAMES, "narrow(stem) + convex_parts", registry=known(), **options)


def test_centres_by_hand_are_places_on_the_shape_as_it_is():
    elements = [int(np.argmax(TEE.points @ ends)) for ends in ([0.2, 0.1, 1], [0.2, 0.1, -1])]
    bar, stem = TEE.points[elements] + 0.01
    text = f"bar={bar[0]},{bar[1]},{bar[2]},stem={stem[0]},{stem[1]},{stem[2]}"
    seeder = {"name": "given", "centers": text}
    plain = segment(TEE, problem(), seeder=seeder, optimizer=SHORT)
    found = segment(TEE, problem(embedding="turned"), seeder=seeder, optimizer=SHORT)
    assert TEE.areas[found.labels != plain.labels].sum() < 0.05 * TEE.area
    assert found.centers.positions == pytest.approx(found.partitioned.points[elements])


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        ("turned", None, r"centres in the space 'turned'.* in 'original'.*\(--embedding turned\)"),
        (None, "turned", r"centres in the space 'original'.* in 'turned'.*\(--embedding none\)"),
    ],
)
def test_a_start_of_another_space_is_refused(before, after, message):
    start = segment(TEE, problem(embedding=before), optimizer=SHORT)
    with pytest.raises(UsageError, match=message):
        segment(TEE, problem(embedding=after), start=start)


@pytest.mark.parametrize("embedding", [None, "turned"])
def test_a_start_of_the_same_space_goes_on(embedding):
    start = segment(TEE, problem(embedding=embedding), optimizer=SHORT)
    again = "test:turned" if embedding else None
    found = segment(TEE, problem(embedding=again), start=start, optimizer=SHORT)
    assert (found.labels == start.labels).all()


@pytest.mark.parametrize("again", [copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_results_and_their_problems_can_be_copied(again):
    found = segment(TEE, problem(embedding="turned"), optimizer=SHORT)
    there = again(found)
    assert (there.labels == found.labels).all()
    assert (there.partitioned.points == found.partitioned.points).all()
    assert there.problem.evaluate(there.shape, there.labels).cost == found.evaluation.cost


def test_a_mistyped_space_is_told_the_nearest_also_without_an_embedding():
    with pytest.raises(ExpressionError, match=r"unknown space 'orignal'.*did you mean 'original'"):
        Problem(NAMES, "narrow(stem) @ orignal", registry=known())
    with pytest.raises(ExpressionError, match=r"give the embedding .turned. too"):
        Problem(NAMES, "narrow(stem) @ turned", registry=known())
