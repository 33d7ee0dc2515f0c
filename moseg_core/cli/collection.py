"""Python's garbage collector, kept from what a command imports.

Importing the libraries of a command makes half a million objects that stay until the program ends.
The collector looks through them again and again while they come, at intervals while the command
runs, and twice when it ends: a third of the time of a command on a small shape. None of that frees
anything. So it rests while a command imports what it needs (:func:`importing`), and what is
there then is set apart (``gc.freeze``), as it is for good when the program ends (:func:`at_exit`).
What a search leaves behind is collected as ever.

This is for a process of one's own. The library leaves the collector of its user alone.
"""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def importing() -> Iterator[None]:
    """While modules are imported nothing is collected; later collections pass over what is there.

    Examples
    --------
    >>> with importing():
    ...     gc.isenabled()
    False
    >>> gc.isenabled()
    True
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
        gc.freeze()
    finally:
        if collects:
            gc.enable()


def at_exit() -> None:
    """Arrange that nothing is collected when the program ends: its memory is given back whole.

    Objects are still finalised when their last reference goes; only those that refer to each other
    in a circle are not, of which Python promises nothing at its end either.
    """
    atexit.register(gc.freeze)
