"""Seconds and calls, on a clock of the test's own."""

from __future__ import annotations

from contextlib import suppress

from moseg_core.components.profile import Entry, profiling, stage, timed


class Clock:
    """A clock that is moved by hand."""

    now = 0.0

    def __call__(self):
        return self.now


def test_what_goes_on_within_is_left_out():
    clock = Clock()
    with profiling(clock) as profile:
        for _ in range(2):
            with timed("component", "seeder a:b", "acme 1.0"):
                clock.now += 1
                with timed("term", "narrow(a)", "basic 1.0"):
                    clock.now += 3
                    with timed("component", "measure a:c", "acme 1.0"):
                        clock.now += 5
                clock.now += 7
    assert profile.entries == {
        ("component", "seeder a:b", "acme 1.0"): Entry(2, 16.0),
        ("term", "narrow(a)", "basic 1.0"): Entry(2, 6.0),
        ("component", "measure a:c", "acme 1.0"): Entry(2, 10.0),
    }
    assert [name for name, _, _ in profile.of("component")] == ["seeder a:b", "measure a:c"]
    assert profile.by_source() == {"acme 1.0": Entry(4, 26.0), "basic 1.0": Entry(2, 6.0)}


def test_stages_are_counted_apart():
    clock = Clock()

    @stage("inner")
    def inner(seconds, *, more):
        """It waits."""
        clock.now += seconds + more
        return seconds

    with profiling(clock) as profile, timed("stage", "outer"), timed("component", "x", "y"):
        assert inner(2, more=1) == 2
        clock.now += 4
    assert inner.__doc__ == "It waits."
    found = {name: entry.seconds for (_, name, _), entry in profile.entries.items()}
    assert found == {"inner": 3.0, "x": 7.0, "outer": 4.0}


def test_what_raises_is_counted_and_raises():
    clock = Clock()
    with profiling(clock) as profile:
        with suppress(ZeroDivisionError), timed("term", "a", "b"):
            clock.now += 1
            _ = 1 / 0
        with timed("term", "c", "d"):
            clock.now += 2
    assert [entry.seconds for _, _, entry in profile.of("term")] == [2.0, 1.0]


def test_nobody_asks():
    first, second = timed("term", "a", "b"), timed("stage", "c")
    assert first is second
    with first, profiling() as profile:
        pass
    with timed("term", "a", "b"):
        pass
    assert profile.entries == {}


def test_calls_that_are_made_at_once_are_counted_one_by_one():
    with (
        profiling(clock=iter([0.0, 1.0]).__next__) as profile,
        timed("term", "is(a)", "b", calls=5),
    ):
        pass
    assert [(e.calls, e.seconds) for _, _, e in profile.of("term")] == [(5, 1.0)]
