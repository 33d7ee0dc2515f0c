from __future__ import annotations

import numpy as np
import pytest
from moseg_learn import left_out
from moseg_learn.left_out import LeftOut, cost_of, leave_one_out
from moseg_learn.pieces import pieces_of

from moseg_core import Example, Recipe, Statement, UsageError, learn


def test_each_is_left_out_in_turn_and_shown(herd, monkeypatch):
    def tried(example, recipe, numbers, seed, report):
        return LeftOut(name=f"{example.shape.name} by {len(recipe.learned_from)}", cost=float(seed))

    monkeypatch.setattr(left_out, "_tried", tried)
    shown = []
    found = leave_one_out(
        herd,
        learner="profiles(likely=0)",
        seed=3,
        show=lambda done, result: shown.append((done, result.name)),
    )
    assert [(each.name, each.cost) for each in found] == [
        ("one by 2", 3.0),
        ("two by 2", 3.0),
        ("three by 2", 3.0),
    ]
    assert [done for done, _ in shown] == [1, 2, 3]


def test_one_example_leaves_nothing_to_learn_from(herd):
    with pytest.raises(UsageError, match="two or more"):
        leave_one_out(herd[:1], learner="profiles", show=lambda done, result: None)


def test_own_parts_cost_what_the_problem_says(herd):
    recipe = learn(herd, learner="profiles(likely=0)")
    few, many = pieces_of(herd[0]), pieces_of(herd[2])
    task = next(task for task in recipe.hierarchies() if "tail" not in task.labels)
    assert task.labels == ("body", "head", "leg1", "leg2", "leg3")
    assert few.kinds == ("body", "head", "leg", "leg", "leg")
    assert cost_of(few, recipe) == task.evaluate(few.shape, few.labels).cost.value
    other = next(task for task in recipe.hierarchies() if "tail" in task.labels)
    assert cost_of(many, recipe) == other.evaluate(many.shape, many.labels).cost.value


def test_parts_that_a_recipe_has_no_label_for_are_named(make):
    recipe = Recipe(
        name="short", statement=Statement(labels=("body", "head", "leg1"), minimize="convex_parts")
    )
    with pytest.raises(UsageError, match="too few for leg"):
        cost_of(pieces_of(make.beast()), recipe)


def test_a_search_is_measured_against_the_example(herd, make):
    said = "is(body, area=0.5+-0.1) + is(head, area=0.1+-0.1) + is(leg*, area=0.1+-0.1)"
    recipe = Recipe(
        name="rough",
        statement=Statement.read(
            {
                "labels": ["body", "head", "leg1", "leg2", "leg3"],
                "minimize": said,
                "seeder": "kmeans",
                "optimizer": "pattern_search(max_evaluations=5)",
                "restarts": 1,
                "resolution": 200,
            }
        ),
    )
    found = left_out._tried(herd[0], recipe, "alike", 0, lambda progress: False)
    assert (found.name, found.failure) == ("one", "")
    assert 0 < found.rand_index_error < 0.5
    assert 0.2 < found.named_right < 1
    assert found.cost > 0
    assert found.own_cost == cost_of(pieces_of(herd[0]), recipe)


def test_own_parts_cost_what_they_do_with_the_nearest_label_where_there_is_none(herd):
    recipe = learn(herd, learner="profiles(likely=0)")
    example = herd[0]
    partly = np.where(np.arange(len(example.labels)) % 50 == 7, -1, example.labels)
    some = pieces_of(Example(example.shape, partly, example.names))
    assert cost_of(some, recipe) == pytest.approx(cost_of(pieces_of(example), recipe), rel=0.2)
