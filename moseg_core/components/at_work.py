"""Which component is at work, noted where another process can read it.

A component that crashes (a fault in native code, memory that runs out) takes its process along, and
nothing in that process can say anything any more. A worker process
(:mod:`moseg_core.search.workers`) therefore writes the name of what it calls into memory that it
shares with the process that asked (:func:`note_in`), and that one reads it
(:func:`noted`) when the worker is gone. Elsewhere nothing is written.

Every call that computes something passes here: terms, and components, constraints and partitions
by way of :func:`~moseg_core.components.faults.guarded`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from types import TracebackType
from typing import Any

SIZE = 512
"""Bytes of the shared memory; longer names are cut."""

_NOTHING = nullcontext()

#: The shared memory of this process, and the names of the calls that are going on, outermost first.
_memory: Any = None
_names: list[bytes] = []


def note_in(memory: Any) -> None:
    """From now on note calls of this process in shared memory; None for no longer.

    Parameters
    ----------
    memory : multiprocessing.RawArray of c_char
        Of `SIZE` bytes.
    """
    global _memory
    _memory = memory
    _names.clear()


def noted(memory: Any) -> str:
    """What was at work when the process last wrote; empty for nothing.

    Examples
    --------
    >>> from multiprocessing import RawArray
    >>> memory = RawArray("c", SIZE)
    >>> note_in(memory)
    >>> with at_work("field 'basic:thickness'"):
    ...     noted(memory)
    "field 'basic:thickness'"
    >>> noted(memory)
    ''
    >>> note_in(None)
    """
    return bytes(memory.value).decode(errors="replace")


class _Call(AbstractContextManager[None]):
    """One call; the one that it was made from is noted again when it is over."""

    __slots__ = ("_name",)

    def __init__(self, name: str) -> None:
        self._name = name.encode()[: SIZE - 1]

    def __enter__(self) -> None:
        _names.append(self._name)
        _memory.value = self._name

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        _names.pop()
        _memory.value = _names[-1] if _names else b""


_apart = False


@contextmanager
def crashes_apart() -> Iterator[None]:
    """Within this context, what may crash is done in other processes even where one would do.

    For programs of their own, which then live to say which component it was.
    """
    global _apart
    before, _apart = _apart, True
    try:
        yield
    finally:
        _apart = before


def is_apart() -> bool:
    """Whether what may crash is to be done in other processes."""
    return _apart


def at_work(name: str) -> AbstractContextManager[None]:
    """A context for the call of a component; does nothing where nobody shares this memory."""
    return _NOTHING if _memory is None else _Call(name)
