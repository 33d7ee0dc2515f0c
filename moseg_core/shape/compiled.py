"""How kernels are compiled: without the GIL, and kept on disk for the next process where possible.

numba keeps compiled code beside the source file or in the user's cache folder. Where neither can
be written, as in some containers, kernels are compiled anew in every process.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def kernel(function: Function) -> Function:
    """Compile a function of arrays and numbers on its first call."""
    try:
        compiled = njit(cache=True, nogil=True)(function)
    except RuntimeError:  # numba found no folder that it may write to
        compiled = njit(nogil=True)(function)
    return cast(Function, compiled)
