"""Recipes learned from some models and tried on others, one case at a time."""

from __future__ import annotations

from dataclasses import replace
from statistics import fmean

import numpy as np
import pytest
from moseg_benchmark import learned_cases as module
from moseg_benchmark.learned_cases import Shelf, numbers_right, run_learned_case
from moseg_benchmark.lessons import Lessons, learned_cases
from moseg_benchmark.psb import find_models

from moseg_core import Problem, load, read_labels
from moseg_core.agreement import rand_index_error


def silent(progress):
    return False


@pytest.fixture(scope="module")
def models(members):
    return find_models(members)


def case_of(models, k, *, n=None, learner="counted", seed=0):
    (batch,) = [
        batch
        for batch in learned_cases(models, Lessons(examples=(n,), learner=learner), [seed])
        if batch[0].model == models[k]
    ]
    return batch[0]


def test_what_is_found_is_compared_with_people_names_and_costs(models, learner):
    result, labels, recipe = run_learned_case(case_of(models, 0), shelf=Shelf(), report=silent)
    assert result.failure == ""
    assert recipe.learned_from == ("22", "23", "24")
    shape = load(models[0].mesh)
    people = [read_labels(path, shape.n_elements).labels for path in models[0].people]
    expected = fmean(rand_index_error(labels, person) for person in people)
    assert result.rand_index_error == pytest.approx(expected, abs=1e-15)
    named = read_labels(models[0].names, shape.n_elements)
    is_two = np.array(["two" in name for name in ("one", "two1", "two2")])[labels]
    right = shape.areas[is_two == (named.labels == 1)].sum() / shape.area
    assert result.named_right == pytest.approx(right)
    assert result.numbers_right is None
    assert (result.own_label_set, result.offered) == ("one, 2 two", True)
    assert result.label_set in ("one, two", "one, 2 two")
    thirds = people[0]
    problem = Problem(["one", "two1", "two2"], "narrow(one) + narrow(two*)")
    own = problem.evaluate(shape, np.array([1, 0, 2])[thirds]).cost.value
    assert result.own_cost == pytest.approx(own, rel=1e-9)
    assert result.search_cost == result.cost
    assert result.seconds > 0
    assert result.learning_seconds > 0
    assert result.examples == 3


def test_the_cost_before_boundaries_moved_is_kept(models, learner):
    plain, *_ = run_learned_case(case_of(models, 0), shelf=Shelf(), report=silent)
    moving = case_of(models, 0, learner="counted(refiner=graph_cut)")
    result, *_ = run_learned_case(moving, shelf=Shelf(), report=silent)
    assert result.search_cost == plain.cost
    assert result.cost != plain.cost


def test_a_label_set_that_was_not_learned_is_not_offered(models, learner):
    # From 24, which has two ends, for 23, which has one.
    result, _, _ = run_learned_case(case_of(models, 2, n=1), shelf=Shelf(), report=silent)
    assert (result.own_label_set, result.label_set) == ("one, two", "one, 2 two")
    assert not result.offered
    assert result.own_cost is None
    assert result.named_right > 0


def test_a_model_without_names_is_compared_with_people_only(models, learner):
    result, labels, _ = run_learned_case(case_of(models, 5), shelf=Shelf(), report=silent)
    assert result.failure == ""
    assert result.rand_index_error is not None
    assert result.named_right is None
    assert result.own_label_set == ""
    assert labels is not None


def test_shapes_are_loaded_and_recipes_learned_once(models, learner, monkeypatch):
    loaded, learned = [], []

    def count_load(path):
        loaded.append(path.stem)
        return load(path)

    def count_learn(examples, **words):
        learned.append(len(examples))
        return module_learn(examples, **words)

    module_learn = module.learn
    monkeypatch.setattr(module, "load", count_load)
    monkeypatch.setattr(module, "learn", count_learn)
    shelf = Shelf()
    batches = learned_cases(models[:3], Lessons(examples=(1, None), learner="counted"), [0, 1])
    cases = [case for batch in batches for case in batch]
    kept = [run_learned_case(case, shelf=shelf, report=silent) for case in cases]
    assert sorted(loaded) == ["21", "22", "23"]
    assert sorted(learned) == [1, 1, 1, 2, 2, 2]
    for case, (result, labels, _) in zip(cases, kept, strict=True):
        alone, own, _ = run_learned_case(case, shelf=Shelf(), report=silent)
        assert (own == labels).all()
        assert timeless(alone) == timeless(result)
    shelf.turn_to("Vase")
    shelf.shape(models[0])
    assert len(loaded) == 3 + sum(1 + len(case.examples) for case in cases) + 1


def timeless(result):
    return replace(result, seconds=None, learning_seconds=None)


def test_only_so_many_shapes_are_kept(models, monkeypatch):
    monkeypatch.setattr(module, "_MOST_SHAPES", 2)
    shelf = Shelf()
    first, second = (shelf.shape(model) for model in models[:2])
    assert shelf.shape(models[0]) is first
    shelf.shape(models[2])
    assert shelf.shape(models[0]) is first
    assert shelf.shape(models[1]) is not second


def test_no_examples_are_the_reason(models, learner):
    case = case_of(models[:1], 0)
    result, labels, recipe = run_learned_case(case, shelf=Shelf(), report=silent)
    assert result.failure == "there is no other model of the category to learn from"
    assert labels is None
    assert recipe is None


def test_what_goes_wrong_is_the_reason(models, learner, monkeypatch):
    case = case_of(models, 0, learner="counted(height=3)")
    result, *_ = run_learned_case(case, shelf=Shelf(), report=silent)
    assert "height" in result.failure

    def broken(*args, **words):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(module, "segment_variants", broken)
    result, labels, recipe = run_learned_case(case_of(models, 0), shelf=Shelf(), report=silent)
    assert result.failure == "ZeroDivisionError: by nothing"
    assert labels is None
    assert recipe is not None


def test_numbers_are_right_where_they_are_the_same():
    labels, truth = np.array([0, 0, 1, 2]), np.array([0, 1, 1, 2])
    areas = np.array([1.0, 2.0, 3.0, 4.0])
    found = numbers_right(labels, ["rib2", "rib1", "toe"], truth, ["rib2", "rib1", "toe"], areas)
    assert found == pytest.approx(0.8)
    # A number on what people have not numbered does not matter; numbers that nobody bears neither.
    assert numbers_right(labels, ["a", "b", "toe4"], truth, ["c", "d", "toe"], areas) is None
    assert numbers_right(labels, ["a", "b", "toe4"], truth, ["c", "d", "toe", "x1"], areas) is None
    found = numbers_right(labels, ["a1", "a2", "toe4"], truth, ["a1", "a2", "toe"], areas)
    assert found == pytest.approx(0.8)


def test_what_has_no_true_name_does_not_count():
    labels, truth = np.array([0, 0, 1, 2]), np.array([0, -1, 1, 2])
    areas = np.array([1.0, 2.0, 3.0, 4.0])
    names = ["rib1", "rib2", "toe"]
    assert numbers_right(labels, names, truth, names, areas) == 1.0
    assert numbers_right(labels, names, np.array([-1, -1, -1, 2]), names, areas) is None
