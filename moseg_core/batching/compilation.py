"""Time that compiling takes is not the shape's: a limit on time stands still meanwhile.

Kernels are compiled once on a machine and then kept (:mod:`moseg_core.shape.compiled`). Whichever
shape is first would take some ten seconds longer than all others, and exceed a limit that was meant
for those.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from numba.core import event


class _Compiling(event.Listener):
    """Tells when the outermost compilation begins and ends; in this process alone."""

    def __init__(self, tell: Callable[[bool], None]) -> None:
        self._tell, self._depth, self._process = tell, 0, os.getpid()

    def on_start(self, event: Any) -> None:
        """Hear that a function is about to be compiled."""
        self._depth += 1
        if self._depth == 1 and os.getpid() == self._process:
            self._tell(True)

    def on_end(self, event: Any) -> None:
        """Hear that it is done."""
        self._depth -= 1
        if self._depth == 0 and os.getpid() == self._process:
            self._tell(False)


@contextmanager
def telling_of_compiling(tell: Callable[[bool], None]) -> Iterator[None]:
    """Within this context, `tell` is called with True when compiling begins, with False at its end.

    Parameters
    ----------
    tell : callable
    """
    with event.install_listener("numba:compile", _Compiling(tell)):
        yield
