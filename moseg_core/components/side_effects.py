"""What a component does to the program on the side of a call is found, named and undone.

A component that changes the working directory sends files elsewhere; one that seeds the global
generators of random numbers makes a stranger's results repeat, or differ. Either is a fault like an
exception: the call ends in a :class:`~moseg_core.errors.PluginError` that names the component, and
things are put back as they were (:mod:`moseg_core.components.process_state`).

The working directory is looked at with each call, which takes a microsecond. To look at the rest
takes longer than some objectives do, so it is looked at in the first call of each component in a
process, the second, fourth, eighth and so on: what a component does with every call is found in the
first, and what is done rarely is found in the end, or by the contract kit. Where other threads run
than moseg's own, any of them may have made the change, and nobody is blamed.

A program of its own, as the command line is, can ask for more with :func:`own_program`: there what
components print does not reach standard output, which may be a document that another program reads,
and a component that ends the process by ``os._exit`` fails instead.
"""

from __future__ import annotations

import io
import mmap
import os
import sys
import threading
import zlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from types import TracebackType
from typing import Any

from moseg_core.components.process_state import (
    AT_WORK,
    State,
    changed,
    look,
    restore,
    told,
    working_directory,
)
from moseg_core.errors import REPORT, PluginError

_DIRECTORY = AT_WORK[0]

#: How many calls there were of each component.
_calls: dict[str, int] = {}

Tell = Callable[[str, str], None]
"""Receives a component and what it has printed, once for each."""


def without_side_effects(who: str) -> AbstractContextManager[None]:
    """A context for the call of a component.

    Parameters
    ----------
    who : str
        The component and where it comes from, for messages.

    Raises
    ------
    PluginError
        The component has changed what is not its own, and has not failed otherwise.

    Examples
    --------
    >>> import os
    >>> with without_side_effects("seeder 'mine:far'"):
    ...     os.chdir("/")
    Traceback (most recent call last):
        ...
    moseg_core.errors.PluginError: seeder 'mine:far' changed the working directory (from ... to /);
    report it to its authors, or do without it
    """
    count = _calls[who] = _calls.get(who, 0) + 1
    # Powers of two have one bit.
    return _Call(who, closely=count & (count - 1) == 0)


class _Call(AbstractContextManager[None]):
    """One call; how things were is noted when it begins."""

    __slots__ = ("_before", "_closely", "_stdout", "_who")

    def __init__(self, who: str, *, closely: bool) -> None:
        self._who, self._closely = who, closely
        self._before: State = {}
        self._stdout: Any = None

    def __enter__(self) -> None:
        self._before = look(AT_WORK) if self._closely else {_DIRECTORY: working_directory()}
        if _program is not None:
            _program.calls.append((self._who, os.getpid()))
            self._stdout, sys.stdout = sys.stdout, _program

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._stdout is not None:
            sys.stdout = self._stdout
            if _program is not None:
                _program.calls.pop()
        if not self._closely and working_directory() == self._before[_DIRECTORY]:
            return
        changes = changed(self._before)
        if not changes or not _alone():
            return
        restore({name: self._before[name] for name in changes})
        if error is None:
            raise PluginError(f"{self._who} changed {told(changes)}; {REPORT}")


def _alone() -> bool:
    """Whether no other threads run than moseg's own."""
    here = threading.current_thread()
    return all(
        thread is here or thread.name.startswith("moseg-") for thread in threading.enumerate()
    )


# -- A program of its own -------------------------------------------------------------------------


class EndedProcessError(SystemExit):
    """A component has called ``os._exit``."""


_DIGESTS = 1 << 16


class _Program(io.TextIOBase):
    """Standard output as components see it."""

    def __init__(self, tell: Tell) -> None:
        self.calls: list[tuple[str, int]] = []
        self._tell = tell
        #: Whether a component was told of, by a digest of its name; copied processes share it.
        self._told = mmap.mmap(-1, _DIGESTS)

    def writable(self) -> bool:
        """Whether anything can be written here."""
        return True

    def fileno(self) -> int:
        """That of standard error, for programs that a component starts."""
        return 2

    @property
    def buffer(self) -> _Program:
        """Where bytes are written: here."""
        return self

    def write(self, text: str | bytes) -> int:
        """Tell of the first that a component prints; the rest goes nowhere."""
        if not isinstance(text, str):
            return self.write(bytes(text).decode(errors="replace"))
        who = self.calls[-1][0] if self.calls else ""
        digest = zlib.crc32(who.encode(errors="replace")) % _DIGESTS
        if text.strip() and not self._told[digest]:
            self._told[digest] = 1
            self._tell(who, text)
        return len(text)


_program: _Program | None = None


@contextmanager
def own_program(tell: Tell) -> Iterator[None]:
    """Within this context the process is the caller's own, and components are kept from more.

    Parameters
    ----------
    tell : callable
        Called with the name of a component and what it prints, once for each; that, and what it
        prints later, is left out.

    Examples
    --------
    >>> heard = []
    >>> with own_program(lambda who, text: heard.append(who)):
    ...     with without_side_effects("seeder 'mine:far'"):
    ...         print("looking around")
    ...     print("done")
    done
    >>> heard
    ["seeder 'mine:far'"]
    """
    global _program
    before, leave = _program, os._exit

    def refuse(code: int) -> Any:
        if _program is None or not _program.calls or _program.calls[-1][1] != os.getpid():
            leave(code)
        raise EndedProcessError(f"os._exit({code})")

    _program = _Program(tell)
    os._exit = refuse  # type: ignore[assignment]  # it returns no more than the other does
    try:
        yield
    finally:
        os._exit, _program = leave, before
