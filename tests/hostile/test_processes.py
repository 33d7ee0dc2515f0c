"""Worker processes in a hostile world: killed, not to be had, or not to be made safely.

Rows of the table of hostile inputs. Each says: the same result as ever.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import signal
import subprocess
import sys
import warnings

import pytest

from moseg_core.cli import main
from moseg_core.components.objectives import objective
from moseg_core.components.part import Part
from moseg_core.errors import MosegError
from moseg_core.io.files import load
from moseg_core.io.result_json import write_json
from moseg_core.problem.problem import Problem
from moseg_core.samples import sample_path
from moseg_core.search.segment import segment


@pytest.fixture(scope="module")
def hammer():
    return load(sample_path("hammer"))


def document(shape, fragile=lambda: None, *, workers=2):
    """What a search with four starts comes to, with something that happens in an objective."""

    @objective(range=(0, 1))
    def size(part: Part) -> float:
        if multiprocessing.parent_process() is not None:
            fragile()
        return part.area / shape.area

    problem = Problem(["a", "b"], "narrow(a) + 0.1*size(b)", objectives={"size": size})
    few = "pattern_search(max_evaluations=240)"
    return write_json(segment(shape, problem, optimizer=few, restarts=4, workers=workers))


def test_a_killed_worker_costs_time_only(hammer, tmp_path):
    """kill -9 of one worker, as by a system out of memory, somewhere in the search."""
    sound = document(hammer, workers=1)
    calls = []

    def killed():
        calls.append(1)
        if len(calls) == 5 and not (tmp_path / "killed").exists():
            (tmp_path / "killed").touch()
            os.kill(os.getpid(), signal.SIGKILL)

    with pytest.warns(RuntimeWarning, match=r"ended early \(signal 9.* objective .*size.* again"):
        assert document(hammer, killed) == sound


def test_a_component_that_crashes_ends_the_run_by_its_name(hammer):
    with (
        pytest.warns(RuntimeWarning, match="done again"),
        pytest.raises(MosegError, match=r"signal 11.* objective .*size.*, and so did another"),
    ):
        document(hammer, lambda: os.kill(os.getpid(), signal.SIGSEGV))


def test_inside_a_pool_one_worker_does_it(hammer):
    with multiprocessing.get_context("fork").Pool(1) as pool:
        found, told = pool.apply(_in_pool, (hammer.name,))
    assert found == document(hammer, workers=1)
    assert ["one of a pool" in text for text in told] == [True]


def _in_pool(name):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        found = document(load(sample_path(name)))
    return found, [str(warning.message) for warning in told]


#: ``fork_deadlock.py`` of the table, down to what makes the copies: with one it never returns.
DEADLOCK = """
import threading, numpy as np, moseg_core as m
a = np.random.rand(400, 400)
def burn():
    while True: a @ a
threading.Thread(target=burn, name="burn", daemon=True).start()
for _ in range(20):
    with m.Workers({"square": lambda x, report: x * x}, 2, lambda progress: False) as workers:
        assert workers.map("square", [(1,), (2,), (3,)]) == [1, 4, 9]
"""


def test_no_process_is_copied_while_another_thread_computes():
    done = subprocess.run(
        [sys.executable, "-c", DEADLOCK], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0
    assert "the thread 'burn' is running" in done.stderr


def test_few_descriptors_are_left_for_the_result(tmp_path, monkeypatch):
    """``ulimit -n 24``: once told as "cannot write the output"."""
    monkeypatch.chdir(tmp_path)
    words = "--labels a,b --minimize narrow(a) --optimizer pattern_search(max_evaluations=60)"
    command = ["segment", str(sample_path("hammer")), *words.split(), "--restarts", "3"]
    done = subprocess.run(
        [sys.executable, "-m", "moseg_core", *command, "--workers", "2", "-o", "few.json"],
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (24, 24)),
    )
    assert done.returncode == 0, done.stderr
    assert "moseg: warning: there are not 24 descriptors left for another process" in done.stderr
    with pytest.raises(SystemExit):
        main([*command, "--workers", "2", "-o", "many.json"])
    assert (tmp_path / "few.json").read_bytes() == (tmp_path / "many.json").read_bytes()
