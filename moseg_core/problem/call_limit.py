"""A limit on how long a call of an objective may take, in seconds.

An objective that never returns would end a run without a result. Within :func:`limiting_calls` each
call (:func:`limited`) that takes longer than allowed ends, wherever it is, in a
:class:`CallTimeoutError`, from which :mod:`moseg_core.problem.calls` makes an error that names the
objective; what was found so far is kept, as for objectives that raise.

Two stages. An alarm of the system's clock has Python raise the error, which works in code that
comes back to the interpreter. Code in other languages may not: so every process writes when its
call is due, and for what, into memory that it shares with a watcher, a process of its own, which
kills who has not come back a while after. A worker's task is then tried again, and lost again, and
the error of :mod:`moseg_core.search.workers` names the objective; a process without workers is lost
with what it has found, and the watcher says why.

Off by default, since what a search finds then depends on the machine.
"""

from __future__ import annotations

import mmap
import os
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from types import FrameType, TracebackType

from moseg_core.errors import UsageError

#: Processes find their place by their number. First come the times when calls are due, then names.
_PLACES = 4096
_DUE = struct.Struct("d")
_CALL = struct.Struct("q248s")
_SIZE = _PLACES * (_DUE.size + _CALL.size)

#: How long after the alarm a call is taken to be deaf, as a share of the limit, and in seconds.
_GRACE = 0.5, 1.0
#: Seconds between two alarms, of which a call may swallow some.
_AGAIN = 0.25
#: Seconds between two looks of the watcher.
_LOOK = 0.1

_NOTHING = nullcontext()


class CallTimeoutError(BaseException):
    """A call has taken too long; no :class:`Exception`, which it might catch itself.

    Parameters
    ----------
    seconds : float
        What it was allowed.
    """

    def __init__(self, seconds: float) -> None:
        super().__init__(f"it took more than {seconds:g} s")
        self.seconds = seconds


class _Limit(AbstractContextManager[None]):
    """The limit that is on; entered and left with each call, which do not nest."""

    def __init__(self, seconds: float, memory: mmap.mmap) -> None:
        self.seconds, self.memory = seconds, memory
        self.name = b""
        self._running = False

    def __enter__(self) -> None:
        process = os.getpid()
        place = process % _PLACES
        due = time.monotonic() + self.seconds * (1 + _GRACE[0]) + _GRACE[1]
        _CALL.pack_into(self.memory, _PLACES * _DUE.size + place * _CALL.size, process, self.name)
        _DUE.pack_into(self.memory, place * _DUE.size, due)
        self._running = True
        if threading.current_thread() is threading.main_thread():
            signal.setitimer(signal.ITIMER_REAL, self.seconds, _AGAIN)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._running = False
        if threading.current_thread() is threading.main_thread():
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        _DUE.pack_into(self.memory, os.getpid() % _PLACES * _DUE.size, 0.0)

    def ring(self, number: int, frame: FrameType | None) -> None:
        """Handle the alarm."""
        # In a frame of this context itself the call has not begun, or is over: an error raised
        # there would leave the alarm on.
        own = frame is not None and frame.f_code in _FRAMES
        if self._running and not own:
            raise CallTimeoutError(self.seconds)


_FRAMES = frozenset({_Limit.__enter__.__code__, _Limit.__exit__.__code__})


_limit: _Limit | None = None


def limited(name: str) -> AbstractContextManager[None]:
    """A context for a call, which ends in an error where it takes too long.

    Parameters
    ----------
    name : str
        What is called, for messages.

    Raises
    ------
    CallTimeoutError
        It takes longer than is allowed; never where nothing is said of that.
    """
    if _limit is None:
        return _NOTHING
    _limit.name = name.encode(errors="replace")
    return _limit


def is_limited() -> bool:
    """Whether there is a limit."""
    return _limit is not None


def check_limit(seconds: float | None) -> None:
    """Refuse a limit that :func:`limiting_calls` cannot keep.

    Raises
    ------
    UsageError
        It is not positive, or the system has no alarms.
    """
    if seconds is None:
        return
    if not 0.0 < seconds < threading.TIMEOUT_MAX:
        raise UsageError(f"the limit for a call is {seconds:g} s; it must be more than 0")
    if not hasattr(signal, "setitimer"):
        raise UsageError("this system has no alarms, by which calls could be limited")


@contextmanager
def limiting_calls(seconds: float | None) -> Iterator[None]:
    """Within this context, calls of objectives may take so long; None for as long as they like.

    Takes the alarm signal of the process for itself, and is of use in its main thread only.

    Parameters
    ----------
    seconds : float or None

    Raises
    ------
    UsageError
        The limit is not positive, or the system has no alarms.

    Examples
    --------
    >>> with limiting_calls(0.05):
    ...     with limited("a long loop"):
    ...         while True:
    ...             pass
    Traceback (most recent call last):
        ...
    moseg_core.problem.call_limit.CallTimeoutError: it took more than 0.05 s
    """
    global _limit
    check_limit(seconds)
    if seconds is None:
        yield
        return
    with tempfile.TemporaryFile() as file:
        file.truncate(_SIZE)
        memory = mmap.mmap(file.fileno(), _SIZE)
        watcher = _start_watcher(file.fileno())
        outer, _limit = _limit, _Limit(seconds, memory)
        before = signal.signal(signal.SIGALRM, _limit.ring)
        try:
            yield
        finally:
            _limit = outer
            signal.signal(signal.SIGALRM, before)
            watcher.kill()
            watcher.wait()
            memory.close()


def _start_watcher(descriptor: int) -> subprocess.Popen[bytes]:
    code = f"from {__name__} import watch; watch({descriptor}, {os.getpid()})"
    path = os.pathsep.join(path or os.getcwd() for path in sys.path)
    return subprocess.Popen(
        [sys.executable, "-c", code],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        pass_fds=(descriptor,),
        env={**os.environ, "PYTHONPATH": path},
        start_new_session=True,  # Ctrl-C is for the others
    )


def watch(descriptor: int, parent: int) -> None:
    """Kill processes whose call is overdue, until the process that asked is gone: the watcher.

    Parameters
    ----------
    descriptor : int
        Of a file that is the shared memory.
    parent : int
        The process that asked.
    """
    memory = mmap.mmap(descriptor, _SIZE)
    deaf: dict[int, float] = {}
    while os.getppid() == parent:
        time.sleep(_LOOK)
        now = time.monotonic()
        for place, due in enumerate(memoryview(memory)[: _PLACES * _DUE.size].cast("d")):
            if 0.0 < due < now and deaf.get(place) != due:
                deaf[place] = due
                start = _PLACES * _DUE.size + place * _CALL.size
                process, name = _CALL.unpack(memory[start : start + _CALL.size])
                _end(process, name.rstrip(b"\0").decode(errors="replace"))


def _end(process: int, name: str) -> None:
    """End a process, and say why; a process that is gone already needs no words."""
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        return
    print(
        f"moseg: {name} takes too long, and cannot be interrupted; its process is ended",
        file=sys.stderr,
        flush=True,
    )


def told_late(error: CallTimeoutError, where: str, place: str) -> str:
    """What is wrong with a call that took too long, after the name of the objective.

    Examples
    --------
    >>> told_late(CallTimeoutError(5), "'bore(stem)'", "bore.py:4")
    "took more than 5 s in 'bore(stem)' (bore.py:4); allow it more time, or do without it"
    """
    line = f" ({place})" if place else ""
    took = f"took more than {error.seconds:g} s"
    return f"{took} in {where}{line}; allow it more time, or do without it"
