"""What is left of a run that fails: the best that it had found by then.

An objective may raise after hours of search. The error ends the run, in all processes, but what was
found so far need not be lost with it. So every task of a run returns, beside its result or its
error, the best that the evaluators of its process have seen (:attr:`ProblemEvaluator.best`); of
these the least is kept. Which that is depends on how far each process had come.

Tracked workers stand between :mod:`moseg_core.search.restarts` and
:mod:`moseg_core.search.workers`.
"""

from __future__ import annotations

import multiprocessing
import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from moseg_core.errors import MosegError
from moseg_core.search.evaluator import Found, ProblemEvaluator
from moseg_core.search.run import RunOutcome
from moseg_core.search.workers import Enough, Task, Workers, sendable_cause


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """What a task comes to.

    Parameters
    ----------
    result : object
    error : MosegError or None
        Instead of a result.
    cause : BaseException or None
        What the error was raised from, where it comes from another process: an exception that is
        sent leaves its cause behind.
    found : tuple of Found or None
        For each evaluator the best that it has seen in this process.
    """

    result: Any = None
    error: MosegError | None = None
    cause: BaseException | None = None
    found: tuple[Found | None, ...] = ()


class TrackedWorkers:
    """Workers of which the best that each has found is known, even where a task fails.

    Parameters
    ----------
    coarse, whole : ProblemEvaluator
        On the shape that is searched, and on that of the input elements; may be the same.
    """

    def __init__(self, coarse: ProblemEvaluator, whole: ProblemEvaluator) -> None:
        self._evaluators = (coarse, whole)
        self._found: list[Found | None] = [None, None]
        self._pool: Workers | None = None

    def tasks(self, tasks: Mapping[str, Task]) -> dict[str, Task]:
        """The tasks, each returning an :class:`Answer`."""
        return {name: self._answering(task) for name, task in tasks.items()}

    def join(self, pool: Workers) -> None:
        """Work in these processes, which have been given :meth:`tasks`."""
        self._pool = pool

    def release(self) -> None:
        """As :meth:`Workers.release`."""
        assert self._pool is not None  # joined before
        self._pool.release()

    def map(
        self, name: str, arguments: Sequence[tuple[Any, ...]], *, enough: Enough | None = None
    ) -> list[Any]:
        """As :meth:`Workers.map`; an error in one task ends them all.

        Raises
        ------
        MosegError
            That error.
        """
        assert self._pool is not None  # joined before

        def over(k: int, answer: Answer) -> bool:
            self._note(answer.found)
            return answer.error is not None or (enough is not None and enough(k, answer.result))

        answers: list[Answer] = self._pool.map(name, arguments, enough=over)
        for answer in answers:
            if answer.error is not None:
                raise answer.error from (answer.cause or answer.error.__cause__)
        return [answer.result for answer in answers]

    def best_found(self, error: MosegError) -> RunOutcome | None:
        """The best that was found before an error, with its cost on the input elements.

        None where nothing had been found, or where its cost cannot be known because of the error.
        """
        self._note(tuple(evaluator.best for evaluator in self._evaluators))
        coarse, whole = self._evaluators
        if self._found[1] is None and self._found[0] is not None:
            centers = coarse.parameterization.decode(self._found[0][1])
            try:
                vector = whole.parameterization.encode(centers)
                self._found[1] = whole.evaluate(vector).cost, vector
            except MosegError:
                return None  # the error at hand is the one to tell of
        if self._found[1] is None:
            return None
        cost, vector = self._found[1]
        return RunOutcome(vector=vector, cost=cost, reason="failed", history={}, failure=error)

    def _answering(self, task: Task) -> Task:
        def answer(*given: Any, **more: Any) -> Answer:
            result = error = cause = None
            try:
                result = task(*given, **more)
            except MosegError as failure:
                error = failure
                if multiprocessing.parent_process() is not None:  # else it is lost on the way
                    error.add_note("".join(traceback.format_exception(error)))
                    cause = sendable_cause(error)
            found = tuple(evaluator.best for evaluator in self._evaluators)
            return Answer(result=result, error=error, cause=cause, found=found)

        return answer

    def _note(self, found: Sequence[Found | None]) -> None:
        for k, new in enumerate(found):
            old = self._found[k]
            if new is not None and (old is None or new[0] < old[0]):
                self._found[k] = new
