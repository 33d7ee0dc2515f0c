"""Reading a file that somebody names: a regular one, and no more of it than makes sense.

A path in a recipe, in a result or on the command line may lead anywhere. A device such as
``/dev/zero`` never ends; a named pipe never begins, and to open it waits for whoever writes to it.
:func:`read_regular_file` opens without waiting, looks at what it has opened and reads at most so
many bytes. All that is wrong is an :class:`OSError` with words of its own, so that whoever reports
one that the system raises reports these too.
"""

from __future__ import annotations

import errno
import os
import stat

_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
    stat.S_IFDIR: "a folder",
}
_BINARY = getattr(os, "O_BINARY", 0)


def read_regular_file(path: str | os.PathLike[str], *, most: int | None = None) -> bytes:
    """All bytes of a regular file.

    Parameters
    ----------
    path : path-like
    most : int, optional
        Bytes of a larger file are not read.

    Raises
    ------
    OSError
        There is no such file, it may not be read, is no regular file, or too large; `strerror`
        says which.

    Examples
    --------
    >>> read_regular_file("/dev/null")
    Traceback (most recent call last):
        ...
    OSError: [Errno 22] it is a device, not a file
    """
    try:
        # A pipe would make open() wait; for regular files the flag means nothing.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | _BINARY)
    except ValueError as error:  # a NUL in the name
        raise OSError(errno.EINVAL, "no file can have that name") from error
    try:
        _check(os.fstat(descriptor))
    except OSError:
        os.close(descriptor)
        raise
    with os.fdopen(descriptor, "rb") as file:
        if most is None:
            return file.read()
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"it is larger than {_in_words(most)}")
    return data


def refuse_irregular(path: str | os.PathLike[str]) -> None:
    """Raise an :class:`OSError` where a path leads to something else than a regular file.

    For files that others open, as the reader of a bundle does. That there is none is theirs to say.

    Examples
    --------
    >>> refuse_irregular(__file__)
    >>> refuse_irregular("there/is/no/such/file")
    """
    try:
        found = os.stat(path)
    except (FileNotFoundError, NotADirectoryError):
        return
    _check(found)


def _check(found: os.stat_result) -> None:
    if not stat.S_ISREG(found.st_mode):
        kind = _KINDS.get(stat.S_IFMT(found.st_mode), "something else")
        raise OSError(errno.EINVAL, f"it is {kind}, not a file")


def _in_words(count: int) -> str:
    """A number of bytes as people say it.

    Examples
    --------
    >>> _in_words(2**20), _in_words(1000)
    ('1 MB', '1000 bytes')
    """
    return f"{count >> 20} MB" if count >= 1 << 20 else f"{count} bytes"
