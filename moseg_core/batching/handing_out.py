"""Jobs that an executor has: few at a time, and taken back where somebody asks to stop.

Thousands of jobs handed out at once would wait where nobody can see them, and Ctrl-C would have to
wait for them. So each worker has one job that it does and :data:`_WAITING` that wait for it. What
is made of the answers is the business of whoever hands out: the driver of a batch
(:mod:`moseg_core.batching.driver`), and the maker of its page
(:mod:`moseg_core.batching.report.making`).
"""

from __future__ import annotations

from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from types import TracebackType
from typing import Self

from moseg_core.batching.jobs import Job
from moseg_core.batching.outcome import Outcome
from moseg_core.batching.running import run_job

REPORT_EVERY = 0.2
"""Seconds between two reports while nothing happens."""

#: Jobs that wait with the executor for each worker, so that none is idle while the driver writes.
_WAITING = 1


class HandedOut:
    """The jobs that an executor has.

    Left as a context, it gives up what is still there.

    Parameters
    ----------
    pool : concurrent.futures.Executor
    count : int
        How many jobs its workers do at a time.
    """

    def __init__(self, pool: Executor, count: int) -> None:
        self._pool, self._count = pool, count
        self._jobs: dict[Future[Outcome], Job] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for future in self._jobs:
            future.cancel()

    def __len__(self) -> int:
        return len(self._jobs)

    @property
    def shapes(self) -> tuple[str, ...]:
        """Paths of the shapes that are under way."""
        return tuple(job.shape for job in self._jobs.values())

    @property
    def has_room(self) -> bool:
        """Whether another job may be handed out."""
        return len(self._jobs) < (1 + _WAITING) * self._count

    def add(self, job: Job) -> None:
        """Hand out a job."""
        self._jobs[self._pool.submit(run_job, job)] = job

    def take_done(self) -> list[tuple[Job, Future[Outcome]]]:
        """Those that are done; waits for the first, but no longer than :data:`REPORT_EVERY`."""
        done = wait(self._jobs, REPORT_EVERY, return_when=FIRST_COMPLETED).done
        return [(self._jobs.pop(future), future) for future in done]

    def take_back(self) -> None:
        """Take back what was not begun.

        Not all executors know what is under way, and those of a cluster would give that up too: the
        first handed out are.
        """
        for future in list(self._jobs)[self._count :]:
            if future.cancel():
                del self._jobs[future]
