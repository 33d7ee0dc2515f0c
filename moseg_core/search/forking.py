"""Whether this process can be copied now (``fork``), and if not, why.

A copy has the locks that other threads hold, and not the threads that would let go of them. Worse,
libraries for linear algebra want all their threads at rest before a copy is made, and wait for
that: where another thread multiplies matrices, perhaps for ever. Threads that wait, as those of
a notebook do, are no danger. So the threads of Python that do something are looked for
(:func:`running_threads`); those of moseg rest, or are gone, by then.

A process of :class:`multiprocessing.Pool` may have no children of its own. And each process takes
some descriptors of the one that makes it, which needs the rest of them for its results.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
from contextlib import ExitStack
from pathlib import Path

#: How often the threads are looked at, and the seconds from one time to the next: one that has
#: just been given something to do needs a moment to get at it.
_LOOKS, _BETWEEN = 4, 0.002
#: Descriptors that a process takes while it is made, and those that are left for everything else.
_TAKEN, _LEFT = 8, 16


def can_fork() -> bool:
    """Whether the system copies processes at all."""
    return "fork" in multiprocessing.get_all_start_methods()


def hindrance() -> str:
    """Why this process should not be copied now; empty where nothing speaks against it.

    Examples
    --------
    >>> hindrance()
    ''
    """
    if multiprocessing.current_process().daemon:
        return "this process is one of a pool, and may make none of its own"
    running = running_threads()
    if running:
        named = ", ".join(f"'{name}'" for name in running[:3])
        more = ", ..." if len(running) > 3 else ""
        are = f"s {named}{more} are" if len(running) > 1 else f" {named} is"
        return (
            f"the thread{are} running, and a process with running threads cannot be copied safely"
        )
    if not _descriptors_are_left():
        return f"there are not {_TAKEN + _LEFT} descriptors left for another process (ulimit -n)"
    return ""


def running_threads() -> list[str]:
    """Names of the other threads of Python that are doing something, rather than wait.

    A thread waits where, looked at several times within some milliseconds, it is never ready to run
    and has used no processor time. Where the system does not tell, all are taken to run.
    """
    here = threading.current_thread()
    others = [thread for thread in threading.enumerate() if thread is not here]
    if not others:
        return []
    before = {thread: _state(thread) for thread in others}
    busy = {thread for thread, (state, _) in before.items() if state not in ("S", "")}
    for _ in range(_LOOKS):
        time.sleep(_BETWEEN)  # lets go of the interpreter, for which some may have been waiting
        for thread in others:
            state, seconds = _state(thread)
            if state not in ("S", "") or (state and seconds != before[thread][1]):
                busy.add(thread)
    return [thread.name for thread in others if thread in busy and thread.is_alive()]


def _state(thread: threading.Thread) -> tuple[str, str]:
    """What a thread is doing and its processor time, as Linux tells it.

    "S" for one that waits, "R" for one that could run, "" for one that is gone; "?" where nobody
    tells.
    """
    tasks = Path("/proc/self/task")
    folder = tasks / str(thread.native_id)
    try:
        state = (folder / "stat").read_text().rpartition(")")[2].split()
        return state[0], " ".join((*state[11:13], *_precise_time(folder)))
    except OSError:
        return ("" if (tasks / str(threading.get_native_id())).exists() else "?"), ""


def _precise_time(folder: Path) -> list[str]:
    """Nanoseconds on a processor, where the system counts them."""
    try:
        return (folder / "schedstat").read_text().split()[:1]
    except OSError:
        return []


def _descriptors_are_left() -> bool:
    """Whether a process can be made and files written afterwards."""
    with ExitStack() as stack:
        try:
            for _ in range((_TAKEN + _LEFT) // 2):
                for end in os.pipe():
                    stack.callback(os.close, end)
        except OSError:
            return False
    return True
