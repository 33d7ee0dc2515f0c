"""Functions of functions as optimizers: the guide's examples, and the end of every thread."""

from __future__ import annotations

import gc
import math
import os
import pickle
import re
import threading
from pathlib import Path

import numpy as np
import pytest

from moseg_core.components.callback_optimizer import CallbackOptimizer
from moseg_core.components.cost import Cost
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.errors import PluginError, UsageError
from moseg_core.problem.problem import Problem
from moseg_core.search.segment import segment
from moseg_core.shape.shape import Shape
from tests import shapes

PAGE = Path(__file__).parents[2] / "docs" / "authors" / "optimizer.md"
START = np.array([2.0, -1.0, 0.5])
SHAPE = Shape.from_mesh(*shapes.jitter(shapes.tee(), 5), name="tee")


@objective(range=(0, 1))
def slim(part: Part) -> float:
    return float((part.scales[1] + part.scales[2]) / (2 * part.scales[0]))


PROBLEM = Problem(["stem", "bar"], "2*slim(stem) + slim(bar)", objectives={"slim": slim})


class Walk(CallbackOptimizer):
    """Random steps, kept where they lead down; asks for one vector, then for three."""

    steps = 30

    def minimize(self, f, start):
        best, value = start, f(start)
        for k in range(self.steps):
            tried = best + self.rng.standard_normal((3, len(start))) * self.scale / (k + 1)
            values = [f(tried[0])] if k % 2 else f(tried)
            if min(values) < value:
                best, value = tried[int(np.argmin(values))], min(values)


class Endless(Walk):
    steps = 10**9


class Failing(CallbackOptimizer):
    def minimize(self, f, start):
        f(start + 1)
        raise ZeroDivisionError("by nothing")


class Forgetful(CallbackOptimizer):
    """Its calls depend on something else."""

    calls = 0

    def minimize(self, f, start):
        while True:
            type(self).calls += 1
            f(start + type(self).calls)


class Stubborn(CallbackOptimizer):
    """Takes every error for a bad value."""

    def minimize(self, f, start):
        while True:
            try:
                f(start + 1)
            except Exception:  # noqa: BLE001  # as some libraries do
                continue


def bowl(x):
    return Cost(0, float((x**2).sum()))


def made(of, *, m=3, bound=math.inf, **options):
    bounds = np.full(m, -bound), np.full(m, bound)
    return of(START[:m], *bounds, np.ones(m), rng=np.random.default_rng(5), **options)


def step(search, cost=bowl):
    batch = search.ask()
    search.tell([cost(vector) for vector in batch.vectors])
    return batch.vectors


def ran(search, *, each=lambda search: search):
    asked = []
    while not search.finished:
        asked.append(step(search))
        search = each(search)
    return np.concatenate(asked), search


def threads():
    return [t for t in threading.enumerate() if t.name == "moseg-callback"]


@pytest.fixture(autouse=True)
def no_thread_is_left():
    yield
    gc.collect()
    assert threads() == []


def test_a_search_by_callbacks_asks_and_is_told():
    asked, search = ran(made(Walk))
    assert search.finished == "converged"
    assert (asked[0] == START).all()
    assert len(asked) == 1 + 15 * 3 + 15
    costs = [bowl(vector) for vector in asked]
    assert search.best[1] == min(costs)
    assert (search.best[0] == asked[costs.index(min(costs))]).all()
    assert [record["evaluations"] for record in search.history][-1] == len(asked)
    assert search.progress == 1.0
    assert threads() == []


def test_it_goes_on_from_a_pickle_as_if_nothing_had_been():
    whole, resumed = (
        ran(made(Walk)),
        ran(made(Walk), each=lambda search: pickle.loads(pickle.dumps(search))),
    )
    assert (whole[0] == resumed[0]).all()
    assert whole[1].history == resumed[1].history


def test_the_budget_is_kept_and_the_last_batch_cut_short():
    for budget in (1, 2, 6, 7):
        asked, search = ran(made(Endless, max_evaluations=budget))
        assert len(asked) == budget
        assert search.finished == "evaluations"


def test_what_is_out_of_bounds_is_asked_at_the_bound():
    asked, _ = ran(made(Walk, bound=2.0))
    assert (np.abs(asked) <= 2.0).all()
    assert (np.abs(asked) == 2.0).sum() > 1


def test_nan_is_as_bad_as_can_be():
    _, search = ran(made(Walk), each=lambda search: search)
    search = made(Walk)
    step(search, lambda x: Cost(0, math.nan))
    assert search.best[1] == Cost(0, math.inf)
    step(search)
    assert search.best[1] < Cost(0, math.inf)


def test_threads_end_when_nobody_holds_the_optimizer():
    search = made(Endless)
    step(search)
    assert len(threads()) == 1
    del search
    gc.collect()
    assert threads() == []


def test_an_optimizer_that_swallows_errors_ends_too():
    search = made(Stubborn)
    step(search)
    step(search)
    del search


@pytest.mark.skipif(not hasattr(os, "fork"), reason="the system cannot copy processes")
def test_no_thread_runs_while_a_process_is_copied():
    """Python warns of forks beside threads, and warnings are errors here."""
    search, other = made(Walk), made(Walk)
    for _ in range(3):
        step(search)
        step(other)
    search.ask()
    child = os.fork()
    if child == 0:  # the copy goes on by itself
        asked, _ = ran(search)
        os._exit(0 if len(asked) > 20 and not threads() else 1)
    assert threads() == []
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert (ran(search)[0] == ran(other)[0]).all()


def test_what_minimize_raises_is_raised_by_tell():
    search = made(Failing)
    step(search)
    with pytest.raises(ZeroDivisionError):
        step(search)
    with pytest.raises(PluginError, match=r"optimizer '.*:Failing', .* ZeroDivisionError"):
        segment(SHAPE, PROBLEM, optimizer=Failing)


def test_calls_that_differ_when_begun_anew_are_told():
    search = made(Forgetful)
    step(search)
    step(search)
    search = pickle.loads(pickle.dumps(search))
    with pytest.raises(UsageError, match="makes other calls than before"):
        step(search)


def test_tell_without_ask_is_refused():
    search = made(Walk)
    with pytest.raises(UsageError, match="last asked for"):
        search.tell([Cost(0, 1.0)])
    step(search)
    with pytest.raises(UsageError, match="last asked for"):
        search.tell([Cost(0, 1.0)])


def test_a_search_that_is_interrupted_leaves_no_thread():
    told = []

    def stop(progress):
        told.append(progress)
        return len(told) > 20

    result = segment(SHAPE, PROBLEM, optimizer=Endless, report=stop)
    assert result.reason == "interrupted"
    gc.collect()
    assert threads() == []


@pytest.mark.parametrize("workers", [1, 2])
def test_starts_in_several_processes_give_the_same(workers):
    found = segment(SHAPE, PROBLEM, optimizer=Walk, restarts=3, workers=workers)
    assert found.cost == segment(SHAPE, PROBLEM, optimizer=Walk, restarts=3).cost


# --- the guide


@pytest.fixture
def guide(tmp_path, monkeypatch):
    """The module of the guide's examples."""
    (source,) = re.findall(r"^```py\n(.*?)^```", PAGE.read_text(), re.M | re.S)
    (tmp_path / "guide_of_callbacks.py").write_text(source)
    monkeypatch.syspath_prepend(str(tmp_path))
    import guide_of_callbacks

    return guide_of_callbacks


@pytest.mark.parametrize("name", ["NelderMead", "DifferentialEvolution"])
def test_the_examples_of_the_guide_search(guide, name):
    start = segment(SHAPE, PROBLEM, optimizer="pattern_search(max_evaluations=1)")
    found = segment(SHAPE, PROBLEM, optimizer=getattr(guide, name), restarts=1)
    assert found.cost < 0.95 * start.cost
    assert found.method["optimizer"].startswith(f"guide_of_callbacks:{name}")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["NelderMead", "DifferentialEvolution"])
def test_the_examples_of_the_guide_keep_the_contract(guide, name):
    from moseg_core.testing import cases_of

    found = [case.outcome() for case in cases_of(getattr(guide, name), kind="optimizer")]
    assert [o for o in found if o.status not in ("passed", "skipped")] == []
