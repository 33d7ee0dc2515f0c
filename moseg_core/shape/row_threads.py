"""Rows of a batch shared among threads: kernels release the GIL.

Partitions and sums of a batch of labellings do not depend on each other, and each is written to
its own rows of an array. Threads are made for the batch and gone with it, so that a process may be
copied in between (:mod:`moseg_core.search.workers`). To make one takes about as long as a kernel
takes for a thousand elements; so small batches are done without.

``OMP_NUM_THREADS``, by which libraries are told how many threads they may have, counts here too.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

#: Seconds of work below which threads take longer to start than they save.
_WORTH_THREADS = 1e-3
#: Among how many processes of one program the processors are shared.
_processes = 1


def share_processors(processes: int) -> None:
    """Say that so many processes work side by side, of which this is one.

    Each makes as many threads as there are processors for it, so that no two threads of theirs
    wait for one processor.

    Parameters
    ----------
    processes : int
        1 or more.
    """
    global _processes  # a process is one of several for as long as it lives
    _processes = processes


def available_processors() -> int:
    """Processors that this process may use, where the system tells; all of them elsewhere."""
    affinity = getattr(os, "sched_getaffinity", None)
    return len(affinity(0)) if affinity is not None else os.cpu_count() or 1


def over_rows(work: Callable[[int, int], None], count: int, *, seconds: float) -> None:
    """Do the work for rows ``first`` to ``end - 1``, for stretches that make up all rows.

    Parameters
    ----------
    work : callable
        Called with ``first`` and ``end``, by several threads at a time.
    count : int
        How many rows there are.
    seconds : float
        About how long all of it takes.

    Examples
    --------
    >>> done = []
    >>> over_rows(lambda first, end: done.extend(range(first, end)), 5, seconds=1.0)
    >>> sorted(done)
    [0, 1, 2, 3, 4]
    """
    threads = min(count, _allowed())
    if threads < 2 or seconds < _WORTH_THREADS:
        work(0, count)
        return
    ends = [count * k // threads for k in range(threads + 1)]
    with ThreadPoolExecutor(threads - 1) as pool:  # this thread has a share too
        try:
            others = [pool.submit(work, *ends[k : k + 2]) for k in range(1, threads)]
        except RuntimeError:  # the system makes no thread: this one does it all
            pool.shutdown(cancel_futures=True)
            others, ends = [], [0, count]
        work(*ends[:2])
        for other in others:
            other.result()


def _allowed() -> int:
    """Threads that this process may have, beside others and by whoever started it."""
    own = max(1, available_processors() // _processes)
    said = os.environ.get("OMP_NUM_THREADS", "")
    return min(own, max(1, int(said))) if said.isascii() and said.isdigit() else own
