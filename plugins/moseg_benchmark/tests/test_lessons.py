"""Which models recipes are learned from, and the cases that come of it."""

from __future__ import annotations

import pytest
from moseg_benchmark.lessons import (
    LearnedCase,
    LearnedResult,
    Lessons,
    following,
    learned_cases,
)
from moseg_benchmark.psb import find_models


@pytest.fixture(scope="module")
def models(members):
    return find_models(members)


def numbers(models):
    return [model.number for model in models]


def test_examples_follow_in_cyclic_order_and_only_those_that_teach(models):
    assert numbers(following(models[0], 0, models)) == [22, 23, 24]
    assert numbers(following(models[2], 2, models)) == [24, 21, 22]
    assert numbers(following(models[5], 5, models)) == [21, 22, 23, 24]
    # Of another collection from the model's place on, and never the model itself.
    assert numbers(following(models[4], 1, models[:4])) == [22, 23, 24, 21]
    assert following(models[0], 0, models[:1]) == []


def test_each_number_of_examples_has_its_cases(models):
    batches = learned_cases(models, Lessons(examples=(1, None)), [0, 3])
    assert len(batches) == 2 * len(models)
    first, last = batches[0], batches[-1]
    assert [(case.method, case.seed, numbers(case.examples)) for case in first] == [
        ("learned 1", 0, [22]),
        ("learned 1", 3, [22]),
    ]
    assert [(case.method, numbers(case.examples)) for case in last] == [
        ("learned", [21, 22, 23, 24])
    ] * 2
    assert len({case.key for batch in batches for case in batch}) == 4 * len(models)


def test_the_longest_lesson_is_that_of_most_examples():
    assert Lessons(examples=(1, 4, 2)).longest == "learned 4"
    assert Lessons(examples=(1, None, 2)).longest == "learned"


def test_one_collection_teaches_and_another_is_searched(models):
    batches = learned_cases(models[3:], Lessons(examples=(2,), teachers=tuple(models[:3])), [0])
    assert [numbers(case.examples) for (case,) in batches] == [[21, 22], [22, 23], [23, 21]]


def test_where_there_are_fewer_examples_all_are_taken(models):
    assert numbers(learned_cases(models, Lessons(examples=(5,)), [0])[0][0].examples) == [
        22,
        23,
        24,
    ]


def test_results_come_back_from_plain_data(models):
    result = LearnedResult(model=21, category="Cup", method="learned 1", examples=1, own_cost=2.0)
    case = LearnedCase(model=models[0], method="learned 1", examples=())
    assert case.read_result({**vars(result), "people": []}) == result
