"""The three streams of the program, whatever whoever started it has done to them.

Closed ones (``moseg ... >&-``) are opened onto nothing: else the first file that is opened would
have their number, and what is printed would go into it. And nobody need read stderr: a terminal
that was closed, a full disk or a pipe whose reader has gone are no reason to end a search and lose
what it has found, so that errors in writing messages are passed over. stdout is what was asked for,
and errors there are errors (:mod:`moseg_core.cli.entry`).

Imports nothing but the standard library: it is done before anything else.
"""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Callable
from typing import TextIO

_PACKAGE = os.path.dirname(os.path.dirname(__file__))


class _Heedless(io.FileIO):
    """A file whose writer goes on where nobody takes what it writes."""

    def write(self, data: object, /) -> int:
        """Write what can be written; all of it counts as written."""
        try:
            return super().write(data)  # type: ignore[arg-type]  # any buffer
        except OSError:
            return memoryview(data).nbytes  # type: ignore[arg-type]  # as above


def prepare_streams() -> None:
    """Open what is closed, and let messages be written without heed; for a process of its own."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    if sys.stdin is None:
        sys.stdin = os.fdopen(0, closefd=False)
    if sys.stdout is None:
        sys.stdout = os.fdopen(1, "w", closefd=False)
    if isinstance(sys.stdout, io.TextIOWrapper):  # letters that it lacks are escaped, as on stderr
        sys.stdout.reconfigure(errors="backslashreplace")
    encoding = "utf-8" if sys.stderr is None else sys.stderr.encoding
    sys.stderr = io.TextIOWrapper(
        io.BufferedWriter(_Heedless(2, "wb", closefd=False)),
        encoding=encoding,
        errors="backslashreplace",
        line_buffering=True,
    )


def show_warnings(tell: Callable[[str], None]) -> None:
    """Have Python's warnings told as messages; for a process of its own.

    Parameters
    ----------
    tell : callable
        Told each in one line: where it comes from too, unless it is moseg's own.
    """

    def show(
        message: Warning | str,
        category: type[Warning],
        filename: str,
        lineno: int,
        file: TextIO | None = None,
        line: str | None = None,
    ) -> None:
        text = " ".join(str(message).split())
        ours = filename.startswith(_PACKAGE) or filename == "sys"
        where = "" if ours else f" ({category.__name__}, {filename}:{lineno})"
        tell(f"warning: {text}{where}")

    warnings.showwarning = show
