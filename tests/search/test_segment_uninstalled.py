"""Components that are not installed, in a search: they take part, and results name them."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from moseg_core.builtin.greedy import Greedy
from moseg_core.builtin.kmeans import KMeans
from moseg_core.builtin.pattern_search import PatternSearch
from moseg_core.builtin.voronoi import Voronoi
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.components.protocols import Seeding
from moseg_core.errors import PluginError, UsageError
from moseg_core.io.result_json import write_json
from moseg_core.problem.problem import Problem
from moseg_core.problem.settings import Method
from moseg_core.problem.statement import Statement
from moseg_core.search.clipped_result import clip
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


PROBLEM = Problem(["stem", "bar"], "2*slim(stem) + slim(bar)", objectives={"slim": slim})


class MySearch(PatternSearch):
    """An optimizer of one's own."""


class MySeeds(KMeans):
    """A seeder of one's own."""


class MyLabels(Greedy):
    """A labeler of one's own."""


class MyCells(Voronoi):
    """A parameterization of one's own."""


class Still:
    """A refiner of one's own, which moves nothing."""

    def __call__(self, evaluator, labels, *, report):
        return labels.copy()


class Lost:
    """A seeder that fails."""

    def __call__(self, evaluator, *, rng, report):
        return Seeding(centers=np.full((1, 3), np.nan))


OWN = {
    "optimizer": functools.partial(MySearch, threshold=0.01),
    "seeder": MySeeds,
    "labeler": MyLabels,
    "parameterization": MyCells,
    "refiner": Still,
}
NAMED = {
    "optimizer": "pattern_search(threshold=0.01)",
    "seeder": "kmeans",
    "labeler": "greedy",
    "parameterization": "voronoi",
}


@pytest.mark.parametrize("workers", [1, 2])
def test_they_do_what_installed_ones_do_and_are_named(workers):
    own = segment(SHAPE, PROBLEM, restarts=2, workers=workers, **OWN)
    named = segment(SHAPE, PROBLEM, restarts=2, **NAMED)
    assert (own.labels == named.labels).all()
    assert own.cost == named.cost
    assert own.method["optimizer"] == f"{__name__}:MySearch(threshold=0.01)"
    assert own.method["seeder"] == f"{__name__}:MySeeds(outliers=0.001)"
    for name in ("MySearch", "MySeeds", "MyLabels", "MyCells", "Still"):
        assert own.versions[f"{__name__}:{name}"] == "not installed"
    assert f"{__name__}:Still".encode() in write_json(own)


def test_levels_take_them_too():
    found = segment_hierarchy(SHAPE, PROBLEM, restarts=1, **OWN)
    assert found.method["labeler"] == f"{__name__}:MyLabels"


def test_errors_name_them():
    with pytest.raises(PluginError, match=rf"seeder '{__name__}:Lost', which is not installed"):
        segment(SHAPE, PROBLEM, seeder=Lost)


def test_a_result_of_a_parameterization_that_is_not_installed_is_not_clipped():
    result = segment(SHAPE, PROBLEM, restarts=1, **OWN | {"refiner": None})
    with pytest.raises(UsageError, match=r"'.*:MyCells' is not installed; put it into a bundle"):
        clip(result)


def test_a_recipe_cannot_hold_them():
    with pytest.raises(UsageError, match="give the class to segment instead"):
        Statement(labels=("a",), minimize="slim(a)", search=Method(optimizer=MySearch))
