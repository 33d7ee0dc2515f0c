"""A line at a terminal that says what a command is doing before there is progress to draw.

Libraries that are imported and a large file that is read take a second or more, and a terminal
that shows nothing for so long looks dead. The line is wiped out when that is over, or when
something else is printed (:func:`wipe`). It is written once, by whoever waits, not by a thread
(:mod:`moseg_core.cli.console` says why), and never into a file.

Imports next to nothing: it is needed before the rest is there.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from moseg_core.untrusted.terminal import printable

#: Back to the first column, and wipe what stands there.
_WIPE = "\r\x1b[2K"
#: The texts of those who wait; the last is shown.
_waiting: list[str] = []
_shown = False


@contextmanager
def waiting(text: str, *, quiet: bool = False) -> Iterator[None]:
    """While this context lasts a terminal shows a line.

    Parameters
    ----------
    text : str
        What is going on, such as "reading horse.off".
    quiet : bool
        Whether nothing is to be printed.
    """
    if quiet or not sys.stderr.isatty():
        yield
        return
    _waiting.append(text)
    _show()
    try:
        yield
    finally:
        _waiting.pop()
        wipe()
        if _waiting:
            _show()


def wipe() -> None:
    """Wipe the line out, where one is shown; call it before anything else is printed."""
    global _shown  # there is one terminal
    if _shown:
        sys.stderr.write(_WIPE)
        sys.stderr.flush()
        _shown = False


def _show() -> None:
    """Write the last text, on one line whatever it holds."""
    global _shown  # there is one terminal
    room = max(20, shutil.get_terminal_size().columns - 1)
    text = printable(f"moseg: {_waiting[-1]} ...")
    sys.stderr.write(_WIPE + (text if len(text) <= room else text[: room - 3] + "..."))
    sys.stderr.flush()
    _shown = True
