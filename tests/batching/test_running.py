"""Who tries again, and when: told by answers that no child had to be started for."""

from __future__ import annotations

import pickle
import threading

import pytest

from moseg_core.batching import running
from moseg_core.batching.jobs import Job
from moseg_core.batching.running import close_children, forget_children, run_job
from moseg_core.errors import MosegError, UsageError

JOB = Job(
    shape="m/a.off",
    here="/here",
    folder="/here/out",
    outputs=("/here/out/a.json",),
    instructions="{}",
    key="0f",
    seed=5,
    versions={"numpy": "2.1"},
)
OK = {"kind": "ok", "files": ["/here/out/a.json"], "seconds": 1.0, "cost": 0.5, "parts": ["a"]}
BAD = {"kind": "bad shape", "message": "cut off", "seconds": 0.1}
KILLED = {"kind": "crashed", "signal": 9, "message": "was ended by SIGKILL", "seconds": 0.1}
CRASHED = {"kind": "crashed", "signal": 11, "message": "was ended by SIGSEGV", "seconds": 0.1}
RAISED = {"kind": "plugin error", "message": "no idea", "seconds": 0.1}


@pytest.fixture
def children(monkeypatch):
    """Children that answer what the test says; the list of those that were started."""

    class Children(list):
        def __init__(self):
            super().__init__()
            self.answers, self.versions = [], {"numpy": "2.1"}

    class Child:
        def __init__(self):
            self.versions = children.versions
            self.jobs, self.alive, self.ended = 0, True, False
            self.asked = []
            children.append(self)

        def ask(self, request, *, timeout, memory):
            self.jobs += 1
            self.asked.append(request)
            answer = children.answers.pop(0)
            self.alive = "signal" not in answer
            return dict(answer)

        def end(self):
            self.ended = True

        kill = end

    children = Children()
    monkeypatch.setattr(running, "GuardedChild", Child)
    yield children
    forget_children([threading.get_ident()])
    assert all(child.ended for child in children)


def test_a_job_can_be_sent_anywhere():
    assert pickle.loads(pickle.dumps(JOB)) == JOB
    assert pickle.loads(pickle.dumps(run_job)) is run_job


def test_a_child_stays_warm(children):
    children.answers = [OK, OK]
    outcome = run_job(JOB)
    assert (outcome.kind, outcome.key, outcome.files) == ("ok", "0f", ("a.json",))
    run_job(JOB)
    assert len(children) == 1
    assert children[0].asked[0]["seed"] == 5


def test_what_fails_in_a_fresh_child_has_failed(children):
    children.answers = [RAISED]
    assert run_job(JOB).kind == "plugin error"
    assert children[0].ended  # who knows what it has left behind


def test_a_fresh_child_that_a_shape_was_bad_for_stays(children):
    children.answers = [BAD, OK]
    assert run_job(JOB).kind == "bad shape"
    assert run_job(JOB).ok
    assert len(children) == 1


@pytest.mark.parametrize("failure", [RAISED, CRASHED, BAD])
def test_what_fails_in_a_warm_child_is_done_again_in_a_fresh_one(children, failure):
    children.answers = [OK, failure, OK]
    run_job(JOB)
    assert run_job(JOB).ok
    assert len(children) == 2
    children.answers = [failure, failure]
    assert run_job(JOB).kind == failure["kind"]
    assert len(children) == 3


def test_who_kills_a_child_says_nothing_of_the_shape(children):
    children.answers = [KILLED, KILLED, OK]
    assert run_job(JOB).ok
    children.answers = [KILLED] * 4
    assert run_job(JOB).kind == "crashed"
    assert not children.answers


def test_other_versions_are_refused_by_name(children):
    children.versions = {"numpy": "2.0"}
    with pytest.raises(UsageError, match=r"other versions .* numpy is 2\.1 here and 2\.0 there"):
        run_job(JOB)


def test_no_child_gets_older_than_it_should(children, monkeypatch):
    monkeypatch.setattr(running, "_MOST_JOBS", 2)
    children.answers = [OK] * 5
    for _ in range(5):
        assert run_job(JOB).ok
    assert [child.jobs for child in children] == [2, 2, 1]


def test_a_batch_that_is_ended_starts_no_children(children):
    children.answers = [OK]
    run_job(JOB)
    close_children([threading.get_ident()])
    with pytest.raises(MosegError, match="the batch was ended"):
        run_job(JOB)
