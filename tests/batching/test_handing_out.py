"""Jobs that an executor has: few, in what order they are done, and which are taken back."""

from __future__ import annotations

from concurrent.futures import Executor, Future

import pytest

from moseg_core.batching.handing_out import HandedOut
from moseg_core.batching.jobs import Job
from moseg_core.batching.outcome import Outcome


class Held(Executor):
    """Keeps what it is given until the test says otherwise."""

    def __init__(self):
        self.futures = {}

    def submit(self, function, job):
        self.futures[job.shape] = Future()
        return self.futures[job.shape]

    def finish(self, shape):
        self.futures[shape].set_result(Outcome(shape=shape, key=shape, kind="ok"))


def job(shape):
    return Job(shape=shape, here="", folder="", outputs=(), instructions="", key=shape)


@pytest.fixture
def pool():
    return Held()


def filled(pool, count):
    handed_out, number = HandedOut(pool, count), 0
    while handed_out.has_room:
        handed_out.add(job(f"s{number}"))
        number += 1
    return handed_out


def test_for_each_worker_one_is_done_and_one_waits(pool):
    assert len(filled(pool, 3)) == 6


def test_what_is_done_makes_room(pool):
    handed_out = filled(pool, 1)
    pool.finish("s1")
    assert [(each.shape, future.result().key) for each, future in handed_out.take_done()] == [
        ("s1", "s1")
    ]
    assert handed_out.shapes == ("s0",)
    assert handed_out.has_room
    assert handed_out.take_done() == []


def test_taken_back_is_what_was_not_begun_whatever_the_executor_knows(pool):
    handed_out = filled(pool, 2)
    pool.futures["s3"].set_running_or_notify_cancel()
    handed_out.take_back()
    assert handed_out.shapes == ("s0", "s1", "s3")
    assert pool.futures["s2"].cancelled()


def test_at_the_end_all_are_given_up(pool):
    with pytest.raises(KeyboardInterrupt), filled(pool, 1):
        raise KeyboardInterrupt
    assert all(future.cancelled() for future in pool.futures.values())
