"""Work in several processes: the same results in the same order, and what can go wrong."""

from __future__ import annotations

import os
import signal
import time

import pytest

from moseg_core.errors import ExpressionError, MosegError, PluginError, UsageError
from moseg_core.protocols import Progress
from moseg_core.workers import Workers, available_workers, read_workers


def silent(progress):
    return False


def square(x, *, report):
    report(Progress(stage="squares", done=x))
    return x * x


def refuse(x, *, report):
    if x == 2:
        raise UsageError("2 is not to my liking")
    return x


@pytest.mark.parametrize("count", [1, 2, 3])
def test_results_come_in_order(count):
    with Workers({"square": square}, count, silent) as workers:
        assert workers.map("square", [(k,) for k in range(7)]) == [k * k for k in range(7)]
        assert workers.map("square", []) == []
        assert workers.map("square", [(9,), (8,)]) == [81, 64]


def test_work_is_done_elsewhere_but_by_one():
    def who(*, report):
        return os.getpid()

    with Workers({"who": who}, 2, silent) as workers:
        assert os.getpid() not in workers.map("who", [(), ()])
        assert workers.map("who", [()]) == [os.getpid()]
    with Workers({"who": who}, 1, silent) as workers:
        assert workers.map("who", [(), ()]) == [os.getpid()] * 2


@pytest.mark.parametrize("count", [1, 2])
def test_errors_are_raised_here(count):
    with (
        Workers({"refuse": refuse}, count, silent) as workers,
        pytest.raises(UsageError, match="2 is not to my liking"),
    ):
        workers.map("refuse", [(k,) for k in range(4)])


def test_errors_that_cannot_be_packed_keep_their_words():
    def fail(k, *, report):
        raise ExpressionError("no such thing", "narow(a)", 0, 5)

    with (
        Workers({"fail": fail}, 2, silent) as workers,
        pytest.raises(MosegError, match="no such thing"),
    ):
        workers.map("fail", [(0,), (1,)])


def test_results_that_cannot_be_sent_are_the_components_fault():
    def secret(k, *, report):
        return lambda: k

    with (
        Workers({"secret": secret}, 2, silent) as workers,
        pytest.raises(PluginError, match=r"cannot be sent between processes .*use one worker"),
    ):
        workers.map("secret", [(0,), (1,)])


def test_a_process_that_dies_is_noticed():
    def die(k, *, report):
        os.kill(os.getpid(), signal.SIGKILL)

    with (
        Workers({"die": die}, 2, silent) as workers,
        pytest.raises(MosegError, match=r"ended early \(signal 9\)"),
    ):
        workers.map("die", [(0,), (1,)])


@pytest.mark.parametrize("count", [1, 2])
def test_asked_to_stop_all_do_and_nothing_new_begins(count):
    seen = []

    def patient(k, *, report):
        while not report(Progress(stage="waiting", done=k)):
            time.sleep(0.001)
        return k

    def stop(progress):
        seen.append(progress.done)
        return len(seen) >= 3

    with Workers({"patient": patient}, count, stop) as workers:
        assert workers.map("patient", [(k,) for k in range(6)]) == list(range(count))
        assert workers.map("patient", [(k,) for k in range(6)]) == []
    assert seen[:3] == [0, 0, 0]  # reports are those of the first task that is still running


@pytest.mark.parametrize("count", [1, 2])
def test_enough_is_enough(count):
    def quick(k, *, report):
        while k == 1 and not report(Progress(stage="waiting", done=k)):
            time.sleep(0.001)
        return k

    with Workers({"quick": quick}, count, silent) as workers:
        found = workers.map("quick", [(k,) for k in range(6)], enough=lambda k, result: k == 0)
        assert found == list(range(count))
        assert workers.map("quick", [(2,), (3,)]) == [2, 3]  # only that was enough


def test_numbers_of_workers():
    assert available_workers() >= 1
    assert read_workers(3) == 3
    for wrong in (0, -1, True, 2.0, "2"):
        with pytest.raises(UsageError, match=r"workers must be|at least one worker"):
            read_workers(wrong)
