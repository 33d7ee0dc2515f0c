"""How kernels are compiled: without the GIL, and kept on disk for the next process where possible.

numba finds the folder: beside the source file, else the user's cache folder, or what
``NUMBA_CACHE_DIR`` names. How a kernel lies there is :mod:`moseg_core.shape.kernel_files`'. Where
nothing can be kept, as in some containers and on a full disk, kernels are compiled anew in every
process, and a warning says so once.
"""

from __future__ import annotations

import mmap
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, cast

from numba import njit
from numba.core import event
from numba.core.caching import FunctionCache, NullCache
from numba.core.dispatcher import Dispatcher

from moseg_core.shape.kernel_files import KernelFiles

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile a function of arrays and numbers on its first call."""
    compiled: Any = njit(nogil=True)(function)
    # `cache=True` would set the same attribute.
    try:
        compiled._cache = _Kept(function)
    except RuntimeError:  # numba found no folder that it may write to
        compiled._cache = _NotKept()
    return cast(Function, compiled)


class _Kept(FunctionCache):
    """What numba asks for compiled code, and gives it to."""

    _cache_file: Any  # numba's has the same methods, and files that are not checked
    stamp: tuple[object, ...]
    """What tells versions of the source from each other."""

    def __init__(self, function: Callable[..., object]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]  # numba is typed in part
        # Code of the kernels that it calls becomes part of its own.
        named = (function.__globals__.get(name) for name in function.__code__.co_names)
        kept = [cache for called in named if isinstance(cache := _cache_of(called), _Kept)]
        self.stamp = (self._impl.locator.get_source_stamp(), *(cache.stamp for cache in kept))
        self._cache_file = KernelFiles(self.cache_path, function, self.stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """What was kept of a signature; None where nothing was, or nothing intact."""
        found = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]  # as above
        if self._cache_file.damaged is not None:
            folder, self._cache_file.damaged = self._cache_file.damaged.parent, None
            _warn_once(
                f"compiled kernels in '{folder}' are damaged and are compiled anew; if this is said"
                " again, look after that disk, or set NUMBA_CACHE_DIR to another folder"
            )
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep what was compiled, if that can be."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]  # as above
        except OSError as error:
            _warn_of_nothing_kept(f"in '{self.cache_path}': {error.strerror or error}")


def _cache_of(value: object) -> object:
    return getattr(value, "_cache", None) if isinstance(value, Dispatcher) else None


class _NotKept(NullCache):
    """The same where there is no folder."""

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep nothing."""
        _warn_of_nothing_kept(
            f"in the folder '{os.path.dirname(__file__)}', nor in the user's cache folder"
        )


#: Whether this process has warned, or one that it is a copy of, or a copy of it: one byte, shared.
_warned = mmap.mmap(-1, 1)


def _warn_of_nothing_kept(where: str) -> None:
    _warn_once(
        f"compiled kernels cannot be kept {where}; every process compiles them anew, which takes"
        " some seconds. Set NUMBA_CACHE_DIR to a folder that can be written to"
    )


def _warn_once(text: str) -> None:
    if not _warned[0]:
        _warned[0] = 1
        warnings.warn(text, RuntimeWarning, stacklevel=3)


class _FirstCompilation(event.Listener):
    """Tells once that this process compiles; processes copied from it stay silent."""

    def __init__(self, tell: Callable[[], None]) -> None:
        self._tell: Callable[[], None] | None = tell
        self._process = os.getpid()

    def on_start(self, event: Any) -> None:
        """Hear that a function is about to be compiled."""
        tell, self._tell = self._tell, None
        if tell is not None and os.getpid() == self._process:
            tell()

    def on_end(self, event: Any) -> None:
        """Hear that it is done."""


@contextmanager
def telling_of_compilation(tell: Callable[[], None]) -> Iterator[None]:
    """Within this context, `tell` is called when this process first compiles something.

    Parameters
    ----------
    tell : callable
        Called at most once, without arguments, and not where kernels are found on disk.
    """
    with event.install_listener("numba:compile", _FirstCompilation(tell)):
        yield
