"""Optimizers that call back, ``minimize(f, x0)``, as optimizers by ask and tell (Sec. 7).

Most libraries take a function and return its minimum. moseg's search asks for vectors and tells
their costs, so that it can evaluate several at a time, stop, and go on from a checkpoint. A
:class:`CallbackOptimizer` puts the two together: ``minimize`` runs in a thread of its own, in which
each call of ``f`` waits until the cost is told. Only one of the two threads runs at a time.

Threads do not survive pickles and forks, and need not: all that was asked and told is kept, and
``minimize``, begun anew, makes the same calls and gets the same answers until it is where it was.
So it must not depend on anything but its arguments and ``self``; random numbers come from
``self.rng``, which begins anew with it. A thread ends when its search does, when nobody holds the
optimizer any more, before a process is copied, and at exit: the waiting call of ``f`` then raises
what no ``except Exception`` catches.
"""

from __future__ import annotations

import copy
import math
import os
import queue
import threading
import weakref
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Batch
from moseg_core.errors import UsageError
from moseg_core.types import FloatArray

Minimize = Callable[[Callable[[FloatArray], Any], FloatArray], object]


class _Ended(BaseException):
    """The search is over; not an Exception, so that no optimizer takes it for a bad value."""


class _Conversation:
    """A ``minimize`` in a thread, which asks for values and is answered.

    Parameters
    ----------
    minimize : callable
    start : (m,) float
    value : (1,) float
        What the start is worth, which most ask first; then nobody else is asked for it.
    """

    def __init__(self, minimize: Minimize, start: FloatArray, value: FloatArray) -> None:
        self.over = False
        #: Ends it when the optimizer goes; held until then, and not for longer than it lasts.
        self.release: weakref.finalize[..., Any] | None = None
        self._known: tuple[FloatArray, FloatArray] | None = (start.copy(), value)
        self._questions: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._answers: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._thread = threading.Thread(
            target=_talk,
            args=(minimize, start, self._questions, self._answers),
            name="moseg-callback",
            daemon=True,
        )
        self._thread.start()
        _GOING.add(self)

    def question(self) -> FloatArray | None:
        """(m,) or (B, m) float: what the values are asked of next; None where it has returned.

        Raises
        ------
        Exception
            Whatever it raised.
        """
        said = self._questions.get()
        known, self._known = self._known, None
        if known is not None and isinstance(said, np.ndarray) and np.array_equal(said, known[0]):
            self.answer(known[1])
            said = self._questions.get()
        if isinstance(said, np.ndarray):
            return said
        self.end()
        if isinstance(said, BaseException):
            raise said
        return None

    def answer(self, values: FloatArray) -> None:
        """The values that it has asked for."""
        self._answers.put(values)

    def end(self) -> None:
        """Let it go; its thread has ended afterwards."""
        self.over = True
        self._answers.put(None)
        if self._thread is not threading.current_thread():
            self._thread.join()
        _GOING.discard(self)
        if self.release is not None:
            self.release.detach()


def _talk(
    minimize: Minimize,
    start: FloatArray,
    questions: queue.SimpleQueue[Any],
    answers: queue.SimpleQueue[Any],
) -> None:
    """What the thread does. It holds nothing that keeps the conversation alive."""

    def value_of(x: FloatArray) -> Any:
        questions.put(np.array(x, dtype=np.float64))
        values = answers.get()
        if values is None:
            answers.put(None)  # for whoever asks again while it is being left
            raise _Ended
        return values if np.ndim(x) == 2 else float(values[0])

    try:
        minimize(value_of, start)
    except _Ended:
        return
    except BaseException as error:  # noqa: BLE001  # raised again where it is waited for
        questions.put(error)
    else:
        questions.put(None)


_GOING: weakref.WeakSet[_Conversation] = weakref.WeakSet()


def _end_all() -> None:
    for conversation in list(_GOING):
        conversation.end()


# A copied process has no other threads, and the locks that they held: none may run meanwhile.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_end_all)


class CallbackOptimizer:
    """An optimizer that is written as a function of a function; a base class.

    Subclasses have a method :meth:`minimize`, and parameters of their own where they like, as
    keyword-only arguments of ``__init__``.

    Parameters
    ----------
    start, lower, upper, scale : (m,) float
        Where the search begins, within which bounds, and how long a step of 1 is.
    rng : numpy.random.Generator
    max_evaluations : int or None
        Most candidates to evaluate.

    Attributes
    ----------
    lower, upper, scale : (m,) float
    rng : numpy.random.Generator
        For ``minimize``; the same each time that this begins.

    Examples
    --------
    >>> class Halving(CallbackOptimizer):
    ...     def minimize(self, f, start):
    ...         best, value, step = start, f(start), 1.0
    ...         while step > 0.1:
    ...             moves = best + step * np.vstack([np.diag(self.scale), -np.diag(self.scale)])
    ...             values = f(moves)
    ...             if values.min() < value:
    ...                 best, value = moves[values.argmin()], values.min()
    ...             else:
    ...                 step /= 2
    >>> bounds = np.array([-9.0]), np.array([9.0])
    >>> search = Halving(np.array([5.0]), *bounds, np.ones(1), rng=np.random.default_rng(0))
    >>> while not search.finished:
    ...     search.tell([Cost(0, float((x[0] - 1.25) ** 2)) for x in search.ask().vectors])
    >>> search.best[0].tolist(), search.finished
    ([1.25], 'converged')
    """

    def __init__(
        self,
        start: FloatArray,
        lower: FloatArray,
        upper: FloatArray,
        scale: FloatArray,
        /,
        *,
        rng: np.random.Generator,
        max_evaluations: int | None = None,
    ) -> None:
        self.lower, self.upper, self.scale = (np.array(a, float) for a in (lower, upper, scale))
        self.rng: np.random.Generator
        self._start = np.array(start, dtype=np.float64)
        self._seed = int(rng.integers(2**63))
        self._budget = max_evaluations
        #: What was asked and what was answered so far, the start first.
        self._told: list[tuple[FloatArray, FloatArray]] = []
        self._question = self._start
        self._asked = self._start[None]
        self._waiting = False
        self._evaluations = 0
        self._best = self._start, Cost(0, math.inf)
        self._history: list[dict[str, float]] = []
        self._finished = ""
        self._conversation: _Conversation | None = None

    def minimize(self, f: Callable[[FloatArray], Any], start: FloatArray, /) -> object:
        """Look for the least value of a function; what is returned does not matter.

        Works on a copy of the optimizer: what it changes of ``self`` is not seen elsewhere.

        Parameters
        ----------
        f : callable
            The value of an (m,) vector, a float; of (B, m) vectors, (B,) floats at once. What is
            out of bounds is evaluated at the bound. Infinity where there is no value.
        start : (m,) float
        """
        raise NotImplementedError("a CallbackOptimizer needs a method minimize(f, start)")

    @property
    def finished(self) -> str:
        """Why the search ended: "converged", "evaluations"; empty while it goes on."""
        return self._finished

    @property
    def best(self) -> tuple[FloatArray, Cost]:
        """The best vector told so far, and its cost."""
        return self._best[0].copy(), self._best[1]

    @property
    def history(self) -> tuple[dict[str, float], ...]:
        """The best cost after each batch."""
        return tuple(self._history)

    @property
    def progress(self) -> float:
        """Estimated share of the search that is done, 0 to 1; a guess where nothing limits it."""
        if self._finished:
            return 1.0
        usual = 200 * len(self._start)
        if self._budget is None:
            return self._evaluations / (self._evaluations + usual)
        return self._evaluations / self._budget

    def ask(self) -> Batch:
        """What ``minimize`` waits for; the start before it has begun."""
        self._waiting = not self._finished
        return Batch(vectors=self._asked.copy())

    def tell(self, costs: Sequence[Cost]) -> None:
        """The costs of the batch last asked for; ``minimize`` goes on to its next call.

        Raises
        ------
        UsageError
            There is no such batch, or ``minimize``, begun anew, makes other calls than before.
        """
        if not self._waiting or len(costs) != len(self._asked):
            raise UsageError("tell() takes the costs of the batch last asked for")
        self._waiting = False
        sound = [Cost(c.empty, math.inf) if math.isnan(c.value) else c for c in costs]
        for vector, cost in zip(self._asked, sound, strict=True):
            if cost < self._best[1] or not self._evaluations:
                self._best = vector.copy(), cost
            self._evaluations += 1
        value, empty = self._best[1].value, self._best[1].empty
        record = {"evaluations": self._evaluations, "value": value, "empty": empty}
        self._history.append(record)
        values = np.array([cost.scalar for cost in sound])
        if self._budget is not None and self._evaluations >= self._budget:
            self._end("evaluations")
            return
        self._told.append((self._question, values))
        if self._conversation is None or self._conversation.over:
            self._conversation = self._begun_anew()
        else:
            self._conversation.answer(values)
        question = self._conversation.question()
        if question is None:
            self._end("converged")
            return
        self._question = question
        rows = np.clip(np.atleast_2d(question), self.lower, self.upper)
        left = len(rows) if self._budget is None else self._budget - self._evaluations
        self._asked = rows[:left]

    def _begun_anew(self) -> _Conversation:
        """A conversation in which all that was told so far has been told."""
        worker = copy.copy(self)
        worker.rng = np.random.default_rng(self._seed)
        (_, known), *told = self._told
        conversation = _Conversation(worker.minimize, self._start.copy(), known)
        conversation.release = weakref.finalize(self, conversation.end)
        for question, values in told:
            said = conversation.question()
            if said is None or not np.array_equal(said, question):
                raise UsageError(
                    f"{type(self).__name__}.minimize, begun anew, makes other calls than before; it"
                    " must depend on its arguments and self.rng only"
                )
            conversation.answer(values)
        return conversation

    def _end(self, reason: str) -> None:
        self._finished = reason
        self._told.clear()
        if self._conversation is not None:
            self._conversation.end()
            self._conversation = None

    def __getstate__(self) -> dict[str, Any]:
        """All but the thread, which begins anew when it is needed."""
        return {**self.__dict__, "_conversation": None}
