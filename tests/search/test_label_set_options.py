"""What the search for one label set of several is asked to do."""

from __future__ import annotations

import pytest

from moseg_core.problem.settings import Method, SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.problem.variants import Variants
from moseg_core.search.label_set_options import (
    brief_search,
    for_task,
    seeds_alone,
    seeds_say_enough,
    shared_starts,
)

VARIANTS = Variants.of(
    Statement(labels=("box{2..4}",), minimize="compact(box*)", search=Method(restarts=None))
)
TASK = VARIANTS.tasks[0]  # box1 and box2


def test_what_is_said_of_labels_that_it_lacks_is_left_out():
    asked = SearchOptions.of({"parameterization": 'voronoi(centers="box1=2,box4=2")'})
    assert for_task(asked, TASK, VARIANTS).parameterization.parameters == {"centers": "box1=2"}
    assert for_task(SearchOptions(), TASK, VARIANTS) == SearchOptions()


def test_starts_that_nobody_gave_a_number_for_are_shared():
    assert shared_starts(TASK, SearchOptions(), 3).restarts == 2
    assert shared_starts(TASK, SearchOptions(), 9).restarts == 1
    assert shared_starts(TASK, SearchOptions(restarts=5), 3) is TASK.search


@pytest.mark.parametrize(
    ("options", "enough"),
    [
        ({"seeder": "sized_evolution", "restarts": 1}, True),
        ({"seeder": "evolution", "restarts": 1}, True),
        ({"seeder": "kmeans", "restarts": 1}, False),
        ({"seeder": "sized_evolution", "restarts": 2}, False),
    ],
)
def test_seeds_say_enough_where_they_are_the_best_of_a_search_and_the_only_ones(options, enough):
    assert seeds_say_enough(TASK, SearchOptions.of(options), 3) is enough


def test_one_evaluation_finds_what_seeds_cost():
    asked = SearchOptions.of({"optimizer": "pattern_search(threshold=0.1)", "restarts": 1})
    found = seeds_alone(asked, Method(seeder="evolution", resolution=40), coarse=False)
    assert found.optimizer.parameters == {"threshold": 0.1, "max_evaluations": 1}
    assert found.resolution == 40
    assert found.seeder is None  # the recipe's, as ever
    assert seeds_alone(asked, Method(), coarse=True).resolution == "full"


def test_a_brief_search_has_the_components_own_parameters_and_one_start():
    method = Method(seeder="evolution(population=90)", optimizer="pattern_search(threshold=0.1)")
    asked = SearchOptions.of({"parameterization": "voronoi(connected=false)", "restarts": 7})
    found = brief_search(asked, method, TASK, coarse=True)
    assert (found.restarts, found.finalists, found.resolution) == (1, 1, "full")
    assert str(found.seeder) == "evolution"
    assert found.optimizer.parameters == {"threshold": 0.005}
    assert found.parameterization.parameters == {"connected": False}
    assert brief_search(asked, method, TASK, coarse=False).optimizer.parameters == {}
