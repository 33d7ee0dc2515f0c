"""Checkpoints: what a search has computed so far, on disk, for a run that may be stopped.

:func:`checkpointing` keeps a record of all costs (:mod:`moseg_core.search.answer_record`) in a file
while a search goes on, and takes it up again. The file is text that is only ever added to:

- the first line is JSON: the format, and the description of the run
  (:mod:`moseg_core.search.described_run`);
- each further line has eight hexadecimal digits, the CRC-32 of the bytes that follow in base64.
  These are answers one after the other: a digest of 16 bytes, the number of values (32 bits), and
  the values as doubles, all little-endian.

Nothing is unpickled or run. A line that is damaged or cut off is passed over: what it knew is
computed again. The answers themselves are believed, as those of any result file are.
"""

from __future__ import annotations

import base64
import binascii
import json
import os
import stat
import warnings
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np

from moseg_core.errors import MosegError, UsageError
from moseg_core.io.whole_file import write_file
from moseg_core.search.answer_record import AnswerRecord, packed, recording, unpacked
from moseg_core.search.described_run import differences

FORMAT = "moseg-checkpoint/1"
"""What a checkpoint says it is; the number rises when old readers would misread it."""

#: Bytes of answers in a line, and of the longest line that is read.
_PIECE, _LONGEST = 1 << 20, 1 << 24


@contextmanager
def checkpointing(
    path: str | os.PathLike[str],
    *,
    resume: str | os.PathLike[str] | None = None,
    every: float = 30.0,
) -> Iterator[Checkpoint]:
    """Within this context the search keeps a checkpoint, and may go on from an earlier one.

    A search that was stopped, by whatever, and is gone on with gives the result of one that never
    was: the same bytes. It does the same once more, with the costs that the checkpoint knows.

    Parameters
    ----------
    path : path-like
        Of the file to write. It must not exist, unless it is gone on from.
    resume : path-like, optional
        Of the checkpoint to go on from. If it is `path` itself, that need not be there yet.
    every : float
        Seconds from one time that the file is written to the next. It also is at the end of each
        start, and when the context is left, as by an interrupt.

    Yields
    ------
    Checkpoint

    Raises
    ------
    UsageError
        There is such a file already; the one to go on from is none, or of another run.
    MosegError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile, moseg_core as moseg
    >>> shape = moseg.load(moseg.sample_path("hammer"))
    >>> problem = moseg.Problem(["handle", "head"], "narrow(handle)")
    >>> few = "pattern_search(max_evaluations=20)"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = f"{folder}/hammer.checkpoint"
    ...     for _ in range(2):
    ...         with moseg.checkpointing(file, resume=file) as checkpoint:
    ...             result = moseg.segment(shape, problem, optimizer=few)
    ...         print(checkpoint.known > 0, round(result.cost, 6))
    False 0.104997
    True 0.104997
    """
    checkpoint = Checkpoint(Path(path), None if resume is None else Path(resume))
    try:
        with recording(AnswerRecord(checkpoint, every=every)):
            yield checkpoint
    finally:
        checkpoint.close()


@dataclass(eq=False)
class Checkpoint:
    """A file that a record of answers is kept in.

    Parameters
    ----------
    path : Path
    resume : Path or None
        Another, or the same, to go on from.

    Attributes
    ----------
    known : int
        How many answers were known when the run began.
    damaged : int
        How many lines were passed over.
    on_begin : callable, optional
        Called once, when a run has begun and the file is known to be of that run.

    Raises
    ------
    UsageError, MosegError
        See :func:`checkpointing`.
    """

    path: Path
    resume: Path | None = None
    known: int = 0
    damaged: int = 0
    on_begin: Callable[[], None] | None = None
    _answers: dict[bytes, bytes] = field(default_factory=dict)
    _run: dict[str, Any] | None = None
    _file: IO[bytes] | None = None
    #: Where the next line goes: what may stand there was cut off while it was written.
    _end: int = 0
    _waiting: list[bytes] = field(default_factory=list)
    _told: bool = False

    def __post_init__(self) -> None:
        exists = self.path.exists()
        if self.resume is not None and (exists or self.resume != self.path):
            self._read(self.resume)
        if exists and (self.resume is None or not self.resume.samefile(self.path)):
            raise UsageError(
                f"'{self.path}' exists already; to go on from it --resume {self.path}, or else"
                " remove it"
            )
        folder = self.path.parent
        if not folder.is_dir():
            raise UsageError(f"there is no folder '{folder}' for the checkpoint; make it first")
        if not os.access(self.path if exists else folder, os.W_OK):
            raise MosegError(f"cannot write '{self.path}': Permission denied")

    def begin(self, run: Mapping[str, Any]) -> Mapping[bytes, bytes]:
        """The answers that are known of a run (:class:`moseg_core.search.answer_record.Sink`)."""
        plain = json.loads(json.dumps(run))
        if self._run is not None and self._run != plain:
            found = list(differences(self._run, plain))
            more = f", and {len(found) - 3} more" if len(found) > 3 else ""
            raise UsageError(
                f"'{self.resume or self.path}' is the checkpoint of another run:"
                f" {'; '.join(found[:3])}{more}"
            )
        if self._file is None:
            self._run = plain
            if not self.path.exists():
                self._end = self._create(plain)
            self._file = self._opened()
            if self.on_begin is not None:
                self.on_begin()
        return self._answers

    def write(self, answers: Sequence[bytes]) -> None:
        """Add answers to the file; where that fails a warning says so, and it is tried again."""
        assert self._file is not None  # begun before
        self._waiting += answers
        data = b"".join(_lines(self._waiting))
        try:
            self._file.seek(self._end)
            self._file.write(data)
            self._file.truncate()
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            if not self._told:
                self._told = True
                warnings.warn(
                    f"the checkpoint '{self.path}' cannot be written for now"
                    f" ({error.strerror or error}), and the search goes on",
                    RuntimeWarning,
                    stacklevel=2,
                )
            return
        self._end += len(data)
        self._waiting = []

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            with suppress(OSError):  # what could not be written has been told of
                self._file.close()

    def _create(self, run: Mapping[str, Any]) -> int:
        """Make the file, with the answers that are known; its length."""
        head = json.dumps({"format": FORMAT, "run": run}) + "\n"
        unpacked_ones = (packed(key, np.frombuffer(v, "<f8")) for key, v in self._answers.items())
        data = head.encode() + b"".join(_lines(unpacked_ones))
        write_file(self.path, data)
        return len(data)

    def _opened(self) -> IO[bytes]:
        """The file, open as long as the run goes on, and locked for others."""
        try:
            file = self.path.open("r+b", buffering=0)
        except OSError as error:
            raise MosegError(f"cannot write '{self.path}': {error.strerror}") from error
        try:
            import fcntl

            # Of this process alone: those that are copied from it do not hold the lock.
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except ImportError:  # there is no such thing here
            pass
        except OSError as error:
            file.close()
            raise UsageError(
                f"the checkpoint '{self.path}' is being written by another run; wait for its end"
            ) from error
        return file

    def _read(self, path: Path) -> None:
        """Read what is known.

        Raises
        ------
        UsageError
            That is no checkpoint.
        """
        try:
            if not stat.S_ISREG(path.stat().st_mode):
                raise UsageError(f"'{path}' is no file to go on from")
            with path.open("rb") as file:
                self._run = _read_head(path, file.readline(_LONGEST))
                self._end = file.tell()
                while line := file.readline(_LONGEST):
                    try:
                        self._answers |= _read_line(line)
                        self._end = file.tell()
                    except ValueError:
                        self.damaged += 1
        except OSError as error:
            raise UsageError(
                f"'{path}' cannot be read as a checkpoint: {error.strerror or error}"
            ) from error
        self.known = len(self._answers)


def _lines(answers: Iterable[bytes]) -> Iterator[bytes]:
    """Lines of answers, about as long as is handy."""
    held, size = [], 0
    for each in answers:
        held.append(each)
        size += len(each)
        if size >= _PIECE:
            yield _line(b"".join(held))
            held, size = [], 0
    if held:
        yield _line(b"".join(held))


def _line(data: bytes) -> bytes:
    return b"%08x " % zlib.crc32(data) + base64.b64encode(data) + b"\n"


def _read_line(line: bytes) -> dict[bytes, bytes]:
    """The answers of a line.

    Raises
    ------
    ValueError
        It is damaged.
    """
    if not line.endswith(b"\n"):
        raise ValueError("cut off")
    data = binascii.a2b_base64(line[9:-1], strict_mode=True)
    if line[:9] != b"%08x " % zlib.crc32(data):
        raise ValueError("damaged")
    return unpacked(data)


def _read_head(path: Path, line: bytes) -> dict[str, Any]:
    """The description of the run."""
    try:
        head = json.loads(line)
    except (ValueError, RecursionError):
        head = None
    if not (isinstance(head, dict) and isinstance(head.get("run"), dict) and "format" in head):
        raise UsageError(
            f"'{path}' is no checkpoint of moseg; 'moseg segment ... --checkpoint FILE' writes one"
        )
    if head["format"] != FORMAT:
        raise UsageError(
            f"'{path}' has the format {head['format']!r:.60}; this version reads {FORMAT!r}"
        )
    run: dict[str, Any] = head["run"]
    return run
