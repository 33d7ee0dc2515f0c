"""A child process under guard: whatever happens in there is an answer here.

A :class:`GuardedChild` is a process of its own session, with BLAS and compiled loops on one thread.
The guard is asked to have a job done and comes back with an answer in any case: the child's own, or
what became of the child. It waits for the answer, for the end of the child, for the limit on time,
and looks every so often at how much memory the child and what it has started hold. A child that
exceeds a limit is ended with its whole process group.

What was at work (:mod:`moseg_core.components.at_work`) is read from memory that both share, and the
line of a crash from what ``faulthandler`` wrote.
"""

from __future__ import annotations

import contextlib
import math
import mmap
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from moseg_core.batching.wire import Inbox, send
from moseg_core.components.at_work import SIZE
from moseg_core.errors import MosegError

try:
    import resource
except ImportError:  # moseg batch needs a POSIX system, its modules can be imported anywhere
    resource = None  # type: ignore[assignment]

#: Seconds between two looks at the memory of a child.
_LOOK = 0.05
#: Seconds that a child may take to start, and to compile kernels beyond its limit on time.
_TO_START, _TO_COMPILE = 300.0, 300.0
#: Times the limit on memory that addresses may take: what asks for more never meant to use it.
_ADDRESSES = 2.0
#: Seconds that a child has to end by itself when it is told to.
_TO_END = 2.0

#: What libraries take from the environment: each child computes on one thread.
_ONE_THREAD = dict.fromkeys(
    (
        *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"),
        *("NUMBA_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"),
    ),
    "1",
)

_PYTHON = os.path.join(os.path.dirname(os.__file__), "")
_FRAME = re.compile(r'File "(.*)", line (\d+)')


class GuardedChild:
    """A process that does jobs, one at a time, and may come to harm.

    It is ended when the thread that made it ends: the thread that asks should be the one that made
    it.

    Attributes
    ----------
    versions : dict of str to str
        What the child says that it is made of.
    jobs : int
        How many it has been given.

    Raises
    ------
    MosegError
        It does not start.

    Examples
    --------
    >>> child = GuardedChild()  # doctest: +SKIP
    >>> child.ask(request, timeout=60, memory=2e9)["kind"]  # doctest: +SKIP
    'ok'
    >>> child.end()  # doctest: +SKIP
    """

    def __init__(self) -> None:
        self.jobs = 0
        self._lock = threading.Lock()
        # Files without a name: nothing is left behind, however this process ends.
        self._notes = tempfile.TemporaryFile()  # noqa: SIM115  # open as long as the child lives
        self._crashes = tempfile.TemporaryFile()  # noqa: SIM115  # likewise
        self._notes.truncate(SIZE)
        self._memory = mmap.mmap(self._notes.fileno(), SIZE)
        theirs, self._requests = os.pipe()
        self._answers, answers = os.pipe()
        passed = (theirs, answers, self._notes.fileno(), self._crashes.fileno())
        words = [sys.executable, "-m", "moseg_core.batching.child", *map(str, passed)]
        try:
            self._process = subprocess.Popen(
                [*words, str(os.getpid())],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                pass_fds=passed,
                start_new_session=True,
                env={**os.environ, **_ONE_THREAD},
            )
        except OSError as error:
            self._close()
            raise MosegError(f"a child process cannot be started: {error}") from error
        finally:
            os.close(theirs)
            os.close(answers)
        self._inbox = Inbox(self._answers)
        hello = self._wait(seconds=_TO_START, memory=None)
        if hello.get("kind") != "hello":
            self.end()
            raise MosegError(
                f"a child process {hello.get('message', 'says nonsense')} before it was ready; does"
                f" 'moseg plugin list' work?"
            )
        self.versions: dict[str, str] = hello["versions"]
        self._addresses = _addresses(self._process.pid)

    @property
    def alive(self) -> bool:
        """Whether it can be given a job."""
        return not self._over()

    def ask(
        self, request: Mapping[str, Any], *, timeout: float | None, memory: float | None
    ) -> dict[str, Any]:
        """Have a job done.

        Parameters
        ----------
        request : mapping
            What :func:`moseg_core.batching.solving.do_job` takes, ``here`` and ``seed``.
        timeout : float or None
            Seconds.
        memory : float or None
            Bytes.

        Returns
        -------
        dict
            ``kind`` and what goes with it. Where the child is no more, also ``signal``, the number
            of the signal that ended it, or 0.
        """
        self.jobs += 1
        began = time.monotonic()
        killed_before = _killed_for_memory()
        self._limit_addresses(memory)
        try:
            send(self._requests, request)
            answer = self._wait(seconds=timeout, memory=memory)
        except OSError:
            answer = self._lost()
        killed = answer["kind"] == "crashed" and answer["signal"] == signal.SIGKILL
        if killed and _killed_for_memory() > killed_before:
            answer["kind"] = "out of memory"
            answer["message"] = "was ended by the system for want of memory"
        if "signal" in answer:
            said = f"its process {answer['message']}"
            said += f" while {answer['component']} was at work" if answer["component"] else ""
            answer["message"] = said + (f" ({answer['place']})" if answer.get("place") else "")
        return {"seconds": round(time.monotonic() - began, 3), **answer}

    def end(self) -> None:
        """End the child and what it has started; may be called from any thread, and again."""
        self._kill()
        self._close()

    def _close(self) -> None:
        for close in (self._memory.close, self._notes.close, self._crashes.close):
            close()
        for name in ("_requests", "_answers"):
            descriptor = getattr(self, name)
            if descriptor >= 0:
                setattr(self, name, -1)
                os.close(descriptor)

    def kill(self) -> None:
        """End the process alone, whoever waits for it hears of that; from any thread."""
        self._kill()

    def _kill(self) -> None:
        """End the process group, if it has not been: its number may be another's afterwards."""
        with self._lock:
            if self._process.returncode is not None:
                return
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            with contextlib.suppress(subprocess.TimeoutExpired):  # stuck in the kernel
                self._process.wait(5 * _TO_END)

    def _over(self) -> bool:
        """Whether the process has ended; it is not waited for, so that its number stays its own."""
        with self._lock:
            if self._process.returncode is not None:
                return True
            how = os.WEXITED | os.WNOHANG | os.WNOWAIT
            return os.waitid(os.P_PID, self._process.pid, how) is not None

    def _wait(self, *, seconds: float | None, memory: float | None) -> dict[str, Any]:
        """The child's answer, or what became of it."""
        deadline = math.inf if seconds is None else time.monotonic() + seconds
        compiling: float | None = None
        poll = select.poll()
        poll.register(self._answers, select.POLLIN)
        while True:
            try:
                message = self._inbox.pending()
            except ValueError:
                self._kill()
                return {**self._lost(), "message": "wrote nonsense to the pipe of its guard"}
            if message is not None:
                kind = message.get("kind")
                if kind == "compiling":
                    compiling = time.monotonic()
                elif kind == "compiled" and compiling is not None:
                    deadline += min(time.monotonic() - compiling, _TO_COMPILE)
                    compiling = None
                else:
                    return message
                continue
            due = deadline
            if compiling is not None:
                due += min(time.monotonic() - compiling, _TO_COMPILE)
            left = due - time.monotonic()
            if left <= 0:
                return self._ended("timeout", f"took longer than {seconds:g} s and was ended")
            if memory is not None and (held := _held(self._process.pid)) > memory:
                return self._ended(
                    "out of memory",
                    f"took {held / 1e9:.3g} GB, more than {memory / 1e9:g} GB, and was ended",
                )
            pause = min(left, _LOOK if memory is not None else 3600.0)
            if poll.poll(math.ceil(pause * 1000)) and not self._fetched():
                return self._lost()

    def _fetched(self) -> bool:
        try:
            return self._inbox.fetch()
        except OSError:
            return False

    def _ended(self, kind: str, message: str) -> dict[str, Any]:
        """End the child; an answer that says why."""
        component = self._at_work()
        self._kill()
        return {"kind": kind, "message": message, "component": component, "signal": 0}

    def _lost(self) -> dict[str, Any]:
        """What became of a child that is no more, or does not answer any more."""
        deadline = time.monotonic() + _TO_END
        while not (over := self._over()) and time.monotonic() < deadline:
            time.sleep(0.01)
        component, place = self._at_work(), self._place()
        self._kill()
        code = self._process.returncode if over else None
        answer = {"kind": "crashed", "component": component, "place": place, "signal": 0}
        if code is None:
            return {**answer, "message": "closed the pipe to its guard"}
        if code >= 0:
            return {**answer, "message": f"ended with exit code {code} and without an answer"}
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = f"signal {-code}"
        return {**answer, "message": f"was ended by {name}", "signal": -code}

    def _at_work(self) -> str:
        """The component that was at work when the child last wrote."""
        return self._memory[:].split(b"\0", 1)[0].decode(errors="replace")

    def _place(self) -> str:
        """File and line of Python where a crash came; empty for none."""
        self._crashes.seek(0)
        text = self._crashes.read(1 << 16).decode(errors="replace")
        frames = [f"{file}:{line}" for file, line in _FRAME.findall(text)]
        # Innermost first; what Python brings itself was only called.
        own = [frame for frame in frames if not frame.startswith(_PYTHON) or "-packages" in frame]
        return next(iter(own or frames), "")

    def _limit_addresses(self, memory: float | None) -> None:
        """Limit the addresses that the child may take; none where memory is not limited."""
        if resource is None or not hasattr(resource, "prlimit") or not self._addresses:
            return
        most = resource.RLIM_INFINITY
        if memory is not None:
            most = int(self._addresses + _ADDRESSES * memory)
        with contextlib.suppress(OSError, ValueError):
            _, hard = resource.prlimit(self._process.pid, resource.RLIMIT_AS)
            if most != resource.RLIM_INFINITY or hard == resource.RLIM_INFINITY:
                resource.prlimit(self._process.pid, resource.RLIMIT_AS, (most, hard))


def _held(process: int) -> int:
    """Bytes of memory that a process and its descendants hold; 0 where the system does not tell."""
    total, waiting = 0, [process]
    while waiting:
        number = waiting.pop()
        total += _status(number, "VmRSS:")
        with contextlib.suppress(OSError):
            for thread in os.listdir(f"/proc/{number}/task"):
                text = Path(f"/proc/{number}/task/{thread}/children").read_text("ascii")
                waiting += map(int, text.split())
    return total


def _addresses(process: int) -> int:
    """Bytes of addresses that a process has taken; 0 where the system does not tell."""
    return _status(process, "VmSize:")


def _status(process: int, name: str) -> int:
    try:
        text = Path(f"/proc/{process}/status").read_text("ascii", errors="replace")
    except OSError:
        return 0
    line = next((line for line in text.splitlines() if line.startswith(name)), "")
    return int(line.split()[1]) * 1024 if line else 0


def _killed_for_memory() -> int:
    """How many processes the kernel has ended so far for want of memory."""
    try:
        text = Path("/proc/vmstat").read_text("ascii")
    except OSError:
        return 0
    line = next((line for line in text.splitlines() if line.startswith("oom_kill ")), "")
    return int(line.split()[1]) if line else 0
