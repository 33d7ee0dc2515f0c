"""The header of an ``.npy`` file, read without trusting it.

The format (NEP 1): a magic word, a version, the length of the header, and the header, a Python
literal such as ``{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }``. numpy's own parser
takes whatever such text evaluates to: shapes of booleans, numbers of any size, and text nested so
deep that the parser fails otherwise than by saying so. Here the text is matched as numpy and all
that follow it write it, and what it says is checked before it is used.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

_MAGIC = b"\x93NUMPY"
_LONGEST, _MOST_AXES, _MOST_DIGITS = 10_000, 32, 18
_KEY = r"""(?:'%s'|"%s")\s*:\s*"""
_SHAPE = re.compile(_KEY % ("shape", "shape") + r"\(\s*((?:\d+L?\s*(?:,\s*|(?=\))))*)\)")
_ORDER = re.compile(_KEY % ("fortran_order", "fortran_order") + r"(True|False)")
_DESCR = re.compile(_KEY % ("descr", "descr") + r"""(?:'([^'\\\n]*)'|"([^"\\\n]*)")""")
_OTHER_DESCR = re.compile(_KEY % ("descr", "descr") + r"[\[(]")
_SIMPLE = re.compile(r"[<>|=]?[?a-zA-Z]\d{0,9}(?:\[[a-zA-Z0-9]+\])?")


@dataclass(frozen=True, kw_only=True)
class NpyHeader:
    """What an ``.npy`` file says of its array.

    Parameters
    ----------
    dtype : numpy.dtype
    shape : tuple of int
        At most 32 axes, none of them negative.
    by_columns : bool
        Whether the first axis runs fastest.
    size : int
        How many bytes stand before the numbers.
    """

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    by_columns: bool
    size: int


def parse_npy_header(data: bytes) -> NpyHeader:
    """Read the header at the beginning of a file's bytes.

    Parameters
    ----------
    data : bytes
        The file, or its beginning.

    Raises
    ------
    ValueError
        It is none; says in a few words why.

    Examples
    --------
    >>> import io
    >>> file = io.BytesIO()
    >>> np.save(file, np.zeros((3, 4)))
    >>> parse_npy_header(file.getvalue()).shape
    (3, 4)
    """
    if data[:6] != _MAGIC:
        raise ValueError("it does not begin with the magic word of such files")
    if len(data) < 12:
        raise ValueError("it ends within its header")
    version = data[6]
    if version not in (1, 2, 3):
        raise ValueError(f"its version is {version}, which is not known")
    start = 10 if version == 1 else 12
    length = int.from_bytes(data[8:start], "little")
    if length > _LONGEST:
        raise ValueError(f"its header is {length} bytes long")
    if len(data) < start + length:
        raise ValueError("it ends within its header")
    text = data[start : start + length].decode("utf-8" if version == 3 else "latin-1", "replace")
    rest = text.strip()
    if not (rest.startswith("{") and rest.endswith("}")):
        raise ValueError("its header is no dictionary")
    return NpyHeader(
        dtype=_dtype(rest),
        shape=_shape(rest),
        by_columns=_found(_ORDER, rest, "order of its axes")[1] == "True",
        size=start + length,
    )


def _dtype(text: str) -> np.dtype[Any]:
    if _OTHER_DESCR.search(text):
        raise ValueError("it holds records, not numbers")
    found = _found(_DESCR, text, "type of its numbers")
    name = found[1] if found[1] is not None else found[2]
    if not _SIMPLE.fullmatch(name):
        raise ValueError(f"its numbers are of the type {name!r:.40}")
    try:
        return np.dtype(name)
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"its numbers are of the type {name!r:.40}") from error


def _shape(text: str) -> tuple[int, ...]:
    words = _found(_SHAPE, text, "shape of whole numbers")[1].replace("L", "").split(",")
    sizes = [word.strip() for word in words if word.strip()]
    if len(sizes) > _MOST_AXES:
        raise ValueError(f"its shape has {len(sizes)} axes")
    if any(len(size) > _MOST_DIGITS for size in sizes):
        raise ValueError(f"its shape is ({', '.join(sizes)[:60]})")
    return tuple(map(int, sizes))


def _found(pattern: re.Pattern[str], text: str, what: str) -> re.Match[str]:
    found = pattern.search(text)
    if found is None:
        raise ValueError(f"its header tells no {what}")
    return found
