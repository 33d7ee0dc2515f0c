"""What of a process is looked at, told and put back."""

from __future__ import annotations

import os
import random
import signal
import threading
import warnings

import numpy as np
import pytest

from moseg_core.components.process_state import (
    AT_IMPORT,
    AT_WORK,
    ITEMS,
    changed,
    look,
    restore,
    told,
    working_directory,
)

CHANGES = {
    "the working directory": lambda: os.chdir("/"),
    "the global generator of random": lambda: random.seed(5),
    "the global generator of numpy.random": lambda: np.random.seed(5),  # noqa: NPY002
    "the handlers of signals": lambda: signal.signal(signal.SIGUSR2, signal.SIG_IGN),
    "the mask of file modes": lambda: os.umask(0o011),
    "the limit of recursion": lambda: __import__("sys").setrecursionlimit(2345),
    "the environment": lambda: os.environ.update(MOSEG_TESTS="1"),
    "the filters of warnings": lambda: warnings.simplefilter("ignore", ImportWarning),
    "numpy's handling of floating-point errors": lambda: np.seterr(under="raise"),
    "whether garbage is collected": lambda: __import__("gc").disable(),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_is_seen_and_undone(name):
    np.random.get_state()  # noqa: NPY002  # imported, so that it is looked at
    before = look()
    try:
        CHANGES[name]()
        assert list(changed(before)) == [name]
    finally:
        restore(before)
    assert changed(before) == {}


def test_it_says_how():
    before = look(["the working directory", "the environment", "the handlers of signals"])
    os.environ["MOSEG_TESTS"] = "1"
    signal.signal(signal.SIGUSR2, signal.SIG_IGN)
    os.chdir("/")
    try:
        assert changed(before) == {
            "the working directory": f"from {before['the working directory']} to /",
            "the handlers of signals": "SIGUSR2",
            "the environment": "MOSEG_TESTS",
        }
    finally:
        restore(before)


def test_threads_that_are_left_are_named_but_for_ours():
    before = look(["the threads that run"])
    over = threading.Event()
    threads = [threading.Thread(target=over.wait, name=n) for n in ("left", "moseg-watch")]
    for thread in threads:
        thread.start()
    found = changed(before)
    over.set()
    for thread in threads:
        thread.join()
    assert told(found) == "the threads that run (left running: left)"
    assert changed(before) == {}


@pytest.mark.parametrize("count", [1, 700, 3000])
def test_drawing_is_told_only_where_it_is_asked_for(count):
    np.random.rand(1)  # noqa: NPY002  # imported
    generators = [name for name in ITEMS if "generator" in name]
    before = look(generators)
    for _ in range(count):
        random.random()
    np.random.rand(count)  # noqa: NPY002  # the global generator is what is looked at
    assert changed(before) == {}
    assert list(changed(before, draws=True)) == generators
    restore(before)
    assert changed(before, draws=True) == {}


def test_a_working_directory_that_is_gone_is_none(tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert working_directory() == ""
    monkeypatch.chdir(tmp_path)


def test_what_is_looked_at_when_is_known():
    assert {*AT_IMPORT, *AT_WORK} <= set(ITEMS)
