"""Results summed up, against numbers by hand."""

import pytest
from moseg_benchmark.cases import CaseResult
from moseg_benchmark.tables import agreement_table, cost_table, failures, verdict

RESULTS = [
    CaseResult(model=21, category="Cup", method="people", rand_index_error=0.1),
    CaseResult(model=25, category="Cup", method="people", rand_index_error=0.3),
    CaseResult(model=381, category="Fourleg", method="people", rand_index_error=0.5),
    CaseResult(
        model=381,
        category="Fourleg",
        method="default",
        recipe="paper_horse",
        rand_index_error=0.2,
        named_right=0.5,
        seconds=10.0,
        cost=6.0,
    ),
    CaseResult(
        model=381,
        category="Fourleg",
        method="default",
        recipe="paper_horse",
        seed=1,
        rand_index_error=0.4,
        named_right=0.7,
        seconds=20.0,
        cost=5.0,
    ),
    CaseResult(
        model=381,
        category="Fourleg",
        method="default",
        recipe="paper_horse",
        seed=2,
        failure="no disk",
    ),
    CaseResult(
        model=381,
        category="Fourleg",
        method="costs",
        recipe="paper_horse",
        cost=8.0,
        people=(4.5, 7.0),
        incomplete=3,
    ),
]


def test_means_are_over_models_then_over_categories():
    table = agreement_table(RESULTS, ["Cup", "Fourleg"])
    assert table.heads[:4] == ["category", "models", "people", "default"]
    assert table.rows[0] == ["Cup", "2", "0.200", "", "", "", ""]
    assert table.rows[1] == ["Fourleg", "1", "0.500", "0.300", "60.0%", "15.0", "1 of 3"]
    assert table.rows[2] == ["mean", "3", "0.350", "0.300", "60.0%", "15.0", ""]


def test_one_category_needs_no_mean():
    assert len(agreement_table(RESULTS, ["Cup"]).rows) == 1


def test_costs_of_people_are_beside_the_cost_found():
    table = cost_table(RESULTS)
    assert table.rows == [
        [
            *("Fourleg", "paper_horse", "381", "8", "4.5 to 7 (2), 3 lack a part", "1"),
            *("5.5 (5 to 6)", "both"),
        ]
    ]


@pytest.mark.parametrize(
    ("named", "people", "found", "expected"),
    [
        (8.0, (7.0, 9.0), 6.0, "recipe"),
        (8.0, (), 9.0, "search"),
        (8.0, (10.0,), 9.0, "both"),
        (None, (10.0,), 9.0, "recipe"),
        (None, (), 9.0, ""),
        (8.0, (), None, ""),
    ],
)
def test_verdicts(named, people, found, expected):
    assert verdict(named, people, found) == expected


def test_failures_say_where_and_why():
    assert failures(RESULTS) == ["Fourleg 381, default, seed 2: no disk"]
