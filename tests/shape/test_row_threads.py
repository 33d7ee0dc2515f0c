"""Rows shared among threads: each is done once, and what goes wrong comes through."""

from __future__ import annotations

import threading

import pytest

from moseg_core.shape import row_threads
from moseg_core.shape.row_threads import over_rows, share_processors


@pytest.fixture(autouse=True)
def nothing_said(monkeypatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)


@pytest.fixture(params=[1, 2, 3, 7])
def processors(request, monkeypatch):
    monkeypatch.setattr(row_threads, "available_processors", lambda: request.param)
    return request.param


@pytest.mark.parametrize("seconds", [0.0, 1.0])
@pytest.mark.parametrize("count", [0, 1, 2, 5, 100])
def test_each_row_is_done_once(processors, count, seconds):
    stretches = []
    over_rows(lambda first, end: stretches.append((first, end)), count, seconds=seconds)
    assert sorted(k for first, end in stretches for k in range(first, end)) == list(range(count))
    assert len(stretches) == (max(1, min(count, processors)) if seconds else 1)


def test_this_thread_has_a_share_and_small_batches_are_done_without_others(monkeypatch):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 3)
    together = threading.Barrier(3, timeout=60)
    names = set()

    def meet(first, end):
        together.wait()  # three at a time, or never
        names.add(threading.get_ident())

    over_rows(meet, 3, seconds=1.0)
    assert len(names) == 3
    assert threading.get_ident() in names
    names.clear()
    over_rows(lambda first, end: names.add(threading.get_ident()), 3, seconds=1e-9)
    assert names == {threading.get_ident()}


@pytest.mark.parametrize(("processes", "threads"), [(1, 5), (2, 2), (3, 1), (9, 1)])
def test_processes_side_by_side_share_the_processors(monkeypatch, processes, threads):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 5)
    monkeypatch.setattr(row_threads, "_processes", 1)
    share_processors(processes)
    stretches = []
    over_rows(lambda first, end: stretches.append((first, end)), 50, seconds=1.0)
    assert len(stretches) == threads


@pytest.mark.parametrize("bad", [0, 2])
def test_what_a_stretch_raises_comes_through_when_all_are_done(monkeypatch, bad):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 3)
    done = []

    def work(first, end):
        if first == bad:
            raise ValueError(f"row {first}")
        done.append(first)

    with pytest.raises(ValueError, match=f"row {bad}"):
        over_rows(work, 3, seconds=1.0)
    assert sorted(done) == [k for k in range(3) if k != bad]


def test_there_is_a_processor():
    assert row_threads.available_processors() >= 1


@pytest.mark.parametrize(("said", "count"), [("1", 1), ("2", 2), ("9", 3), ("0", 1), ("x", 3)])
def test_no_more_threads_than_libraries_are_allowed(monkeypatch, said, count):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 3)
    monkeypatch.setenv("OMP_NUM_THREADS", said)
    stretches = []
    over_rows(lambda first, end: stretches.append((first, end)), 6, seconds=1.0)
    assert len(stretches) == count


@pytest.mark.parametrize("possible", [0, 1])
def test_where_the_system_makes_no_thread_this_one_does_it(monkeypatch, possible):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 4)
    started, start = [], threading.Thread.start

    def none_left(thread):
        if len(started) == possible:
            raise RuntimeError("can't start new thread")
        started.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", none_left)
    done = []
    over_rows(lambda first, end: done.extend(range(first, end)), 8, seconds=1.0)
    assert set(done) == set(range(8))
    assert done[-8:] == list(range(8))
