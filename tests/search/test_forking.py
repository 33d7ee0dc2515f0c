"""Whether a process can be copied now: threads that run, pools, descriptors."""

from __future__ import annotations

import multiprocessing
import os
import resource
import threading
import time

import pytest

from moseg_core.search import forking
from moseg_core.search.forking import hindrance, running_threads


@pytest.fixture
def ended():
    """An event that is set when the test is over, for threads to end with it."""
    event = threading.Event()
    yield event
    event.set()


def started(target, name):
    thread = threading.Thread(target=target, name=name, daemon=True)
    thread.start()
    return thread


def test_a_thread_that_waits_does_not_run(ended):
    started(ended.wait, "waits")
    reading, writing = os.pipe()
    reader = started(lambda: os.read(reading, 1), "reads")
    sleeper = started(lambda: time.sleep(0.5), "sleeps")
    time.sleep(0.05)
    assert running_threads() == []
    assert hindrance() == ""
    os.write(writing, b"x")
    for thread in (reader, sleeper):
        thread.join()
    os.close(reading)
    os.close(writing)


def test_a_thread_that_computes_runs(ended):
    def count():
        k = 0
        while not ended.is_set():
            k += 1

    started(count, "counts")
    assert running_threads() == ["counts"]
    assert hindrance().startswith("the thread 'counts' is running")


def test_many_threads_are_not_all_named(ended):
    def count():
        while not ended.is_set():
            pass

    for k in range(4):
        started(count, f"t{k}")
    assert "threads 't0', 't1', 't2', ... are running" in hindrance()


def test_where_the_system_does_not_tell_every_thread_runs(ended, monkeypatch, tmp_path):
    started(ended.wait, "waits")
    monkeypatch.setattr(forking, "Path", lambda name: tmp_path)
    assert running_threads() == ["waits"]


def test_a_process_of_a_pool_makes_none_of_its_own():
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert "one of a pool" in pool.apply(hindrance)


def test_too_few_descriptors_are_noticed_before_any_is_taken():
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    first = os.dup(0)
    os.close(first)
    resource.setrlimit(resource.RLIMIT_NOFILE, (first + 12, limits[1]))
    try:
        assert "descriptors" in hindrance()
        again = os.dup(0)
        os.close(again)
        assert again == first  # none is kept
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)
    assert hindrance() == ""
