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
"""

from __future__ import annotations

import threading
from contextlib import AbstractContextManager
from types import TracebackType

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

    __slots__ = ("_before", "_closely", "_who")

    def __init__(self, who: str, *, closely: bool) -> None:
        self._who, self._closely = who, closely
        self._before: State = {}

    def __enter__(self) -> None:
        self._before = look(AT_WORK) if self._closely else {_DIRECTORY: working_directory()}

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
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
