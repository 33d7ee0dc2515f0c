"""Search options: read once, put together once, and said in one way everywhere."""

from __future__ import annotations

import inspect
from dataclasses import fields

import numpy as np
import pytest

from moseg_core import Hierarchy, Problem, load, load_recipe, sample_path, segment_hierarchy
from moseg_core.cli.flags import SearchFlags, SteeringFlags
from moseg_core.cli.request import read_search
from moseg_core.components.chosen import Choice
from moseg_core.errors import UsageError
from moseg_core.problem.settings import Method, OptionValues, SearchOptions, SettledOptions
from moseg_core.problem.statement import Statement
from moseg_core.search.segment import segment

NAMES = {field.name for field in fields(SearchOptions)}


def test_every_door_takes_the_same_options():
    assert set(OptionValues.__annotations__) == NAMES
    assert {field.name for field in fields(SettledOptions)} == NAMES
    assert {field.name for field in fields(SearchFlags)} == NAMES
    others = {"shape", "problem", "start", "freeze", "pins", "defaults", "report"}
    assert set(inspect.signature(segment).parameters) == NAMES | others


def test_values_are_read_when_the_options_are_made():
    options = SearchOptions(
        seeder="kmeans(rounds=5)", optimizer={"name": "x", "k": 2}, restarts="3", resolution="40"
    )
    assert options.seeder == Choice("kmeans", {"rounds": 5.0})
    assert options.optimizer == Choice("x", {"k": 2})
    assert (options.restarts, options.resolution) == (3, 40)
    assert SearchOptions(seed=np.int64(3)).seed == 3
    counts = SearchOptions(restarts=np.int64(3), resolution=np.int32(40), workers=np.int64(2))
    assert (counts.restarts, counts.resolution, counts.workers) == (3, 40, 2)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"restarts": 0}, "there must be at least one start, not 0"),
        ({"restarts": True}, "the number of starts must be a whole number, not True"),
        ({"polished": -1}, "the number of polished results must be 0 or more, not -1"),
        ({"polished": "x"}, "the number of polished results must be a whole number, not 'x'"),
        ({"finalists": 0.5}, "the number of finalists must be a whole number, not 0.5"),
        ({"resolution": "fine"}, "the resolution must be 'full' or a number of super-elements"),
        ({"settings": "papr"}, "unknown settings 'papr'; did you mean 'paper'?"),
        ({"seed": -1}, "the seed must not be negative, and is -1"),
        ({"seed": 0.5}, "the seed must be a whole number, not 0.5"),
        ({"max_seconds": -1}, "the limit on seconds must be finite and not negative, and is -1"),
        ({"max_seconds": float("nan")}, "the limit on seconds must be finite and not negative"),
        ({"max_seconds": "1"}, "the limit on seconds must be a number, not '1'"),
        ({"workers": 0}, "there must be at least one worker, not 0"),
        ({"seeder": 3}, "seeder must be a name or a table with a name, not 3"),
    ],
)
def test_values_that_make_no_sense_are_refused(given, message):
    with pytest.raises(UsageError) as caught:
        SearchOptions(**given)
    assert str(caught.value).startswith(message)


def test_the_request_goes_before_the_recipe_and_the_recipe_before_the_settings():
    request = SearchOptions(labeler="greedy", restarts=3)
    recipe = Method(labeler="exhaustive", seeder="evolution(population=9)", resolution=50)
    found = request.settled(recipe)
    assert str(found.labeler) == "greedy"
    assert str(found.seeder) == "evolution(population=9)"
    assert str(found.optimizer) == "core:pattern_search"
    assert (found.restarts, found.resolution, found.finalists, found.polished) == (3, 50, 2, 2)


def test_under_paper_the_request_keeps_its_parameters_and_the_recipe_its_names():
    request = SearchOptions(settings="paper", optimizer="pattern_search(threshold=0.01)")
    recipe = Method(optimizer="other", seeder="evolution(population=9)", restarts=4, resolution=50)
    found = request.settled(recipe)
    assert str(found.optimizer) == "pattern_search(threshold=0.01)"
    assert str(found.seeder) == "evolution"
    assert (found.restarts, found.resolution, found.finalists) == (1, "full", 1)


@pytest.mark.parametrize(
    ("request_", "recipe", "settings", "refiner"),
    [
        (None, None, "default", None),
        (None, "cut(band=2)", "default", "cut(band=2)"),
        ("other", "cut(band=2)", "default", "other"),
        ("none", "cut(band=2)", "default", None),
        (None, "none", "default", None),
        (None, "cut(band=2)", "paper", None),
        ("cut(band=2)", None, "paper", "cut(band=2)"),
    ],
)
def test_there_is_a_refiner_only_where_one_is_asked_for(request_, recipe, settings, refiner):
    options = SearchOptions(refiner=request_, settings=settings)
    found = options.settled(Method(refiner=recipe)).refiner
    assert (None if found is None else str(found)) == refiner


def test_no_refiner_is_written_down_like_one():
    stated = Statement(labels=("a",), minimize="narrow(a)", search=Method(refiner="none"))
    assert stated.document()["refiner"] == "none"
    assert Statement.read(stated.document()) == stated


@pytest.mark.parametrize(
    ("request_", "recipe", "restarts"),
    [
        ({}, {}, 8),
        ({"optimizer": "f(max_evaluations=9)"}, {}, 1),
        ({}, {"optimizer": "f(max_evaluations=9)"}, 1),
        ({"optimizer": "f"}, {"optimizer": "g(max_evaluations=9)"}, 8),
        ({"optimizer": "f(max_evaluations=9)"}, {"restarts": 4}, 4),
        ({"optimizer": "f(max_evaluations=9)", "restarts": 2}, {"restarts": 4}, 2),
    ],
)
def test_one_start_where_evaluations_are_limited_and_nobody_says_more(request_, recipe, restarts):
    assert SearchOptions(**request_).settled(Method(**recipe)).restarts == restarts


def test_centres_by_hand_are_a_seeder():
    steering = SteeringFlags(centers="a=0,0,0")
    found = read_search(SearchFlags(workers=1), steering)
    assert found.seeder == Choice("core:given", {"centers": "a=0,0,0"})
    with pytest.raises(
        UsageError,
        match="--centers goes with a seeder that takes centres, 'core:given', not 'kmeans'",
    ):
        read_search(SearchFlags(seeder="kmeans"), steering)


def test_what_belongs_to_a_run_is_refused_where_a_method_is_meant():
    for wrong in (SearchOptions(seed=5), {"seeder": "kmeans"}, load_recipe("paper_hammer")):
        with pytest.raises(UsageError, match=r"must be a Method, .* belong to the run"):
            Statement(labels=("a",), minimize="narrow(a)", search=wrong)
        with pytest.raises(UsageError, match=r"a hierarchy's search must be a Method"):
            Hierarchy(Problem(["a"], "narrow(a)"), search=wrong)
        with pytest.raises(UsageError, match=r"defaults must be a Method"):
            segment(load(sample_path("hammer")), Problem(["a"], "narrow(a)"), defaults=wrong)


def test_options_that_there_are_not_are_named():
    with pytest.raises(UsageError, match="unknown option 'optimiser'; did you mean 'optimizer'"):
        segment_hierarchy(load(sample_path("hammer")), Problem(["a"], "narrow(a)"), optimiser="x")


def test_a_start_that_is_none_is_named():
    shape = load(sample_path("hammer"))
    for wrong in ("x", [[0, 0, 0]]):
        with pytest.raises(UsageError, match="the start must be Centers, a Result or an Alignment"):
            segment(shape, Problem(["a"], "narrow(a)"), start=wrong)
