"""Ctrl-C and SIGTERM in a long run: the first keeps the best found so far, the second ends it.

SIGTERM is what batch systems, containers and ``timeout`` send some seconds before they end a
program by force; what a run has found by then is as good as after Ctrl-C.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from moseg_core.cli.console import message
from moseg_core.errors import Terminated


class Stop:
    """Whether the user, or the system, has asked to stop; and how.

    Called, it tells whether. :meth:`ended` is the exception that the command ends with.

    Parameters
    ----------
    finishing : str
        What is done when the first signal comes.
    """

    def __init__(self, finishing: str) -> None:
        self._number: int | None = None
        self._finishing = finishing

    def __call__(self) -> bool:
        """Whether to stop."""
        return self._number is not None

    def note(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        if self():
            raise self._exception(number)
        self._number = number
        what = "told to end" if number == signal.SIGTERM else "interrupted"
        message(f"{what}; finishing {self._finishing} (once more to end at once)")

    def ended(self) -> KeyboardInterrupt:
        """The exception that tells how the run was ended."""
        return self._exception(self._number)

    @staticmethod
    def _exception(number: int | None) -> KeyboardInterrupt:
        return Terminated() if number == signal.SIGTERM else KeyboardInterrupt()


@contextmanager
def stop_on_interrupt(*, wanted: bool, finishing: str = "with the best so far") -> Iterator[Stop]:
    """A :class:`Stop` that tells whether to stop.

    Parameters
    ----------
    wanted : bool
        Whether a result cut short is of use; otherwise both signals end the program as ever.
    finishing : str
        What is done when the first signal comes, for the message.
    """
    stop = Stop(finishing)
    if not wanted:
        yield stop
        return
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, stop.note) for number in numbers]
    try:
        yield stop
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)
