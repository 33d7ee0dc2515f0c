"""Writing a file whole or not at all.

A file is written aside, brought to the disk (``fsync``) and renamed: a run that dies, or a machine
that loses its power, leaves the old file or the new one, whole. All that moseg writes is written
so, results (:mod:`moseg_core.io.files`), labels (:mod:`moseg_core.io.labels.writing`) and what
commands print into files. What stands there already is respected: a symbolic link is followed and
stays, a file keeps its permissions and its owner, and what is no file, such as a pipe with a name,
is written into.

Whether that can be done is tried before there is anything to write (:func:`check_destination`).
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path

from moseg_core.errors import MosegError, UsageError

#: Characters of a file's name that the one aside has too: in UTF-8 a name has at most 255 bytes.
_KEPT = 40
#: Bytes that are written to try a folder: a full disk takes an empty file.
_TRIED = 4096


def write_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all: aside, then renamed.

    Parameters
    ----------
    path : path-like
        In a folder that exists; what stands there is replaced. A symbolic link is followed; a named
        pipe or a device is written into.
    data : bytes

    Raises
    ------
    MosegError
        The disk is full, or the folder not writable.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_file(Path(folder) / "note.txt", b"whole")
    ...     [(path.name, path.read_bytes()) for path in Path(folder).iterdir()]
    [('note.txt', b'whole')]
    """
    path = Path(path)
    with told_of(path):
        if is_stream(path):
            with path.open("wb", buffering=0) as stream:
                rest = memoryview(data)
                while rest:
                    rest = rest[stream.write(rest) :]
            return
        place = Path(os.path.realpath(path))
        before = _status(place)
        with _aside(place) as (aside, descriptor):
            with os.fdopen(descriptor, "wb") as file:
                file.write(data)
                _permit(aside, before)
                file.flush()
                _settle(file.fileno())
            aside.replace(place)
        # On some systems a folder cannot be opened; a rename is not undone there either.
        with contextlib.suppress(OSError):
            folder = os.open(place.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)


def check_destination(path: str | os.PathLike[str]) -> None:
    """Refuse a path where :func:`write_file` would fail: a file is written beside it and removed.

    Parameters
    ----------
    path : path-like

    Raises
    ------
    UsageError
        It is a folder, there is no such folder, or no file can have that name.
    MosegError
        The folder takes no files; the disk is full.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     check_destination(Path(folder) / "note.txt")
    ...     os.listdir(folder)
    []
    """
    path = Path(path)
    with told_of(path):
        if is_stream(path):
            if not os.access(path, os.W_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
            return
        if os.path.isdir(path):
            raise UsageError(f"cannot write '{path}': it is a folder")
        if not os.path.isdir(path.parent):
            raise UsageError(f"cannot write '{path}': there is no folder '{path.parent}'")
        try:
            place = Path(os.path.realpath(path))
            _status(place)
        except (OSError, ValueError) as error:
            if isinstance(error, OSError) and error.errno != errno.ENAMETOOLONG:
                raise
            reason = getattr(error, "strerror", None) or error
            raise UsageError(
                f"cannot write '{path}': no file can be called so: {reason}"
            ) from error
        with _aside(place) as (_, descriptor), os.fdopen(descriptor, "wb") as file:
            file.write(bytes(_TRIED))


def is_stream(path: str | os.PathLike[str]) -> bool:
    """Whether a path leads to a pipe, a device or a terminal, which cannot be replaced."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError):
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def identity(path: str | os.PathLike[str]) -> object:
    """What two paths that lead to one file have in common, also to one that does not exist yet.

    Returns
    -------
    object
        To be compared. None where there is no such file, and of pipes and devices, which may be
        written into any number of times.

    Examples
    --------
    >>> identity("a/../new.json") == identity("new.json")
    True
    """
    try:
        status = _status(Path(path))
        if status is None:
            return os.path.realpath(path)
    except (OSError, ValueError):  # a name that no file can have
        return None
    return None if is_stream(path) else (status.st_dev, status.st_ino)


def same_file(one: str | os.PathLike[str], other: str | os.PathLike[str]) -> bool:
    """Whether two paths lead to one file, by whatever names."""
    found = identity(one)
    return found is not None and found == identity(other)


@contextlib.contextmanager
def told_of(path: Path) -> Iterator[None]:
    """A context whose errors of the system become moseg's, with the path and where it leads."""
    try:
        yield
    except MosegError:
        raise
    except BrokenPipeError as error:
        raise MosegError(f"cannot write '{path}': nobody reads it any longer") from error
    except (OSError, ValueError) as error:  # ValueError: a NUL in a name
        place = os.path.realpath(path) if os.path.islink(path) else ""
        link = f", a link to '{place}'" if place else ""
        reason = getattr(error, "strerror", None) or error
        raise MosegError(f"cannot write '{path}'{link}: {reason}") from error


def _status(place: Path) -> os.stat_result | None:
    """What stands at a place; None for nothing.

    Raises
    ------
    OSError
        No file can have that name, or links lead in a circle.
    """
    try:
        return os.stat(place)
    except FileNotFoundError:
        return None


@contextlib.contextmanager
def _aside(place: Path) -> Iterator[tuple[Path, int]]:
    """A new file beside a place, open, that is gone afterwards unless it was renamed."""
    descriptor, name = tempfile.mkstemp(dir=place.parent, prefix=f".{place.name[:_KEPT]}.")
    try:
        yield Path(name), descriptor
    finally:
        Path(name).unlink(missing_ok=True)


def _permit(aside: Path, before: os.stat_result | None) -> None:
    """Give a file the permissions of the one that it replaces, or of any new file."""
    if before is None:
        mask = os.umask(0)
        os.umask(mask)
        aside.chmod(0o666 & ~mask)  # mkstemp makes files private
        return
    mine = aside.stat()
    if (mine.st_uid, mine.st_gid) != (before.st_uid, before.st_gid):
        with contextlib.suppress(OSError):  # only the system's administrator may give files away
            os.chown(aside, before.st_uid, before.st_gid)
    aside.chmod(stat.S_IMODE(before.st_mode))


def _settle(descriptor: int) -> None:
    """Wait until a file is on the disk."""
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # there is no disk below
            raise
