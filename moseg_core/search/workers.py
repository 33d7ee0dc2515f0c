"""Work for several processes: the starts of a run side by side.

The starts of a run do not depend on each other, and the libraries that the objectives spend their
time in do not run on two threads at once; so they go to processes. These are copies of the
running one (``fork``), made when there is first something to do: shape, problem and components
need no pickling to get there, only results do to come back. Where the system cannot fork, or it
would be unsafe now (:mod:`moseg_core.search.forking`), or one process is asked for, everything is
done in this one, one thing after the other; a warning says why, where more were asked for.

A process that is killed, say by a system that has run out of memory, takes nothing along but time:
its task is done again, by another. In place of those that were lost others are made when there is
next something to do, or none is left; so what has eaten the memory is tried again beside fewer.
A task that kills its process twice is an error, which names the component at work.

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
from contextlib import suppress
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
from moseg_core.search.answer_record import current_record
from moseg_core.search.forking import can_fork, hindrance
from moseg_core.shape.row_threads import available_processors, share_processors

Task = Callable[..., Any]
"""Called with its arguments and ``report``."""

Enough = Callable[[int, Any], bool]
"""Whether the result of the task with this number makes all others needless."""


def available_workers() -> int:
    """Processors that this process may use, where the system tells; all of them elsewhere."""
    return available_processors()


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
        self._told = False
        #: Copies hand on what they add to it.
        self._record = current_record()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.release()

    def release(self) -> None:
        """End the processes; those made next are copies of this one as it is by then."""
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
            A task has cost two processes their lives. Whatever a task raises is raised here.

        Warns
        -----
        RuntimeWarning
            A process was lost, and its task is done again; or there are fewer than asked for.
        """
        # A single task goes to another process too where that may be lost, and this one may not.
        least = 1 if is_apart() and not is_profiling() and can_fork() else 2
        if min(self._count, len(arguments)) < least:
            return self._alone(name, arguments, enough)
        self._tell(self._make_up(self._count))
        if not self._workers:
            return self._alone(name, arguments, enough)
        self._flag.value = 0
        done: dict[int, Any] = {}
        lost: dict[int, _Loss] = {}
        waiting = list(range(len(arguments)))
        ended = self._stopped
        shown: Progress | None = None
        while True:
            if ended:  # what was begun, and lost, is begun again, and asked to stop at once
                waiting = [k for k in waiting if k in lost]
            if waiting and not self._workers and (reason := self._make_up(1)):
                for k in waiting:
                    if k in lost and not lost[k].from_outside:
                        raise lost[k].error()  # it would take this process along
                self._tell(reason)
                for k in waiting:
                    done |= zip([k], self._alone(name, [arguments[k]], None), strict=False)
                    if k in done and enough is not None and enough(k, done[k]):
                        break
                return [done[k] for k in sorted(done)]
            for worker in self._workers:
                if worker.task < 0 and waiting:
                    worker.task = waiting.pop(0)
                    with suppress(OSError):  # of one that is no more nothing will come either
                        worker.pipe.send((name, arguments[worker.task]))
            busy = [worker for worker in self._workers if worker.task >= 0]
            if not busy:
                return [done[k] for k in sorted(done)]
            for pipe in wait([worker.pipe for worker in busy]):
                worker = next(worker for worker in busy if worker.pipe is pipe)
                try:
                    kind, content = worker.pipe.recv()
                except (EOFError, OSError):
                    task, loss = worker.task, self._removed(worker)
                    if task in lost:
                        raise loss.error() from None
                    lost[task] = loss
                    waiting.insert(0, task)
                    busy = [other for other in busy if other is not worker]
                    _warn(f"{loss.told}; what it did is done again")
                    continue
                if kind == "answers":
                    assert self._record is not None  # or none would be sent
                    self._record.receive(content)
                    continue
                if kind == "error":
                    failure, cause = content
                    raise failure from cause
                if kind == "progress":
                    # Shown is the first task's progress; to stop, any message is an occasion.
                    first = worker.task == min(other.task for other in busy if other.task >= 0)
                    shown = content if first or shown is None else bettered(shown, content)
                    self._stopped = self._report(shown) or self._stopped
                else:
                    done[worker.task] = content
                    self._write()
                    if enough is not None and enough(worker.task, content):
                        ended, waiting = True, []
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
            self._write()
            if enough is not None and enough(k, done[-1]):
                break
        return done

    def _write(self) -> None:
        """Write what a task has added to the record, where one is kept."""
        if self._record is not None:
            self._record.write()

    def _make_up(self, count: int) -> str:
        """Make processes until there are so many; why there are fewer, where there are."""
        for worker in self._workers[:]:
            if not worker.process.is_alive():
                self._removed(worker)
        if len(self._workers) >= count:
            return ""
        rest()
        reason = hindrance()
        try:
            while not reason and len(self._workers) < count:
                self._workers.append(self._made())
                reason = hindrance()
        except OSError as error:
            reason = f"the system makes no process: {error.strerror or error}"
        return reason if len(self._workers) < count else ""

    def _tell(self, reason: str) -> None:
        """Tell once why there are fewer processes than asked for."""
        if reason and not self._told and self._count > 1:
            self._told = True
            number = f"{len(self._workers) or 'this'} process{'es' * (len(self._workers) > 1)}"
            _warn(f"{reason}; everything is done by {number}, with the same result")

    def _made(self) -> _Worker:
        """Another process.

        Raises
        ------
        OSError
            The system does not make one.
        """
        context = multiprocessing.get_context("fork")
        if self._flag is None:
            self._flag = context.RawValue("b", 0)
        memory = context.RawArray("c", SIZE)
        mine, theirs = context.Pipe()
        ours = [*(worker.pipe for worker in self._workers), mine]
        process = context.Process(
            target=_serve,
            args=(self._tasks, theirs, ours, self._flag, memory, self._count),
            daemon=True,
        )
        try:
            # Python from 3.12 on warns of locks that other threads might hold. None of ours runs
            # now: the watch rests, the command line draws its progress bars without a thread
            # (moseg_core.cli.console), and others were looked for. Libraries that keep threads
            # (BLAS) look after themselves.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                process.start()
        except OSError:
            mine.close()
            raise
        finally:
            theirs.close()
        return _Worker(process, mine, memory)

    def _removed(self, worker: _Worker) -> _Loss:
        """Take leave of a process that is no more, and tell how it ended."""
        self._workers.remove(worker)
        worker.pipe.close()
        worker.process.join(_PATIENCE)
        loss = _Loss(worker.process.exitcode, noted(worker.memory))
        if loss.code is None:  # it lives, and says nothing any more
            worker.process.kill()
            worker.process.join(_PATIENCE)
        return loss


def bettered(shown: Progress, other: Progress) -> Progress:
    """The progress of one task, with the best cost that it and another have found in its stage."""
    if shown.stage != other.stage or shown.best is None or other.best is None:
        return shown
    return replace(shown, best=min(shown.best, other.best))


@dataclass(frozen=True)
class _Loss:
    """How a process ended.

    Parameters
    ----------
    code : int or None
        Its exit code, that of a signal with a minus; None where it only fell silent.
    component : str
        What was at work; empty where that is not known.
    """

    code: int | None
    component: str

    @property
    def from_outside(self) -> bool:
        """Whether somebody else ended it, as far as its exit code tells."""
        return self.code is not None and -self.code in (signal.SIGKILL, signal.SIGTERM)

    @property
    def told(self) -> str:
        """In words."""
        why = "it fell silent" if self.code is None else f"exit code {self.code}"
        if self.code is not None and self.code < 0:
            why = f"signal {-self.code}"
        if self.code == -signal.SIGKILL:
            why += "; memory may have run out"
        during = f" while {self.component} was at work" if self.component else ""
        return f"a worker process ended early ({why}){during}"

    def error(self) -> MosegError:
        """The error where that is the end of the run."""
        return MosegError(
            f"{self.told}, and so did another at the same task; with one worker there is none to"
            f" lose"
        )


def _warn(text: str) -> None:
    """Tell of something that changes the time and not the result."""
    warnings.warn(text, RuntimeWarning, stacklevel=2)


def _serve(
    tasks: Mapping[str, Task],
    pipe: Connection,
    others: Sequence[Connection],
    flag: Any,
    memory: Any,
    processes: int,
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
    share_processors(processes)
    for other in others:
        other.close()

    record = current_record()

    def hand_on(*, all: bool) -> None:
        if record is not None and (added := record.take(all=all)):
            pipe.send(("answers", added))

    def report(progress: Progress) -> bool:
        hand_on(all=False)
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
            hand_on(all=True)
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
