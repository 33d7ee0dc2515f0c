"""Writing a file whole or not at all.

A file is written aside and renamed when it is whole: a run that dies leaves either the old file or
none. All that moseg writes is written so, results (:mod:`moseg_core.io.files`), labels
(:mod:`moseg_core.io.labels.writing`) and what commands print into files.
"""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from moseg_core.errors import MosegError


def write_file(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file whole or not at all: aside, then renamed.

    Parameters
    ----------
    path : path-like
        In a folder that exists; what stands there is replaced.
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
    try:
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise MosegError(f"cannot write '{path}': {error.strerror}") from error
    aside = Path(name)
    try:
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        # mkstemp makes files private; a result gets the permissions of any new file.
        mask = os.umask(0)
        os.umask(mask)
        aside.chmod(0o666 & ~mask)
        aside.replace(path)
    except OSError as error:
        raise MosegError(f"cannot write '{path}': {error.strerror}") from error
    finally:
        aside.unlink(missing_ok=True)
