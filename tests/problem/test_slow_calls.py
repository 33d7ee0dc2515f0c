"""Which call is named, when and how often; the clock is the test's."""

from __future__ import annotations

import threading

import pytest

from moseg_core.problem.slow_calls import Watch, naming_slow_calls, rest, under_watch


class Clock:
    """A clock that stands until it is set."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def told():
    return []


@pytest.fixture
def watch(clock, told):
    """A watch that looks only when it is asked to."""
    return Watch(lambda what, seconds: told.append((what, seconds)), after=10.0, clock=clock)


def look_at(watch, clock, *times):
    for clock.now in times:
        watch.look()


def test_a_call_is_named_once_it_takes_long_and_each_time_its_age_has_doubled(watch, clock, told):
    watch.call("slow(a)")
    look_at(watch, clock, 0, 9.9, 10, 10.1, 19.9, 20, 39, 41, 81, 82, 83)
    assert told == [("slow(a)", 10.0), ("slow(a)", 20.0), ("slow(a)", 41.0), ("slow(a)", 82.0)]


def test_time_is_counted_from_the_start_of_the_call(watch, clock, told):
    clock.now = 100.0
    watch.call("slow(a)")
    look_at(watch, clock, 105, 112)
    assert told == [("slow(a)", 12.0)]


def test_calls_that_have_ended_are_not_named(watch, clock, told):
    watch.call("quick(a)")
    watch.__exit__(None, None, None)
    look_at(watch, clock, 1000)
    watch.call("quick(b)")
    look_at(watch, clock, 1001)
    assert told == []


def test_many_short_calls_are_not_one_long_one(watch, clock, told):
    for k in range(100):
        watch.call("quick(a)")
        look_at(watch, clock, k, k + 0.5)
        watch.__exit__(None, None, None)
    assert told == []


def test_a_call_that_waits_to_be_named_is_named():
    named = threading.Event()
    told = []

    def tell(what, seconds):
        told.append((what, seconds))
        named.set()

    clock = Clock()
    with naming_slow_calls(tell, after=0.0, clock=clock), under_watch("slow(a)"):
        assert named.wait(60)
    assert told[0] == ("slow(a)", 0.0)


def watching():
    return {thread for thread in threading.enumerate() if thread.name == "moseg-watch"}


def test_nobody_looks_any_more_when_it_is_over():
    before = watching()
    with naming_slow_calls(lambda what, seconds: None, after=0.0):
        with under_watch("slow(a)"):
            (thread,) = watching() - before
        assert thread.daemon
    thread.join(60)
    assert not thread.is_alive()


def test_without_anybody_who_wants_to_know_nothing_is_watched():
    before = watching()
    with under_watch("slow(a)"):
        assert not watching() - before


def test_errors_pass(watch):
    with pytest.raises(ZeroDivisionError), naming_slow_calls(print), under_watch("a"):
        _ = 1 / 0


def test_a_watch_that_rests_has_no_thread_until_the_next_call():
    before = watching()
    with naming_slow_calls(lambda what, seconds: None, after=0.0):
        with under_watch("slow(a)"):
            (thread,) = watching() - before
        rest()
        assert not thread.is_alive()
        rest()  # there is nothing more to end
        with under_watch("slow(b)"):
            assert watching() - before


def test_without_a_watch_there_is_nothing_to_rest():
    rest()


def test_where_the_system_makes_no_thread_calls_go_on(monkeypatch):
    def none_left(thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", none_left)
    with naming_slow_calls(print, after=0.01):
        with under_watch("a call"):
            done = True
        rest()
    assert done
