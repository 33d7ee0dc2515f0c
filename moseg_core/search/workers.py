"""Work for several processes: the starts of a run side by side.

The starts of a run do not depend on each other, and the libraries that the objectives spend their
time in do not run on two threads at once; so they go to processes. These are copies of the
running one (``fork``), made when there is first something to do: shape, problem and components
need no pickling to get there, only results do to come back. No thread of moseg runs meanwhile: a
copy has the locks that other threads hold, and not the threads that would let go of them. Where the
system cannot fork, or one process is asked for, everything is done in this one, one thing after the
other.

Anything else that is done many times can be shared among them likewise, such as the models of a
collection; so :class:`Workers` is public. Tasks are functions that take ``report`` by keyword.

What is computed does not depend on the number of processes. Reports go to the caller's function as
ever, those of the first task that is still running; asked to stop, all are.
"""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from types import TracebackType
from typing import Any, Self

from moseg_core.components.at_work import SIZE, is_apart, note_in, noted
from moseg_core.components.faults import FAULTS
from moseg_core.components.profile import is_profiling
from moseg_core.components.protocols import Progress, Report
from moseg_core.errors import MosegError, PluginError
from moseg_core.problem.slow_calls import rest
from moseg_core.shape.row_threads import available_processors

Task = Callable[..., Any]
"""Called with its arguments and ``report``."""

Enough = Callable[[int, Any], bool]
"""Whether the result of the task with this number makes all others needless."""


def available_workers() -> int:
    """Processors that this process may use, where the system tells; all of them elsewhere."""
    return available_processors()


def can_fork() -> bool:
    """Whether processes can be copied here."""
    return "fork" in multiprocessing.get_all_start_methods()


#: Seconds that a process has to end after it was told to.
_PATIENCE = 5.0


@dataclass(eq=False)
class _Worker:
    process: Any
    pipe: Connection
    #: Memory in which the process notes which component is at work.
    memory: Any
    #: Number of the task that it is at, or -1.
    task: int = -1


class Workers:
    """Processes that do tasks for this one.

    Parameters
    ----------
    tasks : mapping of str to callable
    count : int
        How many processes; with 1 this one does it all.
    report : callable
        Receives progress; True asks to stop.

    Examples
    --------
    >>> with Workers({"square": lambda x, report: x * x}, 2, lambda progress: False) as workers:
    ...     workers.map("square", [(1,), (2,), (3,)])
    [1, 4, 9]
    """

    def __init__(self, tasks: Mapping[str, Task], count: int, report: Report) -> None:
        self._tasks, self._report = tasks, report
        self._count = count if can_fork() else 1
        self._workers: list[_Worker] = []
        self._stopped = False
        self._flag: Any = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for worker in self._workers:
            worker.process.kill()  # nothing to wind up there; and it may not listen to less
            worker.pipe.close()
        for worker in self._workers:
            worker.process.join(_PATIENCE)
        self._workers = []

    def map(
        self, name: str, arguments: Sequence[tuple[Any, ...]], *, enough: Enough | None = None
    ) -> list[Any]:
        """Do a task once for each of several tuples of arguments.

        Parameters
        ----------
        name : str
        arguments : sequence of tuple
        enough : callable, optional
            Told the number and the result of each task that is done; True ends the matter, and
            what is under way is asked to stop.

        Returns
        -------
        list
            Results in order. Shorter than `arguments` where it was enough before, or somebody
            asked to stop: without those that were never begun.

        Raises
        ------
        MosegError
            A process died. Whatever a task raises is raised here.
        """
        # A single task goes to another process too where that may be lost, and this one may not.
        least = 1 if is_apart() and not is_profiling() and can_fork() else 2
        if min(self._count, len(arguments)) < least:
            return self._alone(name, arguments, enough)
        self._fork()
        self._flag.value = 0
        done: dict[int, Any] = {}
        waiting = list(range(len(arguments)))
        ended = self._stopped
        shown: Progress | None = None
        while True:
            for worker in self._workers:
                if worker.task < 0 and waiting and not ended:
                    worker.task = waiting.pop(0)
                    self._send(worker, (name, arguments[worker.task]))
            busy = [worker for worker in self._workers if worker.task >= 0]
            if not busy:
                return [done[k] for k in sorted(done)]
            for pipe in wait([worker.pipe for worker in busy]):
                worker = next(worker for worker in busy if worker.pipe is pipe)
                progress, result = self._receive(worker)
                if progress is not None:
                    # Shown is the first task's progress; to stop, any message is an occasion.
                    first = worker.task == min(other.task for other in busy if other.task >= 0)
                    shown = progress if first or shown is None else bettered(shown, progress)
                    self._stopped = self._report(shown) or self._stopped
                else:
                    done[worker.task] = result
                    if enough is not None and enough(worker.task, result):
                        ended = True
                    worker.task = -1
                if self._stopped or ended:
                    ended, self._flag.value = True, 1

    def _alone(
        self, name: str, arguments: Sequence[tuple[Any, ...]], enough: Enough | None
    ) -> list[Any]:
        """The same in this process."""

        def listen(progress: Progress) -> bool:
            self._stopped = self._report(progress) or self._stopped
            return self._stopped

        done: list[Any] = []
        for k, given in enumerate(arguments):
            if self._stopped:
                break
            done.append(self._tasks[name](*given, report=listen))
            if enough is not None and enough(k, done[-1]):
                break
        return done

    def _fork(self) -> None:
        """Make the processes, where that has not been done."""
        if self._workers:
            return
        rest()
        context = multiprocessing.get_context("fork")
        self._flag = context.RawValue("b", 0)
        for _ in range(self._count):
            mine, theirs = context.Pipe()
            # Python from 3.12 on warns of locks that other threads might hold. None of ours runs
            # now: the watch rests, and the command line draws its progress bars without a thread
            # (moseg_core.cli.console). Libraries that keep threads (BLAS) look after themselves.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                ours = [*(worker.pipe for worker in self._workers), mine]
                memory = context.RawArray("c", SIZE)
                process = context.Process(
                    target=_serve, args=(self._tasks, theirs, ours, self._flag, memory), daemon=True
                )
                process.start()
            theirs.close()
            self._workers.append(_Worker(process, mine, memory))

    def _send(self, worker: _Worker, task: tuple[str, tuple[Any, ...]]) -> None:
        """Give a worker something to do."""
        try:
            worker.pipe.send(task)
        except OSError as error:
            raise _lost(worker) from error

    def _receive(self, worker: _Worker) -> tuple[Progress | None, Any]:
        """What a worker sends: progress, or a result."""
        try:
            kind, content = worker.pipe.recv()
        except (EOFError, OSError) as error:
            raise _lost(worker) from error
        if kind == "error":
            failure, cause = content
            raise failure from cause
        return (content, None) if kind == "progress" else (None, content)


def bettered(shown: Progress, other: Progress) -> Progress:
    """The progress of one task, with the best cost that it and another have found in its stage."""
    if shown.stage != other.stage or shown.best is None or other.best is None:
        return shown
    return replace(shown, best=min(shown.best, other.best))


def _lost(worker: _Worker) -> MosegError:
    """The error about a process that is no more."""
    worker.process.join(_PATIENCE)
    code = worker.process.exitcode
    why = f"exit code {code}" if code is None or code >= 0 else f"signal {-code}"
    component = noted(worker.memory)
    during = f" while {component} was at work" if component else ""
    return MosegError(
        f"a worker process ended early ({why}){during}; with one worker there is none to lose"
    )


def _serve(
    tasks: Mapping[str, Task],
    pipe: Connection,
    others: Sequence[Connection],
    flag: Any,
    memory: Any,
) -> None:
    """What a process does: one task after the other, until the pipe is closed.

    `others` are the ends of pipes that belong to the process that was copied: while a copy holds
    them open too, nobody would ever notice that it is gone.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one that asked
    # Where that one winds up when it is told to end, its copies, which may be told too, go on
    # until it has: they end with the pipe. Elsewhere they end at once.
    for number in (signal.SIGTERM, signal.SIGHUP):
        handled = signal.getsignal(number) not in (signal.SIG_DFL, None)
        signal.signal(number, signal.SIG_IGN if handled else signal.SIG_DFL)
    note_in(memory)
    for other in others:
        other.close()

    def report(progress: Progress) -> bool:
        pipe.send(("progress", progress))
        return bool(flag.value)

    while True:
        try:
            name, given = pipe.recv()
        except (EOFError, OSError):
            return
        try:
            answer = ("done", tasks[name](*given, report=report))
        except FAULTS as error:  # whatever it is, it is raised over there
            error.add_note("".join(traceback.format_exception(error)))
            answer = ("error", (error, sendable_cause(error)))
        try:
            pipe.send_bytes(_packed(answer))
        except OSError:  # nobody is there any more
            return


def _packed(answer: tuple[str, Any]) -> bytes:
    """An answer in bytes, or the reason why it cannot be sent."""
    try:
        packed = pickle.dumps(answer)
        pickle.loads(packed)  # an exception may be packed and yet not unpacked
    except Exception as error:  # noqa: BLE001  # objects decide themselves what they raise here
        if answer[0] == "error":
            raised = answer[1][0]
            failure: Exception = MosegError(f"{type(raised).__name__}: {raised}")
        else:
            failure = PluginError(
                f"what was found cannot be sent between processes ({error}); use one worker"
            )
        packed = pickle.dumps(("error", (failure, None)))
    return packed


def sendable_cause(error: BaseException) -> BaseException | None:
    """What an error was raised from, where it can be sent between processes; else None."""
    cause = error.__cause__
    try:
        again = pickle.loads(pickle.dumps(cause))
    except Exception:  # noqa: BLE001  # objects decide themselves what they raise here
        return None
    return cause if isinstance(again, BaseException) else None
