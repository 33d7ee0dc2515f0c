"""Ctrl-C, SIGTERM and SIGHUP in a long run: the first keeps what there is, the second ends it.

SIGTERM is what batch systems, containers and ``timeout`` send some seconds before they end a
program by force; SIGHUP what a terminal sends that is closed. What a run has found by then is as
good as after Ctrl-C. While files are written, they are finished.
"""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Iterator
from types import FrameType

from moseg_core.cli.console import message
from moseg_core.errors import Terminated

#: What the signals are called; SIGHUP is not known to every system.
_WORDS = {
    getattr(signal, name): words
    for name, words in (
        ("SIGINT", "interrupted"),
        ("SIGTERM", "told to end"),
        ("SIGHUP", "left by its terminal"),
    )
    if hasattr(signal, name)
}


class Stop:
    """Whether the user, or the system, has asked to stop; and how.

    Called, it tells whether. :meth:`ended` is the exception that the command ends with.

    Parameters
    ----------
    finishing : str
        What is done when the first signal comes.
    """

    def __init__(self, finishing: str = "with the best so far") -> None:
        self._number: int | None = None
        self._next = f"finishing {finishing}"

    def __call__(self) -> bool:
        """Whether to stop."""
        return self._number is not None

    def writing(self) -> None:
        """From now on files are written, which are finished after a signal too."""
        self._next = "finishing the files"

    def note(self, number: int, frame: FrameType | None) -> None:
        """Handle a signal."""
        if self():
            raise self._exception(number)
        self._number = number
        with contextlib.suppress(RuntimeError):  # in the middle of another line
            message(f"{_WORDS[number]}; {self._next} (once more to end at once)")

    def ended(self) -> KeyboardInterrupt:
        """The exception that tells how the run was ended."""
        return self._exception(self._number)

    def raise_if_asked(self) -> None:
        """Raise :meth:`ended` where somebody has asked to stop."""
        if self():
            raise self.ended()

    @staticmethod
    def _exception(number: int | None) -> KeyboardInterrupt:
        return KeyboardInterrupt() if number in (None, signal.SIGINT) else Terminated(number)


@contextlib.contextmanager
def stop_on_interrupt(*, wanted: bool, finishing: str = "with the best so far") -> Iterator[Stop]:
    """A :class:`Stop` that tells whether to stop.

    A signal that the process was started to ignore stays ignored, as by ``nohup``.

    Parameters
    ----------
    wanted : bool
        Whether a result cut short is of use; otherwise the signals end the program as ever.
    finishing : str
        What is done when the first signal comes, for the message.
    """
    stop = Stop(finishing)
    if not wanted:
        yield stop
        return
    before = {
        number: handler
        for number in _WORDS
        if (handler := signal.getsignal(number)) not in (signal.SIG_IGN, None)
    }
    for number in before:
        signal.signal(number, stop.note)
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
