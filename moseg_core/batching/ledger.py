"""The ledger of a batch: one line for each shape that is done, in the order in which that was.

``batch.jsonl`` in the batch's folder. The first line says what it is, each other is an
:class:`~moseg_core.batching.outcome.Outcome` as JSON. Lines are only ever added, by the driver
alone, and are on the disk before the next job is handed out; so whatever is killed, and whenever,
at most the last line is torn, and is cut off by who goes on. Results come first and their line
after: a result without a line is made again, and a line without its result too, which then has no
second line.

One driver at a time: the file is locked while it is open, and the lock goes with the process.
"""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from moseg_core.batching.outcome import Outcome
from moseg_core.errors import MosegError, UsageError

try:
    import fcntl
except ImportError:  # moseg batch needs a POSIX system, its modules can be imported anywhere
    fcntl = None  # type: ignore[assignment]

NAME = "batch.jsonl"
"""The ledger's file in the folder of a batch."""

FORMAT = "moseg-batch/1"
"""What its first line says it is."""


def is_batch(folder: Path) -> bool:
    """Whether a folder is that of a batch."""
    return (folder / NAME).is_file()


def read_ledger(folder: Path) -> list[Outcome]:
    """All outcomes that a ledger has, as they were written; a torn last line is passed over.

    Raises
    ------
    UsageError
        There is no ledger, it is another version's, or it is damaged; names the line.
    """
    path = folder / NAME
    try:
        data = path.read_bytes()
    except OSError as error:
        raise UsageError(f"'{path}' cannot be read: {error.strerror or error}") from error
    return list(_outcomes(path, data))


def latest(outcomes: Iterable[Outcome]) -> dict[str, Outcome]:
    """The last outcome of each shape, in the order in which the shapes came first."""
    found: dict[str, Outcome] = {}
    for outcome in outcomes:
        found[outcome.shape] = outcome
    return found


def results_in(folder: Path) -> tuple[Path, ...]:
    """The results of a batch: of every shape whose last outcome is one, in the shapes' order.

    Raises
    ------
    UsageError
        As for :func:`read_ledger`; or no shape has a result.
    """
    last = latest(read_ledger(folder)).values()
    found = tuple(folder / outcome.files[0] for outcome in last if outcome.ok and outcome.files)
    if not found:
        raise UsageError(f"no shape of the batch in '{folder}' has a result")
    return tuple(sorted(found))


class Ledger:
    """The ledger of a batch, open to be gone on with.

    Parameters
    ----------
    folder : Path
        It exists.
    resume : bool
        Whether there may be a ledger already.

    Raises
    ------
    UsageError
        There is a ledger, and `resume` is false; or as for :func:`read_ledger`.
    MosegError
        It cannot be written, or another process is writing it.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder, Ledger(Path(folder), resume=False) as ledger:
    ...     ledger.add(Outcome(shape="a.off", key="0f", kind="ok", files=("a.json",)))
    ...     list(ledger.by_key), [path.name for path in results_in(Path(folder))]
    (['0f'], ['a.json'])
    """

    def __init__(self, folder: Path, *, resume: bool) -> None:
        self._path = folder / NAME
        there = self._path.exists() and self._path.stat().st_size > 0
        if there and not resume:
            raise UsageError(
                f"'{folder}' has the ledger of a batch; go on with it by --resume, do also again"
                f" what failed by --retry-failed, or give another folder"
            )
        try:
            self._file = self._path.open("a+b")
        except OSError as error:
            raise MosegError(f"cannot write '{self._path}': {error.strerror}") from error
        try:
            self._lock()
            self.by_key = self._go_on()
        except MosegError:
            self._file.close()
            raise

    def _go_on(self) -> dict[str, Outcome]:
        """What is there by keys, the last of each; a torn line is cut off, a first one written."""
        self._file.seek(0)
        data = self._file.read()
        whole = data[: data.rfind(b"\n") + 1]
        found = {outcome.key: outcome for outcome in _outcomes(self._path, whole)}
        if len(whole) < len(data):
            self._file.truncate(len(whole))
        if not whole:
            self._append({"ledger": FORMAT})
            _settle_folder(self._path.parent)
        return found

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with contextlib.suppress(OSError):  # what could not be written has been told of
            self._file.close()

    def add(self, outcome: Outcome) -> None:
        """Add an outcome, unless the job's last line says that there is a result, as there is.

        Raises
        ------
        MosegError
            The disk is full, or the folder is gone.
        """
        before = self.by_key.get(outcome.key)
        if before is not None and before.ok and outcome.ok:
            return
        self._append(outcome.document())
        self.by_key[outcome.key] = outcome

    def _append(self, row: dict[str, Any]) -> None:
        # Characters of a path that are none (surrogates) stay readable as escapes.
        line = json.dumps(row, allow_nan=False).encode() + b"\n"
        try:
            self._file.write(line)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise MosegError(f"cannot write '{self._path}': {error.strerror}") from error

    def _lock(self) -> None:
        if fcntl is None:
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise MosegError(
                f"another process is at work on the batch in '{self._path.parent}'; wait for it, or"
                f" give another folder"
            ) from None
        except OSError:  # a file system without locks, as some networks have
            return


def _outcomes(path: Path, data: bytes) -> Iterator[Outcome]:
    """The outcomes in the lines of a ledger that are whole."""
    lines = data.split(b"\n")[:-1]
    for number, line in enumerate(lines, 1):
        try:
            row = json.loads(line)
            if number == 1:
                said = row.get("ledger") if isinstance(row, dict) else None
                if said != FORMAT:
                    raise UsageError(
                        f"'{path}' is no ledger that this version reads: it says {said!r:.60}, not"
                        f" {FORMAT!r}"
                    )
                continue
            if not isinstance(row, dict):
                raise UsageError("it is no object")
            yield Outcome.read(row)
        except (ValueError, RecursionError) as error:
            if number == 1 and isinstance(error, UsageError):
                raise
            raise UsageError(
                f"'{path}' is damaged in line {number} ({error}); take the line out, and its shape"
                f" is done again"
            ) from error


def _settle_folder(folder: Path) -> None:
    """Have the file's name on the disk as well."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
