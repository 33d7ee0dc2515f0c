"""Ctrl-C in a long run: the first ends it with the best found so far, the second at once."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

from moseg_core.cli.console import message


@contextmanager
def stop_on_interrupt(*, wanted: bool) -> Iterator[Callable[[], bool]]:
    """A function that tells whether the user has asked to stop.

    Parameters
    ----------
    wanted : bool
        Whether a result cut short is of use; otherwise Ctrl-C ends the program as ever.
    """
    requested = False

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal requested
        if requested:
            raise KeyboardInterrupt
        requested = True
        message("interrupted; finishing with the best so far (once more to end at once)")

    if not wanted:
        yield lambda: False
        return
    before = signal.signal(signal.SIGINT, note)
    try:
        yield lambda: requested
    finally:
        signal.signal(signal.SIGINT, before)
