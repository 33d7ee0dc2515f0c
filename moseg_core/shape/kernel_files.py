"""Compiled kernels on disk, so that a damaged file costs a compilation and not the run.

numba keeps an index of each kernel's signatures and a file of machine code for each. It trusts
both: a file cut short ends the run with whatever unpickling raises, a flipped bit in machine code
with a crash, and of two processes that add a signature at once one may find the other's code under
its own. Here each signature is one file with a name of its own, made of all that its code depends
on, and a checksum (SHA-256: 1 ms for all kernels of a run). What does not agree is not there: the
kernel is compiled anew, and the file replaced. Files appear whole, by a rename, so processes that
start together may all write the same one.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import sys
import uuid
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba.core.serialize import dumps

_CHECKSUM = hashlib.sha256
_SUFFIX = ".kernel"


class KernelFiles:
    """The compiled forms of one kernel; in the place of numba's ``IndexDataCacheFile``.

    Parameters
    ----------
    folder : str
        Where to write, and to look first.
    function : callable
        The kernel. Files beside its source are read too: a folder that is read-only now may have
        been filled when the package was installed.
    stamp : object
        What tells versions of the source from each other, by its ``repr``.
    """

    def __init__(self, folder: str, function: Callable[..., object], stamp: object) -> None:
        source = Path(function.__code__.co_filename)
        self._folder = Path(folder)
        self._folders = dict.fromkeys([self._folder, source.parent / "__pycache__"])
        tag = sys.implementation.cache_tag
        self._stem = f"{source.stem}.{function.__qualname__}.{tag}".replace("<locals>", "locals")
        self._version = _digest((stamp, numba.__version__))[:8]
        self.damaged: Path | None = None
        """A file that was found damaged, if one was."""

    def load(self, key: object) -> Any:
        """What was kept under a key; None where nothing was, or nothing intact.

        Parameters
        ----------
        key : object
            Signature, processor and byte code, by their ``repr``.
        """
        for folder in self._folders:
            try:
                content = (folder / self._name(key)).read_bytes()
            except OSError:
                continue
            checksum, packed = (
                content[: _CHECKSUM().digest_size],
                content[_CHECKSUM().digest_size :],
            )
            if _CHECKSUM(packed).digest() == checksum:
                return pickle.loads(packed)
            self.damaged = folder / self._name(key)
        return None

    def save(self, key: object, data: object) -> None:
        """Keep something under a key, and remove what was kept of other versions of the source.

        Raises
        ------
        OSError
            It cannot be written.
        """
        packed = dumps(data)  # type: ignore[no-untyped-call]  # numba is typed in part
        path = self._folder / self._name(key)
        passing = path.with_suffix(f".{uuid.uuid4().hex[:16]}")
        try:
            passing.write_bytes(_CHECKSUM(packed).digest() + packed)
            os.replace(passing, path)
        except OSError:
            with contextlib.suppress(OSError):
                passing.unlink()
            raise
        for other in self._folder.glob(f"{self._stem}.*{_SUFFIX}"):
            if not other.name.startswith(f"{self._stem}.{self._version}-"):
                with contextlib.suppress(OSError):  # another process may have removed it
                    other.unlink()

    def flush(self) -> None:
        """Remove all that was kept."""
        for path in self._folder.glob(f"{self._stem}.*{_SUFFIX}"):
            path.unlink(missing_ok=True)

    def _name(self, key: object) -> str:
        return f"{self._stem}.{self._version}-{_digest(key)[:32]}{_SUFFIX}"


def _digest(thing: object) -> str:
    return hashlib.sha256(repr(thing).encode()).hexdigest()
