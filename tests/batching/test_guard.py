"""Whatever happens in a guarded child is an answer: its own, or what became of it."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from moseg_core.batching.guard import GuardedChild
from moseg_core.batching.versions import own_versions
from moseg_core.errors import MosegError
from tests.batching.planted import INSTRUCTIONS, write_shape


@pytest.fixture
def ask(planted_bundle, tmp_path):
    """Have a shape of some name done by a child."""

    def do(child, name, *, timeout=120.0, memory=None):
        request = {
            "task": "solve",
            "shape": str(write_shape(tmp_path, name)),
            "here": str(tmp_path),
            "outputs": [str(tmp_path / f"{name}.json")],
            "instructions": INSTRUCTIONS.text(),
            "seed": 0,
        }
        return child.ask(request, timeout=timeout, memory=memory)

    return do


@pytest.fixture
def child(planted_bundle):
    child = GuardedChild()
    yield child
    child.end()


def test_a_child_does_one_job_after_another_and_noise_does_not_come_between(child, ask, tmp_path):
    assert child.versions == own_versions()
    process = child._process.pid
    assert os.getsid(process) == process
    assert b"OMP_NUM_THREADS=1" in Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
    assert [ask(child, name)["kind"] for name in ("a", "noise", "raise", "b")] == [
        *("ok", "ok", "plugin error", "ok")
    ]
    assert child.alive
    assert child.jobs == 4
    # A job that takes too long is ended, and so is the child; an hour's sleep is not waited for.
    answer = ask(child, "hang", timeout=0.5)
    assert answer["kind"] == "timeout"
    assert answer["message"].startswith("its process took longer than 0.5 s and was ended while")
    assert "planted:planted" in answer["component"]
    assert not child.alive
    assert ask(child, "a")["kind"] == "crashed"
    child.end()
    child.end()


def test_memory_is_limited_by_what_is_held(child, ask):
    answer = ask(child, "hog", memory=0.6e9)
    assert answer["kind"] == "out of memory"
    assert "planted:planted" in answer["message"]


def test_a_child_that_is_killed_is_told_with_its_signal_and_leaves_nothing_open(ask):
    before = len(os.listdir("/proc/self/fd"))
    child = GuardedChild()
    process = child._process.pid
    answer = ask(child, "killed")
    assert (answer["kind"], answer["signal"]) == ("crashed", signal.SIGKILL)
    assert "was ended by SIGKILL while objective 'planted:planted'" in answer["message"]
    child.end()
    assert len(os.listdir("/proc/self/fd")) == before
    assert not Path(f"/proc/{process}").exists()


def test_a_child_that_cannot_start_says_so(monkeypatch, tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import os\nos._exit(3)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    before = len(os.listdir("/proc/self/fd"))
    with pytest.raises(MosegError, match="ended with exit code 3 and without an answer before"):
        GuardedChild()
    assert len(os.listdir("/proc/self/fd")) == before
