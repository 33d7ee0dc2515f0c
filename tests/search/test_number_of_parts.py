"""Any number of parts: which are tried, which is taken, and how its labels are numbered."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from moseg_core.components.chosen import Choice
from moseg_core.components.protocols import Progress
from moseg_core.components.segmentation import Segmentation
from moseg_core.errors import MosegError, PluginError, ShapeError, UsageError
from moseg_core.io import read_result, save
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.recipe import Recipe, load_recipe
from moseg_core.problem.settings import SearchOptions
from moseg_core.problem.statement import Statement
from moseg_core.search import number_of_parts as module
from moseg_core.search.levels import solve_hierarchy
from moseg_core.search.number_of_parts import (
    ANY_SHAPE,
    MOST,
    TRIED,
    numbered_by_size,
    numbers_to_try,
    read_number,
    segment_parts,
    solve_parts,
)
from moseg_core.search.result import find_warnings
from moseg_core.shape.shape import Shape
from tests.shapes import solid, strip

# Beads on a string, each larger than the one before: of 3, 5, 7 and 9 cubes a side.
SIDES = (3, 5, 7, 9)


def beads(sides=SIDES) -> tuple[Shape, np.ndarray]:
    """Solid cubes in a row, joined by bars of one cube; which of them each face is nearest to."""
    cells, middles, at = [], [], 0
    for side in sides:
        half = side // 2
        cells += [
            (at + x, y, z)
            for x in range(side)
            for y in range(-half, half + 1)
            for z in range(-half, half + 1)
        ]
        middles.append(at + side / 2)
        cells += [(at + side, 0, 0)] if side != sides[-1] else []
        at += side + 1
    shape = Shape.from_mesh(*solid(cells), name="beads")
    ends = np.cumsum([side + 1 for side in sides]) - 0.5
    return shape, np.searchsorted(ends, shape.points[:, 0])


QUICK = {"seeder": "kmeans", "optimizer": "pattern_search(max_evaluations=40)", "restarts": 1}


def recipe(labels=("part*",), minimize="compact(part*)", **more) -> Recipe:
    return Recipe(name="mine", statement=Statement(labels=labels, minimize=minimize, **more))


# --- numbers


def test_a_number_or_auto():
    assert [read_number(given) for given in (5, "5", np.int64(7), "auto")] == [5, 5, 7, None]


@pytest.mark.parametrize("given", ["nine", "", "2.5", 2.5, 0, "0", -3, True, None, "Auto"])
def test_other_numbers_are_refused(given):
    with pytest.raises(UsageError, match=r"a number from 1 on or 'auto', not"):
        read_number(given)


def test_numbers_from_two_to_the_most_are_tried():
    stated = recipe().statement
    assert numbers_to_try(stated, "auto") == list(range(2, MOST + 1))
    assert numbers_to_try(stated, 1) == [1]
    three = replace(stated, labels=("a", "b", "part*"))
    assert numbers_to_try(three, "auto")[0] == 3
    many = replace(stated, labels=(*(f"a{k}" for k in range(MOST + 2)), "part*"))
    assert numbers_to_try(many, "auto") == [MOST + 3]
    with pytest.raises(UsageError, match="2 parts are too few"):
        numbers_to_try(three, 2)


@pytest.mark.parametrize("given", [2, 3, "auto"])
def test_a_recipe_of_fixed_parts_is_refused(given, box):
    with pytest.raises(UsageError, match="the number of parts is fixed by the labels handle, head"):
        segment_parts(box, given, recipe="hammer")


# --- one number


@pytest.mark.parametrize("n_parts", [1, 2, 3, 4])
def test_as_many_parts_as_are_asked_for_from_large_to_small(n_parts):
    shape, _ = beads()
    result = segment_parts(shape, n_parts, **QUICK)
    assert list(result.parts) == [f"part{k + 1}" for k in range(n_parts)]
    areas = [part.area for part in result.parts.values()]
    assert areas == sorted(areas, reverse=True)
    assert areas[-1] > 0
    assert TRIED not in result.history
    assert result.problem.statement.minimize == load_recipe(ANY_SHAPE).minimize


def test_a_number_renumbers_what_segment_finds():
    shape, _ = beads()
    stated = load_recipe(ANY_SHAPE).statement
    options = SearchOptions.of({**QUICK})
    plain = solve_hierarchy(shape, Hierarchy.of(stated.with_parts(4)), options)
    found = segment_parts(shape, 4, **QUICK)
    assert found.cost == pytest.approx(plain.cost, rel=1e-12)
    pairs = set(zip(plain.labels.tolist(), found.labels.tolist(), strict=True))
    assert len(pairs) == 4
    places = dict(pairs)
    for before, after in places.items():
        for name in ("positions", "weights"):
            assert getattr(found.centers, name)[after] == pytest.approx(
                getattr(plain.centers, name)[before]
            )
    # Cost, parts and centres are those of the labels.
    assert found.problem.evaluate(shape, found.labels) == found.evaluation


def test_what_was_found_is_written_and_gone_on_from(tmp_path):
    shape, _ = beads()
    found = segment_parts(shape, 3, **QUICK)
    save(found, tmp_path / "beads.json")
    saved = read_result(tmp_path / "beads.json")
    assert saved.names == ("part1", "part2", "part3")
    assert saved.statement == found.problem.statement
    again = solve_hierarchy(
        shape, Hierarchy.of(saved.statement), SearchOptions.of({**QUICK}), start=found
    )
    assert again.cost <= found.cost + 1e-12


# --- numbers of labels


def solved(stated: Statement, count: int, shape: Shape, **options):
    """A result that is not numbered yet."""
    task = Hierarchy.of(stated.with_parts(count))
    return solve_hierarchy(shape, task, SearchOptions.of({**QUICK, **options}))


def backwards(result):
    """The same with the numbers from the smallest part to the largest."""
    order = np.argsort([part.area for part in result.parts.values()], kind="stable")
    rank = np.argsort(order).astype(np.int32)
    labels = rank[result.labels]
    evaluation = result.problem.evaluate(result.shape, labels)
    segmentation = Segmentation.from_labels(result.shape, labels, len(order))
    return replace(
        result,
        labels=labels,
        centers=result.centers.ordered(order),
        evaluation=evaluation,
        warnings=(
            *find_warnings(evaluation, segmentation, result.problem.labels, result.reason),
            "something else",
        ),
    )


def test_numbers_go_by_size_and_come_out_the_same_whatever_they_were():
    shape, _ = beads()
    stated = recipe().statement
    given = backwards(solved(stated, 4, shape))
    found = numbered_by_size(given, stated)
    assert found.labels.tolist() == (3 - given.labels).tolist()
    assert found.centers.positions.tolist() == given.centers.positions[::-1].tolist()
    assert numbered_by_size(found, stated).labels.tolist() == found.labels.tolist()


def test_warnings_speak_of_the_new_numbers():
    shape, which = beads((9, 3))
    labels = (which == 1).astype(np.int32)  # the small bead is part2
    labels[np.flatnonzero(which == 1)[0]] = 0  # and the large one in two pieces
    stated = recipe().statement
    result = solved(stated, 2, shape)
    problem = result.problem
    evaluation = problem.evaluate(shape, 1 - labels)
    told = find_warnings(
        evaluation, Segmentation.from_labels(shape, 1 - labels, 2), problem.labels, "converged"
    )
    assert "part 'part2' is in 2 pieces" in told
    given = replace(
        result,
        labels=1 - labels,
        evaluation=evaluation,
        reason="converged",
        warnings=(*told, "something else"),
    )
    found = numbered_by_size(given, stated)
    assert "part 'part1' is in 2 pieces" in found.warnings
    assert not any("part2" in warning for warning in found.warnings)
    assert found.warnings[-1] == "something else"


def test_fixed_labels_keep_their_names():
    shape, which = beads()
    stated = recipe(("first", "part*", "last"), "compact(*)").statement
    result = solved(stated, 4, shape)
    labels = np.array([0, 1, 2, 3])[which].astype(np.int32)
    given = replace(
        result, labels=labels, evaluation=result.problem.evaluate(shape, labels), warnings=()
    )
    found = numbered_by_size(given, stated)
    assert found.problem.labels == ("first", "part1", "part2", "last")
    assert found.labels.tolist() == np.array([0, 2, 1, 3])[which].tolist()


def test_labels_that_the_cost_tells_apart_keep_their_numbers():
    shape, which = beads()
    stated = recipe(minimize="area_fraction(part1, max=0.1) + compact(part*)").statement
    result = solved(stated, 4, shape)
    given = replace(
        result,
        labels=which.astype(np.int32),
        evaluation=result.problem.evaluate(shape, which),
        warnings=(),
    )
    assert numbered_by_size(given, stated) is given


def test_labels_that_constraints_tell_apart_keep_their_numbers():
    shape, _ = beads((5, 7, 9))
    stated = recipe(constraints=("on_plane(part1)",), plane="y").statement
    given = backwards(solved(stated, 3, shape))
    assert numbered_by_size(given, stated) is given


def test_a_part_of_several_centres_keeps_them():
    shape, _ = beads()
    chosen = Choice("voronoi", {"centers": "part1=2"})
    found = segment_parts(shape, 4, recipe=recipe(), parameterization=chosen, **QUICK)
    assert found.centers.per_part.tolist() == [2, 1, 1, 1]
    areas = [part.area for part in found.parts.values()]
    assert areas[1:] == sorted(areas[1:], reverse=True)
    assert "centers" in found.method["parameterization"]


def test_parts_that_are_divided_keep_their_numbers():
    shape, _ = beads((5, 9))
    inner = Statement(labels=("a", "b"), minimize="compact(a)")
    task = recipe(parts=(("part*", inner),))
    found = segment_parts(shape, 2, recipe=task, **QUICK)
    assert list(found.parts) == ["part1/a", "part1/b", "part2/a", "part2/b"]
    assert numbered_by_size(found, task.statement) is found


def test_parts_that_were_to_be_divided_keep_their_numbers_too():
    shape = Shape.from_mesh(*strip(7))
    inner = Statement(labels=tuple("abcdefgh"), minimize="narrow(a)")
    stated = recipe(minimize="narrow(part*)", parts=(("part*", inner),)).statement
    whole = solved(stated, 2, shape)
    assert whole.problem.labels == ("part1", "part2")
    assert any("part 'part1' is left whole" in warning for warning in whole.warnings)
    for given in (whole, replace(whole, labels=1 - whole.labels)):
        assert numbered_by_size(given, stated) is given


def test_an_empty_part_comes_last():
    shape, which = beads((5, 7, 9))
    stated = recipe().statement
    result = solved(stated, 4, shape)
    labels = (which + 1).astype(np.int32)
    given = replace(
        result, labels=labels, evaluation=result.problem.evaluate(shape, labels), warnings=()
    )
    found = numbered_by_size(given, stated)
    assert np.bincount(found.labels, minlength=4)[-1] == 0
    assert "part 'part4' is empty; terms about it are left out of the cost" in found.warnings


# --- auto


@pytest.fixture
def at_most_five(monkeypatch):
    monkeypatch.setattr(module, "MOST", 5)


@pytest.mark.usefixtures("at_most_five")
@pytest.mark.parametrize("sides", [(5, 5), (5, 5, 5), (5, 7, 5, 7)])
def test_beads_are_counted(sides):
    shape, which = beads(sides)
    reports = []
    result = segment_parts(shape, report=reports.append, seeder="kmeans", restarts=1)
    assert len(result.parts) == len(sides)
    tried = result.history[TRIED]
    assert [record["parts"] for record in tried] == [2, 3, 4, 5]
    assert {report.place for report in reports} == {f"number {k} of 4" for k in range(1, 5)}
    assert min(record["cost"] for record in tried) == pytest.approx(result.cost, rel=1e-9)
    assert all(record["empty"] == 0 for record in tried)
    # Each bead is one part, but for the bars between them.
    for bead in range(len(sides)):
        counts = np.bincount(result.labels[which == bead])
        assert counts.max() > 0.9 * counts.sum()
    stages = dict.fromkeys(progress.stage for progress in reports)
    assert {stage.partition(": ")[0] for stage in stages} == {f"{n} parts" for n in (2, 3, 4, 5)}
    assert "4 parts: pattern_search" in stages


def fake(monkeypatch, answers):
    """In place of searches: for each number of parts a function of result and report."""
    shape, _ = beads((3, 3))
    asked = []

    def solve(shape, task, options, *, report):
        count = len(task.problem.labels)
        asked.append((count, options))
        labels = (np.arange(shape.n_elements) % count).astype(np.int32)
        result = replace(
            base, problem=task.problem, labels=labels, warnings=("of its own",), reason="converged"
        )
        return answers(count, result, report)

    base = solved(recipe(minimize="0.001*compact(part*)").statement, 2, shape)
    monkeypatch.setattr(module, "solve_hierarchy", solve)
    monkeypatch.setattr(module, "numbered_by_size", lambda result, statement: result)
    return shape, asked


def costing(result, value, empty=0):
    evaluation = result.evaluation
    return replace(result, evaluation=replace(evaluation, cost=type(evaluation.cost)(empty, value)))


def test_the_least_cost_is_taken_and_an_empty_part_is_worse(monkeypatch):
    costs = {n: (0, 1.0 / n) for n in range(2, MOST + 1)} | {4: (0, 0.01), 5: (1, 0.001)}
    shape, asked = fake(monkeypatch, lambda n, result, report: costing(result, *costs[n][::-1]))
    result = segment_parts(shape, recipe=recipe())
    assert [n for n, _ in asked] == list(range(2, MOST + 1))
    assert len(result.parts) == 4
    assert result.history[TRIED][3] == {"parts": 5, "cost": 0.001, "empty": 1}
    assert (result.reason, result.warnings) == ("converged", ("of its own",))


def test_whoever_stops_has_the_best_by_then(monkeypatch):
    def answer(n, result, report):
        stopped = report(Progress(stage="search", done=1))
        reason = "interrupted" if stopped else "converged"
        return replace(costing(result, float(n)), reason=reason)

    shape, asked = fake(monkeypatch, answer)
    result = segment_parts(
        shape, recipe=recipe(), report=lambda progress: progress.stage == "4 parts: search"
    )
    assert [n for n, _ in asked] == [2, 3, 4]
    assert len(result.parts) == 2
    assert [record["parts"] for record in result.history[TRIED]] == [2, 3, 4]
    assert result.reason == "interrupted"
    assert result.warnings == (
        "the run was interrupted; this is the best that it had found",
        "of its own",
    )


@pytest.mark.parametrize("with_result", [True, False])
def test_a_number_that_fails_keeps_those_before_it(monkeypatch, with_result):
    def answer(n, result, report):
        if n == 4:
            error = PluginError("broken")
            error.result = costing(result, 9.0) if with_result else None
            raise error
        return costing(result, float(n))

    shape, _ = fake(monkeypatch, answer)
    with pytest.raises(PluginError, match="broken") as caught:
        segment_parts(shape, recipe=recipe())
    found = caught.value.result
    assert len(found.parts) == 2
    assert found.reason == "failed"
    assert found.warnings[0] == "the run failed; this is the best that it had found"
    assert len(found.history[TRIED]) == (3 if with_result else 2)


def test_a_failure_before_anything_was_found_is_passed_on(monkeypatch):
    def answer(n, result, report):
        raise ShapeError("no such thing")

    shape, asked = fake(monkeypatch, answer)
    with pytest.raises(MosegError, match="no such thing") as caught:
        segment_parts(shape, recipe=recipe())
    assert caught.value.result is None
    assert len(asked) == 1


def test_seconds_are_shared_among_the_numbers(monkeypatch):
    monkeypatch.setattr(module.time, "monotonic", lambda: 7.0)  # no time passes
    shape, asked = fake(monkeypatch, lambda n, result, report: replace(result, reason="seconds"))
    result = segment_parts(shape, recipe=recipe(), max_seconds=60.0)
    n = len(asked)
    assert [options.max_seconds for _, options in asked] == pytest.approx(
        [60.0 / (n - k) for k in range(n)]
    )
    assert result.reason == "seconds"
    assert "the search ended on its limit (seconds)" in result.warnings[0]


def test_no_more_parts_than_elements():
    shape = Shape.from_mesh(*strip(3))
    result = segment_parts(shape, recipe=recipe(minimize="narrow(part*)"), **QUICK)
    assert [record["parts"] for record in result.history[TRIED]] == [2, 3]
    with pytest.raises(ShapeError, match="3"):
        segment_parts(shape, 4, recipe=recipe(minimize="narrow(part*)"), **QUICK)
    single = Shape.from_mesh(*strip(1))
    with pytest.raises(ShapeError, match="1"):
        segment_parts(single, recipe=recipe(minimize="narrow(part*)"), **QUICK)


def test_all_numbers_are_checked_before_any_is_tried(box):
    reports = []
    with pytest.raises(UsageError, match="resolution"):
        segment_parts(box, resolution=MOST - 1, report=reports.append)
    assert reports == []


def test_parts_of_each_number_are_divided():
    shape, _ = beads((5, 9))
    inner = Statement(labels=("a", "b"), minimize="compact(a)")
    task = recipe(minimize="0.01*compact(part*)", parts=(("part1", inner),))
    options = SearchOptions.of({**QUICK})
    result = solve_parts(
        shape,
        replace(task.statement, labels=("part1", "more*")),
        "auto",
        options,
        report=lambda progress: False,
    )
    assert isinstance(result.problem, Hierarchy)
    assert {"part1/a", "part1/b"} <= set(result.parts)
    assert all(math.isfinite(record["cost"]) for record in result.history[TRIED])
    assert [record["parts"] for record in result.history[TRIED]][:2] == [2, 3]
