"""Naming the call that everybody is waiting for.

An objective is a stranger's function, and some of them take for ever. A search asks thousands of
them and says nothing meanwhile, so a user who waits cannot know for which. Whoever shows things
(the command line) can therefore ask to be told of calls that take long::

    with naming_slow_calls(lambda what, seconds: print(f"waiting for {what}: {seconds:.0f} s")):
        segment(shape, problem)

:mod:`moseg_core.problem.calls` puts every call of an objective :func:`under_watch`. A thread
looks now and then at what is going on, so the calls pay next to nothing. Processes that are copied
while a watch is on (:mod:`moseg_core.search.workers`) start a thread of their own; meanwhile the
watch is made to :func:`rest`, so that no thread runs where processes are copied. A call that keeps
Python's interpreter lock to itself, as some libraries do, is named when it lets go.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar
from dataclasses import dataclass
from types import TracebackType

OnSlowCall = Callable[[str, float], None]
"""Receives what is being waited for, and for how many seconds so far."""

_NOTHING = nullcontext()


@dataclass
class _Call:
    name: str
    began: float
    #: Age at which to speak of it next.
    due: float


class Watch(AbstractContextManager[None]):
    """The call that is going on, and when to speak of it.

    Entered and left with each call; calls do not nest. It is spoken of once it has taken `after`
    seconds, and each time its age has doubled since.

    Parameters
    ----------
    tell : callable
    after : float
        Seconds.
    clock : callable
        The time in seconds.
    """

    def __init__(
        self, tell: OnSlowCall, *, after: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.after = after
        self._tell, self._clock = tell, clock
        self._call: _Call | None = None
        self._process = 0
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def call(self, name: str) -> Watch:
        """The watch for the next call, by the name under which it is spoken of."""
        self._call = _Call(name, self._clock(), self.after)
        return self

    def __enter__(self) -> None:
        if self._process != os.getpid():  # the first call here, or here since a fork
            self._process = os.getpid()
            self._ended = threading.Event()
            thread = threading.Thread(target=self._watch, name="moseg-watch", daemon=True)
            self._thread = thread
            try:
                thread.start()
            except RuntimeError:  # the system makes no thread: nothing is spoken of
                self._thread = None

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._call = None

    def look(self) -> None:
        """Speak of the call that is going on, if it is time to."""
        call = self._call
        if call is None:
            return
        age = self._clock() - call.began
        if age >= call.due:
            call.due = 2 * max(age, self.after)
            self._tell(call.name, age)

    def end(self) -> None:
        """Stop looking."""
        self._ended.set()

    def rest(self) -> None:
        """Stop looking until the next call, and wait until the thread has ended."""
        self._ended.set()
        if self._thread is not None and self._process == os.getpid():
            self._thread.join()
        self._thread, self._process = None, 0

    def _watch(self) -> None:
        ended = self._ended
        while not ended.wait(max(self.after / 10, 0.01)):
            self.look()


_watching: ContextVar[Watch | None] = ContextVar("moseg_watching", default=None)


def under_watch(name: str) -> AbstractContextManager[None]:
    """A context for a call that may be slow; does nothing where nobody wants to know."""
    watch = _watching.get()
    return _NOTHING if watch is None else watch.call(name)


def rest() -> None:
    """End the thread of the watch that is on, if one is; the next call starts another."""
    watch = _watching.get()
    if watch is not None:
        watch.rest()


@contextmanager
def naming_slow_calls(
    tell: OnSlowCall, *, after: float = 10.0, clock: Callable[[], float] = time.monotonic
) -> Iterator[Watch]:
    """Within this context, `tell` hears of every call that takes long.

    Parameters
    ----------
    tell : callable
        Called from another thread, or in another process.
    after : float
        How many seconds are long.
    clock : callable
        The time in seconds.
    """
    watch = Watch(tell, after=after, clock=clock)
    token = _watching.set(watch)
    try:
        yield watch
    finally:
        _watching.reset(token)
        watch.end()
