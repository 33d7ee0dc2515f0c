"""The objective against the mean of its field, in expressions, and the promises that it makes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from moseg_learn.likely import likely

import moseg_core as moseg
from moseg_core import (
    Bundle,
    Component,
    ObjectiveSpec,
    Problem,
    ProblemEvaluator,
    Registry,
    Segmentation,
    UsageError,
    coarsen,
    field_values,
    registry,
)
from moseg_core.testing import cases_of, run_cases

LOOKS = {"head": {"width_within_30": 9, "constant": 6}, "handle": {}}


@pytest.fixture(scope="module")
def hammer():
    return moseg.load(moseg.sample_path("hammer"))


@pytest.fixture(scope="module")
def truth(hammer):
    return moseg.read_labels(moseg.sample_labels_path("hammer"), hammer.n_elements)


def problem(expression, given):
    return Problem(["head", "handle"], expression, given=given)


def test_mean_over_the_part(hammer, truth):
    values = field_values(hammer, "learn:unlikeliness", kind="head", among=LOOKS)
    for part, number in zip(
        Segmentation.from_labels(hammer, truth.labels, 2).parts, (0, 1), strict=True
    ):
        own = truth.labels == number
        mean = np.average(values[own], weights=hammer.areas[own])
        assert likely(part, kind="head", among=moseg.Table(LOOKS)) == pytest.approx(mean)


def test_a_problem_which_asks_the_vectorised_form_says_the_same(hammer, truth):
    for level in (hammer, coarsen(hammer, 500)):
        labels = np.arange(level.n_elements) % 2
        found = problem("likely(head, handle, kind=head, among=looks)", {"looks": LOOKS})
        values = [call.value for call in found.evaluate(level, labels).terms[0].calls]
        parts = Segmentation.from_labels(level, labels, 2).parts
        expected = [likely(part, kind="head", among=moseg.Table(LOOKS)) for part in parts]
        assert values == pytest.approx(expected, rel=1e-12)
        assert likely.traits.vectorized is not None


def test_it_says_of_which_field_it_is_the_mean():
    term = problem("2*likely(head, kind=head, among=looks)", {"looks": LOOKS}).terms[0]
    given = {"kind": "head", "among": moseg.Table(LOOKS)}
    assert term.averaged_field == ("learn:unlikeliness", given)


def test_the_same_of_super_elements(hammer, truth):
    coarse = coarsen(hammer, 500)
    labels = np.arange(coarse.n_elements) % 2
    for level, own in ((coarse, labels), (hammer, labels[coarse.members])):
        parts = Segmentation.from_labels(level, own, 2).parts
        assert likely(parts[0], kind="head", among=moseg.Table(LOOKS)) == pytest.approx(
            likely(
                Segmentation.from_labels(hammer, labels[coarse.members], 2).parts[0],
                kind="head",
                among=moseg.Table(LOOKS),
            )
        )


def test_in_an_expression_the_right_labels_cost_least(hammer, truth):
    asked = problem(
        "likely(head, kind=head, among=looks) + likely(handle, kind=handle, among=looks)",
        {"looks": LOOKS},
    )
    number = [["head", "handle"].index(name) for name in truth.names]
    right = np.array(number)[truth.labels]
    values = [asked.evaluate(hammer, labels).cost.value for labels in (right, 1 - right)]
    assert values[0] < 0.5 < 3 < values[1]


def test_a_refiner_moves_a_boundary_that_is_far_off_by_what_it_says_of_places(hammer, truth):
    asked = problem(
        "likely(head, kind=head, among=looks) + likely(handle, kind=handle, among=looks)",
        {"looks": LOOKS},
    )
    right = np.array([["head", "handle"].index(name) for name in truth.names])[truth.labels]
    x = hammer.points[:, 0]
    along = x[right == 1]
    start = np.where(x > along.max() - 0.3 * np.ptp(along), 0, right).astype(np.int32)
    voronoi = registry().find("parameterization", "voronoi").load()
    graph_cut = registry().find("refiner", "graph_cut").load()
    evaluator = ProblemEvaluator(hammer, asked, voronoi(hammer, 2))

    def wrong(labels):
        return hammer.areas[labels != right].sum() / hammer.area

    plain, told = (
        wrong(graph_cut(band=0.2, data=data)(evaluator, start, report=lambda progress: False))
        for data in (0.0, 3.0)
    )
    assert told < 0.1 < 0.13 < plain < wrong(start)


@pytest.mark.parametrize(
    ("call", "given", "message"),
    [
        ("likely(head, kind=hed, among=looks)", LOOKS, "'hed'; did you mean 'head'"),
        (
            "likely(head, kind=head, among=looks)",
            {"head": {"widht_within_30": 1}},
            "unknown quantity 'widht_within_30'; did you mean 'width_within_30'",
        ),
    ],
)
def test_a_table_that_does_not_fit_is_known_before_the_search(call, given, message):
    with pytest.raises(UsageError) as caught:
        _ = problem(call, {"looks": given}).fields
    assert message in str(caught.value)
    assert call in str(caught.value)


def test_traits():
    assert likely.traits.range == pytest.approx((0, math.log(1000)))
    assert likely.traits.requires == {"surface", "adjacency"}
    assert {p.name for p in likely.parameters if p.required} == {"kind", "among"}


def test_contract(monkeypatch, tmp_path):
    """Nobody can guess a table, so the kit tries the objective with one that is written here."""
    (tmp_path / "likely_body.py").write_text(
        "from moseg_core import Part, Table, objective\n"
        "from moseg_learn.likely import fields_of, likely\n"
        "from moseg_learn.looks import MOST\n"
        "_LOOKS = Table({'body': {'thickness': 2, 'area_within_8': 1, 'constant': 3}, 'leg': {}})\n"
        "@objective(range=(0, MOST), requires=likely.traits.requires,\n"
        "           invariant_to=likely.traits.invariant_to,\n"
        "           fields=fields_of({}), mean_of=lambda given: (\n"
        "               'learn:unlikeliness', {'kind': 'body', 'among': _LOOKS}))\n"
        "def body(part: Part) -> float:\n"
        "    return likely(part, kind='body', among=_LOOKS)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    spec = ObjectiveSpec(name="body", target="likely_body:body")
    mine = Bundle("mine", "mine", "1.0", "mine", (Component("mine", "mine 1.0", spec),))
    cases = cases_of("mine", source=Registry([*registry().bundles, mine]))
    outcomes = run_cases([case for case in cases if case.check.id.startswith("objective-")])
    assert [outcome for outcome in outcomes if outcome.status == "failed"] == []
    passed = {outcome.check for outcome in outcomes if outcome.status == "passed"}
    assert {
        "objective-returns",
        "objective-in-range",
        "objective-rigid",
        "objective-scale",
    } < passed
    assert {"objective-reflection", "objective-order", "objective-memo-equals-fresh"} < passed
    assert "objective-is-the-mean-it-says" in passed
