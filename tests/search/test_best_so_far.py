"""Searches that fail: the error is raised as ever, and carries the best that was found before."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from moseg_core.components.objectives import FunctionObjective, Traits
from moseg_core.errors import MosegError, PluginError
from moseg_core.problem.hierarchy import Hierarchy
from moseg_core.problem.problem import Problem
from moseg_core.search.best_so_far import TrackedWorkers
from moseg_core.search.levels import segment_hierarchy
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes
from tests.made_up import evaluator_of, numbers

SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")
FINE = Shape.from_mesh(*shapes.jitter(shapes.bent_capsule(60, 24), 2, 0.005), name="capsule")


def slim(part):
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


def failing(fails):
    """How slim a part is; not so where `fails`, told the part, returns or raises something."""

    def moody(part):
        answer = fails(part)
        return slim(part) if answer is None else answer

    return FunctionObjective(moody, Traits(arity="unary", range=(0, 1)))


def after(count, what="raise"):
    """Fail from a certain call on."""
    calls = itertools.count()

    def fails(part):
        if next(calls) < count:
            return None
        if what == "raise":
            raise ValueError("not today")
        return math.nan

    return failing(fails)


def problem_of(objective, text="moody(stem) + moody(bar)"):
    return Problem(["stem", "bar"], text, objectives={"moody": objective})


def failure_of(run, *given, **options):
    with pytest.raises(MosegError) as caught:
        run(*given, **options)
    return caught.value


@pytest.mark.parametrize(("what", "said"), [("raise", "not today"), ("nan", "returned nan")])
@pytest.mark.parametrize("seeder", ["kmeans", "evolution"])
def test_a_search_that_fails_gives_what_it_had_found(what, said, seeder):
    error = failure_of(segment, SHAPE, problem_of(after(60, what)), seeder=seeder, restarts=1)
    assert isinstance(error, PluginError)
    assert "objective 'python:moody' of the calling program" in str(error)
    assert "'moody(" in str(error)
    assert " for " in str(error)
    assert said in str(error)
    found = error.result
    assert found.reason == "failed"
    assert found.warnings[0] == "the run failed; this is the best that it had found"
    sound = problem_of(failing(lambda part: None))
    assert found.cost == sound.evaluate(SHAPE, found.labels).cost.value
    assert set(found.labels) == {0, 1}


def test_what_is_kept_is_the_best_of_what_was_evaluated():
    """With a limit on evaluations the same search, not failing, finds the same."""
    calls = itertools.count()

    def counted(part):
        next(calls)

    limited = {"optimizer": "pattern_search(max_evaluations=40)", "restarts": 1}
    whole = segment(SHAPE, problem_of(failing(counted)), **limited)
    error = failure_of(segment, SHAPE, problem_of(after(next(calls))), restarts=1)
    assert error.result.cost <= whole.cost
    np.testing.assert_array_equal(error.result.labels, whole.labels)


@pytest.mark.parametrize("workers", [1, 2])
def test_with_several_starts_all_end(workers):
    error = failure_of(
        segment, SHAPE, problem_of(after(300)), restarts=6, seeder="evolution", workers=workers
    )
    assert "not today" in str(error)
    assert error.result.reason == "failed"
    assert "restarts" not in error.result.history


def test_what_was_found_on_a_coarse_shape_is_evaluated_on_the_whole_one():
    def fails(part):
        if next(calls) == 30:
            raise ValueError("just this once")

    calls = itertools.count()
    error = failure_of(segment, FINE, problem_of(failing(fails)), resolution=200)
    found = error.result
    assert "just this once" in str(error)
    assert found.labels.shape == (FINE.n_elements,)
    assert found.evaluation == problem_of(failing(lambda part: None)).evaluate(FINE, found.labels)


def test_where_its_cost_cannot_be_known_nothing_is_kept():
    error = failure_of(segment, FINE, problem_of(after(30)), resolution=200)
    assert "not today" in str(error)
    assert error.result is None


def test_a_search_that_fails_at_once_gives_nothing():
    error = failure_of(segment, SHAPE, problem_of(after(0)))
    assert "not today" in str(error)
    assert error.result is None


def test_of_several_levels_those_that_were_searched_are_kept():
    outer = Problem(["stem", "bar"], "slim(stem)", objectives={"slim": failing(lambda part: None)})

    def refused(count):
        inner = Problem(["a", "b"], "moody(a)", objectives={"moody": after(count)})
        return failure_of(segment_hierarchy, SHAPE, Hierarchy(outer, {"bar": inner}))

    whole = segment(SHAPE, outer)
    divided, undivided = refused(30), refused(0)
    assert list(divided.result.parts) == ["stem", "bar/a", "bar/b"]
    assert list(undivided.result.parts) == ["stem", "bar"]
    np.testing.assert_array_equal(undivided.result.labels, whole.labels)
    np.testing.assert_array_equal(divided.result.labels == 0, whole.labels == 0)
    for error in (divided, undivided):
        assert error.result.reason == "failed"
        assert "not today" in str(error)
    assert undivided.result.warnings[-1].startswith("part 'bar' is left whole: objective 'python:")


def test_the_least_of_all_processes_is_kept():
    problem = problem_of(failing(lambda part: None))
    labellings = [[0] * k + [1] * (8 - k) for k in range(1, 8)]
    evaluator = evaluator_of(problem, labellings)
    for vector in numbers(7):
        evaluator.evaluate(vector)
    cost, vector = evaluator.best
    tracked = TrackedWorkers(evaluator, evaluator)
    tracked._note([(cost._replace(value=cost.value - 1), vector + 1), None])
    error = PluginError("no more")
    found = tracked.best_found(error)
    assert found.failure is error
    assert (found.cost, found.vector.tolist()) == (cost, vector.tolist())  # the exact one


def test_the_best_so_far_keeps_all_centres_of_a_label():
    error = failure_of(
        segment,
        *(FINE, problem_of(after(900))),
        parameterization='voronoi(centers="bar=2")',
        resolution=200,
        restarts=1,
    )
    assert error.result.centers.parts.tolist() == [0, 1, 1]
