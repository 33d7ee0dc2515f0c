"""``run_job``: what an executor is given, in whichever thread, process or machine that runs it.

Each thread that runs jobs keeps a guarded child (:mod:`moseg_core.batching.guard`), started with
its first job and warm for the next ones: to start one takes as long as several small shapes do. A
warm child is not as good as new, though. It may have less memory, a thread that some component has
left behind, or a component that remembers what it should not. So what fails in a warm child is done
once more, alone, in a fresh one, and only that outcome counts. A child that was killed from
outside (by hand, by the system) says nothing of the shape, and the job is done again likewise.
"""

from __future__ import annotations

import os
import platform
import signal
import threading
from typing import Any

from moseg_core.batching.guard import GuardedChild
from moseg_core.batching.jobs import Job
from moseg_core.batching.outcome import Outcome
from moseg_core.batching.versions import difference
from moseg_core.errors import MosegError, UsageError

#: Jobs after which a child is as old as it gets: what it has kept of them is given back.
_MOST_JOBS = 250
#: How often a job is begun whose children are killed by others.
_MOST_ATTEMPTS = 4


class EndedError(MosegError):
    """The batch was ended, and this job with it; nothing is said of its shape."""


class _Keeper:
    """The child of one thread."""

    def __init__(self) -> None:
        self._child: GuardedChild | None = None
        self._lock = threading.Lock()
        self._closed = False

    def child(self) -> GuardedChild:
        """The child, started where there is none."""
        if self._child is not None and (self._child.jobs >= _MOST_JOBS or not self._child.alive):
            self.drop()
        if self._child is None:
            if self._closed:
                raise EndedError("the batch was ended")
            child = GuardedChild()
            with self._lock:
                self._child = child
        if self._closed:  # meanwhile
            self.drop()
            raise EndedError("the batch was ended")
        return self._child

    def drop(self) -> None:
        """End the child; the next job has a fresh one."""
        with self._lock:
            child, self._child = self._child, None
        if child is not None:
            child.end()

    def close(self) -> None:
        """Let no job be done any more; from any thread."""
        self._closed = True
        with self._lock:
            if self._child is not None:
                self._child.kill()

    @property
    def closed(self) -> bool:
        """Whether no job is to be done any more."""
        return self._closed


_keepers: dict[int, _Keeper] = {}


def run_job(job: Job) -> Outcome:
    """Do a job in the guarded child of this thread.

    Parameters
    ----------
    job : Job

    Returns
    -------
    Outcome
        Of whatever kind: what a shape or a component does never raises here.

    Raises
    ------
    UsageError
        The child has other versions than the job asks for.
    MosegError
        No child can be started; or the batch was ended.
    """
    keeper = _keepers.setdefault(threading.get_ident(), _Keeper())
    answer: dict[str, Any] = {}
    for _ in range(_MOST_ATTEMPTS):
        child = keeper.child()
        if job.versions and (differs := difference(job.versions, child.versions)):
            raise UsageError(
                f"'{platform.node()}' has other versions than the computer that leads the batch:"
                f" {differs}; install the same there"
            )
        warm = child.jobs > 0
        answer = child.ask(_request(job), timeout=job.timeout, memory=job.memory)
        if keeper.closed:
            keeper.drop()
            raise EndedError("the batch was ended")
        if answer["kind"] == "ok":
            return _outcome(job, answer)
        if not (answer["kind"] == "bad shape" and not warm):
            keeper.drop()
        from_outside = answer["kind"] == "crashed" and answer.get("signal") == signal.SIGKILL
        if not warm and not from_outside:
            break
    return _outcome(job, answer)


def close_children(threads: list[int]) -> None:
    """End the children of threads, by the numbers of these; they start no others.

    Parameters
    ----------
    threads : list of int
        As :func:`threading.get_ident` tells.
    """
    for thread in threads:
        if thread in _keepers:
            _keepers[thread].close()


def end_children() -> None:
    """End the children of all threads of this process; jobs that come later have others.

    What a cluster's workers are asked to do when a batch ends (:mod:`moseg_core.batching.cluster`).
    A job of another batch that is at work there raises :class:`EndedError`, and is handed out
    again.
    """
    threads = list(_keepers)
    close_children(threads)
    forget_children(threads)


def forget_children(threads: list[int]) -> None:
    """Let go of the children of threads that have ended: another may get the number."""
    for thread in threads:
        keeper = _keepers.pop(thread, None)
        if keeper is not None:
            keeper.drop()


def _request(job: Job) -> dict[str, Any]:
    return {
        "task": job.task,
        "shape": job.shape,
        "here": job.here,
        "outputs": list(job.outputs),
        "instructions": job.instructions,
        "seed": job.seed,
    }


def _outcome(job: Job, answer: dict[str, Any]) -> Outcome:
    """The child's answer as an outcome; files as seen from the batch's folder."""
    files = [os.path.relpath(file, job.folder) for file in answer.get("files", [])]
    return Outcome(
        shape=job.shape,
        key=job.key,
        kind=answer["kind"],
        message=answer.get("message", ""),
        component=answer.get("component", ""),
        files=tuple(files),
        cost=answer.get("cost"),
        parts=tuple(answer.get("parts", ())),
        warnings=tuple(answer.get("warnings", ())),
        seconds=answer["seconds"],
    )
