"""Where a run starts, what stays frozen, several starts, and being asked to stop."""

from __future__ import annotations

import numpy as np
import pytest

from moseg_core.components.protocols import Centers
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5))
PROBLEM = Problem(["stem", "bar"], "3*narrow(stem) + perpendicular(stem, bar)")


def test_a_run_goes_on_from_a_result():
    short = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=40)")
    longer = segment(SHAPE, PROBLEM, start=short)
    assert longer.cost <= short.cost
    assert longer.history["search"][0]["value"] == short.cost
    assert longer.history["seeding"] == ()
    again = segment(SHAPE, PROBLEM, start=longer.centers)
    assert again.cost <= longer.cost


def test_a_start_is_matched_by_label():
    other = Problem(["bar", "stem"], "3*narrow(stem) + perpendicular(stem, bar)")
    found = segment(SHAPE, PROBLEM)
    swapped = segment(SHAPE, other, start=found, optimizer="pattern_search(max_evaluations=1)")
    assert (swapped.labels == 1 - found.labels).all()
    assert swapped.cost == pytest.approx(found.cost, rel=1e-12)


def test_a_start_that_does_not_fit_is_refused():
    found = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
    with pytest.raises(UsageError, match="the start has the labels stem, bar; the problem has a"):
        segment(SHAPE, Problem(["a"], "narrow(a)"), start=found)
    with pytest.raises(UsageError, match="a centre and a weight for each of 2 labels"):
        segment(SHAPE, PROBLEM, start=Centers(positions=np.zeros((3, 3)), weights=np.ones(3)))


def test_frozen_labels_stay_where_they_are():
    begin = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
    found = segment(SHAPE, PROBLEM, start=begin, freeze=["bar"])
    assert found.centers.positions[1] == pytest.approx(begin.centers.positions[1], rel=1e-12)
    assert found.centers.weights[1] == begin.centers.weights[1]
    assert (found.centers.positions[0] != begin.centers.positions[0]).any()
    assert found.cost < begin.cost
    # A poll has 2 * 4 neighbours, not 2 * 8.
    evaluations = [record["evaluations"] for record in found.history["search"]]
    assert max(np.diff(evaluations)) == 8


def test_with_everything_frozen_the_start_is_the_result():
    begin = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
    found = segment(SHAPE, PROBLEM, start=begin, freeze=["bar", "stem"])
    assert (found.labels == begin.labels).all()
    assert (found.cost, found.reason) == (begin.cost, "converged")


def test_freezing_an_unknown_label_is_refused():
    with pytest.raises(UsageError, match="freeze: unknown label 'bat'; did you mean 'bar'"):
        segment(SHAPE, PROBLEM, freeze=["bat"])


def test_several_starts_keep_the_best():
    choice = "evolution(population=4, iterations=1)"
    single = segment(SHAPE, PROBLEM, seeder=choice, seed=5, restarts=1)
    several = segment(SHAPE, PROBLEM, seeder=choice, seed=5, restarts=4, finalists=4)
    costs = [record["value"] for record in several.history["restarts"]]
    assert len(costs) == 4
    assert costs[0] == single.cost
    assert len(set(costs)) > 1
    assert several.cost == min(costs)
    spread = (max(costs) - min(costs)) / min(costs)
    said = [text for text in several.warnings if "4 starts ended at costs from" in text]
    assert bool(said) == (spread > 0.05)


def test_several_starts_share_the_evaluations():
    found = segment(
        SHAPE,
        PROBLEM,
        seeder="evolution(population=4, iterations=1)",
        optimizer="pattern_search(max_evaluations=90)",
        restarts=3,
    )
    assert found.history["search"][-1]["evaluations"] == 30
    assert found.reason == "evaluations"


@pytest.mark.parametrize("restarts", [0, -2])
def test_there_is_at_least_one_start(restarts):
    with pytest.raises(UsageError, match="at least one start"):
        segment(SHAPE, PROBLEM, restarts=restarts)


@pytest.mark.parametrize("after", [1, 2, 6, 9])
def test_a_run_that_is_asked_to_stop_keeps_the_best_so_far(after):
    seen = []

    def stop_later(progress):
        seen.append(progress.stage)
        return len(seen) == after

    found = segment(
        SHAPE,
        PROBLEM,
        seeder="evolution(population=6, iterations=4)",
        restarts=3,
        report=stop_later,
    )
    assert found.reason == "interrupted"
    assert "interrupted" in found.warnings[0]
    # Each stage that was under way ends at its next report, and no new start begins.
    assert len(seen) <= after + 1
    assert found.cost == PROBLEM.evaluate(SHAPE, found.labels).cost.value


# --- several centres for a label -----------------------------------------------------------------

TWO_BARS = 'voronoi(centers="bar=2")'


def test_a_search_with_more_centres_goes_on_from_a_result_with_one_each():
    single = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
    found = segment(SHAPE, PROBLEM, start=single, parameterization=TWO_BARS)
    assert found.history["search"][0]["value"] == single.cost
    assert found.cost < single.cost
    assert found.centers.parts.tolist() == [0, 1, 1]
    assert found.dimension == (12, 12)
    assert found.method["parameterization"] == 'core:voronoi(centers="bar=2")'
    assert all(part.n_components == 1 for part in found.segmentation.parts)

    other = Problem(["bar", "stem"], "3*narrow(stem) + perpendicular(stem, bar)")
    again = segment(
        *(SHAPE, other),
        start=found,
        parameterization=TWO_BARS,
        freeze=["bar"],
        optimizer="pattern_search(max_evaluations=30)",
    )
    assert again.history["search"][0]["value"] == pytest.approx(found.cost, rel=1e-12)
    assert again.centers.parts.tolist() == [0, 0, 1]
    assert again.centers.positions[:2] == pytest.approx(found.centers.positions[1:], rel=1e-12)
    assert again.centers.weights[:2].tolist() == found.centers.weights[1:].tolist()


@pytest.mark.parametrize("centers", ["", "stem=2", "bar=3"])
def test_a_start_with_other_numbers_of_centres_is_refused(centers):
    start = Centers(positions=SHAPE.points[:3], weights=np.ones(3), parts=np.array([0, 1, 1]))
    with pytest.raises(
        UsageError, match=r"the start has . centres for label '(stem|bar)', and .*"
    ) as e:
        segment(
            SHAPE, PROBLEM, start=start, parameterization={"name": "voronoi", "centers": centers}
        )
    assert """give as many, such as --parameterization 'voronoi(centers="bar=2")'""" in str(e.value)


@pytest.mark.parametrize("parts", [[0, 0, 0], [0, 1, 2], [0.0, 1.0, 1.0], [-1, 0, 1]])
def test_a_start_says_whose_its_centres_are(parts):
    start = Centers(positions=SHAPE.points[:3], weights=np.ones(3), parts=np.array(parts))
    with pytest.raises(UsageError, match="which of 2 labels it belongs to"):
        segment(SHAPE, PROBLEM, start=start, parameterization=TWO_BARS)


def test_an_unknown_label_is_named():
    with pytest.raises(UsageError, match="centers: unknown label 'bra'; did you mean 'bar'"):
        segment(SHAPE, PROBLEM, parameterization='voronoi(centers="bra=2")')
