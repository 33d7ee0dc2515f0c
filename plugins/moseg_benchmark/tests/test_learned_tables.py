"""Results of learned recipes summed up, against numbers by hand."""

from __future__ import annotations

from moseg_benchmark.cases import CaseResult
from moseg_benchmark.learned_tables import (
    all_tables,
    choice_table,
    excess,
    found_table,
    learned_tables,
    means_table,
    missed_table,
    wrong_choice_table,
)
from moseg_benchmark.lessons import LearnedResult

TWO, ONE = "one, 2 two", "one, two"


def learned(model, *, n=1, seed=0, category="Cup", **values):
    values = {"label_set": TWO, "own_label_set": TWO, "offered": True, **values}
    method = f"learned {n}"
    return LearnedResult(
        model=model, category=category, method=method, seed=seed, examples=n, recipe="r", **values
    )


RESULTS = [
    CaseResult(model=21, category="Cup", method="people", rand_index_error=0.1),
    CaseResult(model=22, category="Cup", method="people", rand_index_error=0.3),
    learned(21, rand_index_error=0.2, named_right=0.5, seconds=4.0, cost=2.0, own_cost=1.0),
    learned(
        *(21,), seed=1, rand_index_error=0.4, named_right=0.7, seconds=6.0, cost=3.0, own_cost=1.0
    ),
    learned(21, seed=2, rand_index_error=0.6, cost=0.5, own_cost=1.0, learning_seconds=3.0),
    learned(22, rand_index_error=0.2, cost=0.5, own_cost=1.0, label_set=ONE),
    learned(22, seed=1, label_set="", own_label_set="", failure="no disk"),
    learned(
        22, n=2, rand_index_error=0.1, cost=0.5, own_cost=1.0, own_label_set=ONE, offered=False
    ),
    learned(381, category="Fourleg", rand_index_error=0.1, cost=0.5, own_cost=0.4),
]
CATEGORIES = ["Cup", "Fourleg"]


def test_means_are_over_seeds_then_models_then_categories():
    table = means_table("t", RESULTS, CATEGORIES, lambda result: result.rand_index_error, ".3f")
    assert table.heads == ["category", "models", "people", "learned 1", "learned 2"]
    assert table.rows == [
        ["Cup", "2", "0.200", "0.300 (1 failed)", "0.100"],
        ["Fourleg", "1", "", "0.100", ""],
        ["mean", "3", "0.200", "0.200", "0.100"],
    ]


def test_the_middle_seed_says_whether_parts_were_missed():
    own = [result for result in RESULTS if result.model == 21 and result.method == "learned 1"]
    assert excess(own) == 1.0
    assert excess(own[2:]) == -0.5
    moved = learned(21, cost=2.0, search_cost=0.75, own_cost=1.0)
    assert excess([moved]) == -0.25
    # Nothing was found with the labels of the model.
    assert excess([result for result in RESULTS if result.model == 22][1:]) is None
    learnt = [result for result in RESULTS if isinstance(result, LearnedResult)]
    assert found_table(learnt, CATEGORIES).rows == [
        ["Cup", "1 of 1", ""],
        ["Fourleg", "1 of 1", ""],
        ["all", "2 of 2", "0 of 0"],
    ]
    assert missed_table(learnt).rows == [
        ["Cup", "21", "learned 1", "1", "2, 3, 0.5"],
        ["Fourleg", "381", "learned 1", "0.4", "0.5"],
    ]


def test_choices_are_counted_where_models_differ():
    learnt = [result for result in RESULTS if isinstance(result, LearnedResult)]
    table = choice_table(learnt, CATEGORIES)
    assert table.heads[2:] == ["label sets", "right", "wrong", "not in the recipe"]
    assert table.rows == [
        ["Cup", "learned 1", "2", "3", "1", "0"],
        ["Cup", "learned 2", "2", "0", "0", "1"],
    ]
    assert wrong_choice_table(learnt).rows == [["Cup", "22", "learned 1", TWO, ONE, "1"]]
    other = learned(385, category="Fourleg", own_label_set=ONE, label_set=ONE)
    assert choice_table([*learnt, other], CATEGORIES).rows[2:] == [
        ["Fourleg", "learned 1", "2", "2", "0", "0"],
        ["all", "learned 1", "", "5", "1", "0"],
        ["all", "learned 2", "", "0", "0", "1"],
    ]


def test_tables_with_nothing_to_say_are_left_out():
    titles = [table.title for table in learned_tables(RESULTS, CATEGORIES)]
    assert "Area named right, with numbers" not in titles
    assert "Area named right" in titles
    assert titles == [table.title for table in all_tables(RESULTS, CATEGORIES)]
    assert learned_tables(RESULTS[:2], CATEGORIES) == []
    (people,) = all_tables(RESULTS[:2], CATEGORIES)
    assert people.rows == [["Cup", "2", "0.200"]]


def test_recipes_by_hand_keep_their_own_tables():
    by_hand = CaseResult(
        model=21, category="Cup", method="default", recipe="cup", rand_index_error=0.25, seconds=1.0
    )
    tables = all_tables([*RESULTS, by_hand], CATEGORIES)
    assert "default" in tables[0].heads
    assert tables[-1].rows == [["Cup", "2", "0.200", "0.250", "", "1.0", ""]]
