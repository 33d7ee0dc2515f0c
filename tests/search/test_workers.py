"""Work in several processes: the same results in the same order, and what can go wrong."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest

from moseg_core.components.at_work import at_work, crashes_apart
from moseg_core.components.cost import Cost
from moseg_core.components.profile import profiling
from moseg_core.components.protocols import Progress, never_stop
from moseg_core.errors import ExpressionError, MosegError, PluginError, UsageError
from moseg_core.search.workers import Workers, available_workers, bettered
from moseg_core.shape import row_threads


def square(x, *, report):
    report(Progress(stage="squares", done=x))
    return x * x


def refuse(x, *, report):
    if x == 2:
        raise UsageError("2 is not to my liking")
    return x


@pytest.mark.parametrize("count", [1, 2, 3])
def test_results_come_in_order(count):
    with Workers({"square": square}, count, never_stop) as workers:
        assert workers.map("square", [(k,) for k in range(7)]) == [k * k for k in range(7)]
        assert workers.map("square", []) == []
        assert workers.map("square", [(9,), (8,)]) == [81, 64]


def test_work_is_done_elsewhere_but_by_one():
    def who(*, report):
        return os.getpid()

    with Workers({"who": who}, 2, never_stop) as workers:
        assert os.getpid() not in workers.map("who", [(), ()])
        assert workers.map("who", [()]) == [os.getpid()]
    with Workers({"who": who}, 1, never_stop) as workers:
        assert workers.map("who", [(), ()]) == [os.getpid()] * 2


@pytest.mark.parametrize("count", [1, 2])
def test_errors_are_raised_here(count):
    with (
        Workers({"refuse": refuse}, count, never_stop) as workers,
        pytest.raises(UsageError, match="2 is not to my liking"),
    ):
        workers.map("refuse", [(k,) for k in range(4)])


def test_errors_that_cannot_be_packed_keep_their_words():
    def fail(k, *, report):
        raise ExpressionError("no such thing", "narow(a)", 0, 5)

    with (
        Workers({"fail": fail}, 2, never_stop) as workers,
        pytest.raises(MosegError, match="no such thing"),
    ):
        workers.map("fail", [(0,), (1,)])


def test_results_that_cannot_be_sent_are_the_components_fault():
    def secret(k, *, report):
        return lambda: k

    with (
        Workers({"secret": secret}, 2, never_stop) as workers,
        pytest.raises(PluginError, match=r"cannot be sent between processes .*use one worker"),
    ):
        workers.map("secret", [(0,), (1,)])


def test_a_task_that_kills_its_process_twice_is_an_error():
    def die(k, *, report):
        os.kill(os.getpid(), signal.SIGKILL)

    with (
        Workers({"die": die}, 2, never_stop) as workers,
        pytest.warns(RuntimeWarning, match=r"signal 9; memory may have run out.*done again"),
        pytest.raises(MosegError, match=r"ended early \(signal 9.*and so did another"),
    ):
        workers.map("die", [(0,), (1,)])


@pytest.mark.parametrize("lost", [[0], [3], [0, 1], [1, 2, 5]])
def test_what_a_lost_process_did_is_done_again(lost, tmp_path):
    def once(k, *, report):
        if k in lost and not (tmp_path / str(k)).exists():
            (tmp_path / str(k)).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        report(Progress(stage="work", done=k))
        return k * k

    with Workers({"once": once}, 2, never_stop) as workers:
        with pytest.warns(RuntimeWarning, match="what it did is done again"):
            assert workers.map("once", [(k,) for k in range(6)]) == [k * k for k in range(6)]
        assert workers.map("once", [(7,), (8,)]) == [49, 64]  # by two again, without a word


def test_a_task_lost_after_the_stop_begins_again_and_stops(tmp_path):
    """Whoever asks for the first result must not be left without it."""

    def stubborn(k, *, report):
        while not report(Progress(stage="work", done=k)):
            time.sleep(0.001)
        if k == 0 and not (tmp_path / "lost").exists():
            (tmp_path / "lost").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return k

    with (
        Workers({"stubborn": stubborn}, 2, lambda progress: True) as workers,
        pytest.warns(RuntimeWarning, match="done again"),
    ):
        assert workers.map("stubborn", [(k,) for k in range(4)]) == [0, 1]


def two_at_most(workers, monkeypatch):
    """Let the system make two processes, and then no more."""
    made, make = [], workers._made

    def at_first():
        if len(made) == 2:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        made.append(1)
        return make()

    monkeypatch.setattr(workers, "_made", at_first)


def test_where_no_process_can_be_made_again_this_one_does_the_rest(monkeypatch):
    def unlucky(k, *, report):
        if multiprocessing.parent_process() is not None:
            os.kill(os.getpid(), signal.SIGKILL)
        return k * k

    with Workers({"unlucky": unlucky}, 2, never_stop) as workers:
        two_at_most(workers, monkeypatch)
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            assert workers.map("unlucky", [(k,) for k in range(5)]) == [0, 1, 4, 9, 16]
    assert "makes no process: Resource temporarily unavailable; everything is done by this" in str(
        told[-1].message
    )


def test_what_crashed_by_itself_is_not_tried_in_this_process(monkeypatch):
    def crash(k, *, report):
        os.kill(os.getpid(), signal.SIGSEGV)

    with Workers({"crash": crash}, 2, never_stop) as workers:
        two_at_most(workers, monkeypatch)
        with (
            pytest.warns(RuntimeWarning, match="signal 11"),
            pytest.raises(MosegError, match="signal 11"),
        ):
            workers.map("crash", [(0,), (1,)])


def test_fewer_processes_than_asked_for_are_told_of_once(monkeypatch):
    def who(*, report):
        return os.getpid()

    with Workers({"who": who}, 3, never_stop) as workers:
        made, make = [], workers._made

        def one():
            if made:
                raise OSError(24, "Too many open files")
            made.append(1)
            return make()

        monkeypatch.setattr(workers, "_made", one)
        with pytest.warns(RuntimeWarning, match="Too many open files; .* by 1 process, with"):
            found = workers.map("who", [()] * 4)
        assert len(set(found)) == 1
        assert os.getpid() not in found
        assert workers.map("who", [()] * 4) == found


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


def test_one_silent_task_does_not_keep_the_others_from_stopping():
    def uneven(k, *, report):
        if k == 0:
            time.sleep(0.5)
            return "silent"
        for _ in range(2000):
            if report(Progress(stage="talking", done=k)):
                return "stopped"
            time.sleep(0.001)
        return "went on"

    with Workers({"uneven": uneven}, 2, lambda progress: True) as workers:
        assert workers.map("uneven", [(0,), (1,)]) == ["silent", "stopped"]


def test_an_idle_process_that_dies_is_replaced():
    def who(*, report):
        return os.getpid()

    with Workers({"who": who}, 2, never_stop) as workers:
        before = set(workers.map("who", [()] * 4))
        for process in before:
            os.kill(process, signal.SIGKILL)
        time.sleep(0.2)
        assert before.isdisjoint(workers.map("who", [(), ()]))


def test_processes_end_even_if_this_one_does_not_when_told_to():
    before = signal.signal(signal.SIGTERM, lambda number, frame: None)
    try:
        with (
            Workers({"refuse": refuse}, 2, never_stop) as workers,
            pytest.raises(UsageError, match="2 is not to my liking"),
        ):
            workers.map("refuse", [(2,), (3,)])
    finally:
        signal.signal(signal.SIGTERM, before)


def test_processes_do_not_outlive_the_one_that_made_them(tmp_path):
    script = tmp_path / "orphans.py"
    script.write_text(
        "import os, signal\n"
        "from moseg_core.search.workers import Workers\n"
        "pool = Workers({'who': lambda report: os.getpid()}, 2, lambda progress: False)\n"
        "print(*set(pool.map('who', [()] * 6)), flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert done.returncode == -signal.SIGKILL
    left = {int(word) for word in done.stdout.split()}
    assert left
    for _ in range(500):
        left = {process for process in left if _runs(process)}
        if not left:
            break
        time.sleep(0.01)
    assert not left


def _runs(process):
    try:
        return (Path("/proc") / str(process) / "stat").read_text().split()[2] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("count", [1, 2])
def test_enough_is_enough(count):
    def quick(k, *, report):
        while k == 1 and not report(Progress(stage="waiting", done=k)):
            time.sleep(0.001)
        return k

    with Workers({"quick": quick}, count, never_stop) as workers:
        found = workers.map("quick", [(k,) for k in range(6)], enough=lambda k, result: k == 0)
        assert found == list(range(count))
        assert workers.map("quick", [(2,), (3,)]) == [2, 3]  # only that was enough


def test_the_progress_of_one_task_has_the_best_of_all():
    first, other = (
        Progress(stage="search", done=k, best=Cost(0, value)) for k, value in ((1, 0.5), (2, 0.3))
    )
    assert bettered(first, other) == Progress(stage="search", done=1, best=Cost(0, 0.3))
    assert bettered(other, first).best == other.best
    elsewhere = Progress(stage="polish", done=3, best=Cost(0, 0.1))
    assert bettered(first, elsewhere) is first


def test_a_single_task_is_done_elsewhere_where_this_process_may_not_be_lost():
    tasks = {"where": lambda report: os.getpid(), "die": lambda report: os.kill(os.getpid(), 9)}
    with crashes_apart(), Workers(tasks, 1, never_stop) as workers:
        assert workers.map("where", [()]) != [os.getpid()]
        with (
            pytest.warns(RuntimeWarning, match="done again"),
            pytest.raises(MosegError, match="signal 9"),
        ):
            workers.map("die", [()])
    with crashes_apart(), profiling(), Workers(tasks, 1, never_stop) as workers:
        assert workers.map("where", [()]) == [os.getpid()]


def test_numbers_of_workers():
    assert available_workers() >= 1


def test_the_component_that_a_process_died_in_is_named():
    def crash(k, *, report):
        with at_work("seeder 'strange:odd' of moseg-strange 2.0"):
            pass
        with at_work("objective 'strange:crash' of moseg-strange 2.0 in 'crash(a)' for a"):
            os.kill(os.getpid(), signal.SIGSEGV)

    with (
        Workers({"crash": crash}, 2, never_stop) as workers,
        pytest.warns(RuntimeWarning, match="done again"),
        pytest.raises(
            MosegError,
            match=r"ended early \(signal 11\) while objective 'strange:crash' of moseg-strange 2\.0"
            r" in 'crash\(a\)' for a was at work",
        ),
    ):
        workers.map("crash", [(0,), (1,)])


def test_errors_keep_their_cause_on_the_way():
    def fail(k, *, report):
        try:
            raise ZeroDivisionError("by nothing")
        except ZeroDivisionError as error:
            raise PluginError("it failed") from error

    with (
        Workers({"fail": fail}, 2, never_stop) as workers,
        pytest.raises(PluginError, match="it failed") as caught,
    ):
        workers.map("fail", [(0,), (1,)])
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert "raise ZeroDivisionError" in caught.value.__notes__[0]


def test_a_task_that_exits_is_an_error():
    def leave(k, *, report):
        raise SystemExit(3)

    with (
        Workers({"leave": leave}, 2, never_stop) as workers,
        pytest.raises(SystemExit),
    ):
        workers.map("leave", [(0,), (1,)])


def test_processes_go_on_where_this_one_winds_up_when_told_to_end():
    """A batch system tells all processes of a run; those that work must not be lost by it."""

    def told(k, *, report):
        os.kill(os.getpid(), signal.SIGTERM)
        return k

    before = signal.signal(signal.SIGTERM, lambda number, frame: None)
    try:
        with Workers({"told": told}, 2, never_stop) as workers:
            assert workers.map("told", [(0,), (1,)]) == [0, 1]
    finally:
        signal.signal(signal.SIGTERM, before)


def test_processes_made_after_others_were_released_know_what_this_one_knows():
    known = ["before"]
    with Workers({"tell": lambda report: (os.getpid(), *known)}, 2, never_stop) as workers:
        first = workers.map("tell", [(), ()])
        known.append("after")
        assert {said[1:] for said in workers.map("tell", [(), ()])} == {("before",)}
        workers.release()
        second = workers.map("tell", [(), ()])
    assert {said[1:] for said in first} == {("before",)}
    assert {said[1:] for said in second} == {("before", "after")}
    assert not {said[0] for said in first} & {said[0] for said in second}


def test_processes_share_the_processors_among_them(monkeypatch):
    monkeypatch.setattr(row_threads, "available_processors", lambda: 6)
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)

    def stretches(*, report):
        found = []
        row_threads.over_rows(lambda first, end: found.append(first), 60, seconds=1.0)
        return len(found)

    with Workers({"count": stretches}, 2, never_stop) as workers:
        assert workers.map("count", [(), ()]) == [3, 3]
    assert stretches(report=never_stop) == 6
