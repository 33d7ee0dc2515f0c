"""A record of what evaluators have answered, from which a run that was stopped can be gone on with.

A search is deterministic: given its seed, and costs for the vectors that it asks about, it does the
same again. So a run is gone on with by doing it once more, with the costs taken from a record
(:class:`AnswerRecord`) as long as it has them. Nobody has to save an optimizer, a seeder or
anything else that strangers have written; and computing costs is where the time goes.

An answer stands in the record under a digest of all that it depends on: shape, problem, pins and
partition (:func:`answers_about`), the question, and what it is about. So it is right wherever it is
found, whichever process had computed it, in whatever order, and whether or not the run came to
its end as it would have: of a record any part will do.

Whoever wants a record makes one current (:func:`recording`), and evaluators that are made then use
it. Processes that are copied (:mod:`moseg_core.search.workers`) hand what they add to the one that
made them, which writes it. The file is the business of :mod:`moseg_core.io.checkpoint`.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from moseg_core.components.cost import Cost
from moseg_core.components.protocols import Parameterization
from moseg_core.errors import UsageError
from moseg_core.problem.problem import Problem
from moseg_core.shape.pins import Pins
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

DIGEST = 16
"""Bytes of the digest that an answer stands under."""

#: Values of an answer that is rather computed again.
_HUGE = 1 << 20
_COUNT = struct.Struct("<I")
#: A process that was copied hands on what it has added after so many seconds, or bytes.
_HELD_SECONDS, _HELD_BYTES = 1.0, 1 << 20


class Sink(Protocol):
    """Where a record is kept."""

    def begin(self, run: Mapping[str, Any]) -> Mapping[bytes, bytes]:
        """The answers that are known of a run, packed, by their digests.

        Raises
        ------
        UsageError
            What is kept here is of another run.
        """

    def write(self, answers: Sequence[bytes]) -> None:
        """Add answers: in each of these there are some, packed (:func:`packed`)."""


def packed(digest: bytes, values: FloatArray) -> bytes:
    """An answer in bytes: digest, number of values, and these as little-endian doubles."""
    return digest + _COUNT.pack(values.size) + values.astype("<f8").tobytes()


def unpacked(data: bytes) -> dict[bytes, bytes]:
    """The values of several answers, still packed, by digest.

    Raises
    ------
    ValueError
        That is not what these bytes are.

    Examples
    --------
    >>> data = packed(b"0123456789abcdef", np.array([1.0, 0.5]))
    >>> {key: np.frombuffer(values, "<f8").tolist() for key, values in unpacked(data).items()}
    {b'0123456789abcdef': [1.0, 0.5]}
    """
    found, at = {}, 0
    while at < len(data):
        digest, at = data[at : at + DIGEST], at + DIGEST
        if at + _COUNT.size > len(data):
            raise ValueError("an answer is cut off")
        size, at = 8 * _COUNT.unpack_from(data, at)[0], at + _COUNT.size
        if at + size > len(data):
            raise ValueError("an answer is cut off")
        found[digest], at = data[at : at + size], at + size
    return found


@dataclass(eq=False)
class AnswerRecord:
    """What is known of a run, and what has been added since.

    Parameters
    ----------
    sink : Sink
    every : float
        Seconds from one time that additions are written to the next.
    clock : callable
        The time in seconds.
    """

    sink: Sink
    every: float = 30.0
    clock: Callable[[], float] = time.monotonic
    _known: Mapping[bytes, bytes] = field(default_factory=dict)
    _added: list[bytes] = field(default_factory=list)
    _held: int = 0
    _running: bool = False

    def __post_init__(self) -> None:
        self._process = os.getpid()
        self._last = self.clock()

    @contextmanager
    def of_run(self, run: Callable[[], Mapping[str, Any]]) -> Iterator[None]:
        """Within this context answers are those of a run; of a run within a run there is no word.

        Raises
        ------
        UsageError
            The record is of another run, or of another process.
        """
        if self._running:
            yield
            return
        if os.getpid() != self._process:
            raise UsageError(
                "a checkpoint is kept of one search, and here are several in processes of their"
                " own; keep one of each, where it is made"
            )
        self._known = self.sink.begin(run())
        self._running = True
        try:
            yield
        finally:
            self._running = False
            self.write()

    def known(self, digest: bytes) -> FloatArray | None:
        """(k,) float: a known answer."""
        values = self._known.get(digest)
        return None if values is None else np.frombuffer(values, "<f8")

    def add(self, digest: bytes, values: FloatArray) -> None:
        """Add an answer that was not known; a huge one is not worth its place.

        Neither is what is asked before a run has begun, or after its end.
        """
        if values.size > _HUGE or not self._running:
            return
        self._added.append(packed(digest, values))
        self._held += len(self._added[-1])
        if self._due(self.every):
            self.write()

    def take(self, *, all: bool) -> bytes:
        """What has been added in this process, to be handed on; nothing yet where it can wait.

        Parameters
        ----------
        all : bool
            Whether nothing can wait.
        """
        if not (all or self._due(_HELD_SECONDS) or self._held >= _HELD_BYTES):
            return b""
        return b"".join(self._taken())

    def receive(self, data: bytes) -> None:
        """Take over what another process has added."""
        self._added.append(data)
        self._held += len(data)
        if self._due(self.every):
            self.write()

    def write(self) -> None:
        """Write all that was added; in a process that was copied nothing, as that hands it on."""
        if self._added and os.getpid() == self._process:
            self.sink.write(self._taken())

    def _taken(self) -> list[bytes]:
        added, self._added, self._held, self._last = self._added, [], 0, self.clock()
        return added

    def _due(self, seconds: float) -> bool:
        return self.clock() - self._last >= seconds


_current: ContextVar[AnswerRecord | None] = ContextVar("moseg_answer_record", default=None)


@contextmanager
def recording(record: AnswerRecord) -> Iterator[None]:
    """Within this context evaluators that are made use this record."""
    token = _current.set(record)
    try:
        yield
    finally:
        _current.reset(token)
        record.write()


def current_record() -> AnswerRecord | None:
    """The record in use, where there is one."""
    return _current.get()


@contextmanager
def one_run(describe: Callable[[], Mapping[str, Any]]) -> Iterator[None]:
    """Within this context a run goes on; where there is a record, it is checked to be of this one.

    Parameters
    ----------
    describe : callable
        What makes the run the one that it is, as plain data.
    """
    record = current_record()
    if record is None:
        yield
        return
    with record.of_run(describe):
        yield


class Answers:
    """The answers of one evaluator: computed each time, as nobody keeps a record."""

    def numbers(
        self, question: str, given: Sequence[Any], compute: Callable[[], FloatArray]
    ) -> FloatArray:
        """The answer to a question about something: (k,) float, whatever shape it is computed in.

        Parameters
        ----------
        question : str
        given : sequence of array_like
            All that the answer depends on.
        compute : callable
        """
        return compute().ravel()

    def costs(
        self, question: str, given: Sequence[Any], compute: Callable[[], list[Cost]]
    ) -> list[Cost]:
        """The same for costs."""
        return compute()


@dataclass(frozen=True, eq=False)
class RecordedAnswers(Answers):
    """The answers of one evaluator: taken from a record, or computed and added to it.

    Parameters
    ----------
    record : AnswerRecord
    about : bytes
        Digest of what the evaluator evaluates.
    """

    record: AnswerRecord
    about: bytes

    def numbers(
        self, question: str, given: Sequence[Any], compute: Callable[[], FloatArray]
    ) -> FloatArray:
        """See :meth:`Answers.numbers`."""
        digest = _digest(self.about, question, given)
        found = self.record.known(digest)
        if found is None:
            found = np.asarray(compute(), np.float64).ravel()
            self.record.add(digest, found)
        return found

    def costs(
        self, question: str, given: Sequence[Any], compute: Callable[[], list[Cost]]
    ) -> list[Cost]:
        """See :meth:`Answers.costs`."""
        rows = self.numbers(question, given, lambda: np.array(compute(), np.float64))
        return [Cost(int(empty), value) for empty, value in rows.reshape(-1, 2).tolist()]


NO_RECORD = Answers()
"""The answers of an evaluator that keeps no record."""


def answers_about(
    shape: Shape, problem: Problem, parameterization: Parameterization, pins: Pins
) -> Answers:
    """The answers of an evaluator, by the record in use, where there is one.

    Parameters
    ----------
    shape : Shape
        The level that is evaluated.
    problem : Problem
    parameterization : Parameterization
    pins : Pins
    """
    record = current_record()
    if record is None:
        return NO_RECORD
    partition = parameterization
    given = [
        *(shape.points, shape.areas, pins.elements, pins.labels),
        *(partition.lower, partition.upper, partition.scale),
    ]
    said = json.dumps([repr(shape.key), shape.input.fingerprint, problem.statement.document()])
    return RecordedAnswers(record, _digest(b"", said, given))


def _digest(about: bytes, question: str, given: Sequence[Any]) -> bytes:
    digest = hashlib.blake2b(about, digest_size=DIGEST)
    digest.update(f"{len(question)} {question}".encode())
    for each in given:
        array = np.ascontiguousarray(each)
        digest.update(f"{array.dtype.str}{array.shape}".encode())
        digest.update(array.tobytes())
    return digest.digest()
