"""The steps after the search: taken with the result that is wanted in the end, and no other."""

from __future__ import annotations

import time
from itertools import product

import numpy as np
import pytest

from moseg_core.components.protocols import Progress
from moseg_core.errors import PluginError, ShapeError
from moseg_core.problem.statement import Statement
from moseg_core.search import last_steps as module
from moseg_core.search.variants import segment_variants, tried_sets
from moseg_core.shape.shape import Shape
from tests.shapes import solid

QUICK = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=60)", "restarts": 1}
BOXES = Statement(labels=("box{2..4}",), minimize="compact(box*) + 3*convex(box*)")


def row() -> Shape:
    """Three boxes of 3 by 3 by 3 cubes in a row, joined by bars of one cube."""
    cells = []
    for k in range(3):
        cells += [(4 * k + x, y, z) for x, y, z in product(range(3), (-1, 0, 1), (-1, 0, 1))]
        cells += [(4 * k + 3, 0, 0)] if k < 2 else []
    return Shape.from_mesh(*solid(cells), name="row")


seen: list[tuple[str, int]] = []


class Widening:
    """A refiner that gives the first part what touches it, and remembers what it was asked."""

    def __init__(self, *, broken: bool = False, picky: bool = False) -> None:
        self.broken, self.picky = broken, picky

    def check(self, evaluator):
        seen.append(("check", len(evaluator.problem.labels)))
        if self.picky:
            raise ShapeError("it likes other shapes better")
        return "it goes by ear"

    def __call__(self, evaluator, labels, *, report):
        seen.append(("refine", len(evaluator.problem.labels)))
        report(Progress(stage="widen", done=1))
        if self.broken:
            raise RuntimeError("it is broken")
        pairs = evaluator.shape.adjacency.pairs
        moved = labels.copy()
        moved[pairs[(labels[pairs] == 0).any(axis=1)]] = 0
        return moved


def picky():
    return Widening(picky=True)


def broken():
    return Widening(broken=True)


@pytest.fixture(autouse=True)
def anew():
    seen.clear()


@pytest.mark.parametrize("workers", [1, 2])
def test_of_label_sets_the_one_that_is_chosen_is_refined(workers):
    plain = segment_variants(row(), BOXES, workers=workers, **QUICK)
    found = segment_variants(row(), BOXES, workers=workers, refiner=Widening, **QUICK)
    assert seen == [("check", 2), ("check", 3), ("check", 4), ("refine", 3)]
    assert len(found.parts) == 3
    assert found.refined
    before, after = found.history["refine"]
    assert before["value"] == plain.cost
    assert after["value"] == found.cost == found.problem.evaluate(row(), found.labels).cost.value
    assert after["moved"] == (found.labels != plain.labels).sum() > 0
    assert tried_sets(found.history) == tried_sets(plain.history)
    assert "it goes by ear" in found.warnings
    assert found.centers.positions.tolist() == plain.centers.positions.tolist()
    assert found.incumbents[-1].cost.value == pytest.approx(found.cost, rel=1e-5)


def test_labels_are_exchanged_once_more_where_the_refiner_has_called_for_it():
    def turned(evaluator, labels, *, report):
        return np.roll(np.arange(3, dtype=np.int32), 1)[labels]

    stated = Statement(
        labels=("one", "two", "three{0..1}"),
        minimize="is(one, area=0.6+-0.1) + is(two, area=0.3+-0.1) + is(three*, area=0.1+-0.1)",
    )
    plain = segment_variants(row(), stated, **QUICK)
    found = segment_variants(row(), stated, refiner=lambda: turned, **QUICK)
    assert plain.cost < found.history["refine"][1]["value"]
    assert found.labels.tolist() == plain.labels.tolist()
    assert found.centers.positions.tolist() != plain.centers.positions.tolist()


def test_a_refiner_that_cannot_work_on_the_shape_says_so_before_the_search():
    def search(progress):
        raise AssertionError("it began")

    with pytest.raises(ShapeError, match="it likes other shapes better"):
        segment_variants(row(), BOXES, refiner=picky, report=search, **QUICK)


def test_a_refiner_that_fails_leaves_the_choice_that_was_made():
    plain = segment_variants(row(), BOXES, **QUICK)
    with pytest.raises(PluginError, match="RuntimeError: it is broken") as caught:
        segment_variants(row(), BOXES, refiner=broken, **QUICK)
    found = caught.value.result
    assert found.labels.tolist() == plain.labels.tolist()
    assert found.reason == "failed"
    assert "the run failed; this is the best that it had found" in found.warnings
    assert any(text.startswith("the boundaries are not refined: ") for text in found.warnings)
    assert tried_sets(found.history) == tried_sets(plain.history)


def test_an_exchange_that_fails_is_an_error_with_the_result_that_was_found(monkeypatch):
    def failing(*arguments, **more):
        raise PluginError("a term has failed")

    plain = segment_variants(row(), BOXES, **QUICK)
    monkeypatch.setattr(module, "best_order", failing)
    with pytest.raises(PluginError, match="a term has failed") as caught:
        segment_variants(row(), BOXES, **QUICK)
    assert caught.value.result.labels.tolist() == plain.labels.tolist()
    assert caught.value.result.reason == "failed"


def test_seconds_count_from_before_the_refiner_is_checked(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])

    class Slow(Widening):
        def check(self, evaluator):
            clock[0] += 100.0  # as fields of a large shape may take
            return super().check(evaluator)

    found = segment_variants(row(), BOXES, refiner=Slow, max_seconds=60, **QUICK)
    assert found.reason == "seconds"


def test_whoever_has_stopped_the_search_has_no_boundaries_refined():
    found = segment_variants(row(), BOXES, refiner=Widening, report=lambda progress: True, **QUICK)
    assert ("refine", 2) not in seen
    assert found.reason == "interrupted"
    assert found.warnings.count("the run was interrupted; this is the best that it had found") == 1
    assert "the boundaries are not refined, since the run was interrupted" in found.warnings
