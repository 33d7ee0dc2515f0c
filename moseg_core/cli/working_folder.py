"""The folder that a command works in, which no component may change under it.

Paths that a user gives are meant as seen from the folder in which the command was started. A
component that changes the working directory of its process would send all that is read or written
afterwards elsewhere. So whatever calls components does it within :func:`working_folder_kept`, which
goes back: to the folder itself, held open, whatever it is called by then.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def working_folder_kept() -> Iterator[None]:
    """After this context the process works in the folder that it worked in before.

    Examples
    --------
    >>> before = os.getcwd()
    >>> with working_folder_kept():
    ...     os.chdir(os.sep)
    >>> os.getcwd() == before
    True
    """
    try:
        folder = os.open(os.curdir, os.O_RDONLY)
    except OSError:  # it was removed, may not be read, or this system opens no folders
        yield
        return
    try:
        yield
    finally:
        try:
            os.chdir(folder)
        finally:
            os.close(folder)
