"""A JSON document from a file that anybody may have written.

Python's parser goes as deep as a document does, and so does whoever prints or compares what it
returns; numbers of thousands of digits are refused by it, and ``NaN`` is read though JSON has none.
So that readers need to look at what a document says only, and not at what it does to them, the
bytes are looked at first: their number, and how deep brackets are nested once strings are taken
away. Both take a small part of the time of parsing.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core.untrusted.regular_file import read_regular_file

MOST_BYTES = 2**28
"""Bytes of a JSON file; a labelling of ten million elements has a fifth of it."""

_DEEPEST = 100
_STRING = re.compile(rb'"[^"\\]*(?:\\.[^"\\]*)*"?', re.DOTALL)
_NO_BRACKETS = bytes(set(range(256)) - set(b"[]{}"))


def read_json_file(path: Path) -> Any:
    """The document in a JSON file.

    Raises
    ------
    OSError
        It cannot be read, is no regular file, or too large.
    ValueError
        It is not JSON, or nested too deep; says what is wrong.
    """
    return parse_json(read_regular_file(path, most=MOST_BYTES))


def parse_json(data: bytes) -> Any:
    """The document that bytes hold.

    Parameters
    ----------
    data : bytes
        In UTF-8, 16 or 32, as the standard's earlier versions allow.

    Raises
    ------
    ValueError
        It is not JSON, or nested too deep; says what is wrong.

    Examples
    --------
    >>> parse_json(b'{"labels": [0, 1]}')
    {'labels': [0, 1]}
    >>> parse_json(5000 * b"[")
    Traceback (most recent call last):
        ...
    ValueError: lists and objects are nested more than 100 deep
    """
    if _depth(data) > _DEEPEST:
        raise ValueError(f"lists and objects are nested more than {_DEEPEST} deep")
    try:
        return json.loads(data)
    except (RecursionError, OverflowError) as error:
        raise ValueError(str(error)) from error


def _depth(data: bytes) -> int:
    """How deep brackets are nested, those in strings left out."""
    brackets = _STRING.sub(b"", data).translate(None, _NO_BRACKETS)
    if not brackets:
        return 0
    codes = np.frombuffer(brackets, np.uint8)
    steps = np.where((codes == ord("[")) | (codes == ord("{")), 1, -1).astype(np.int8)
    return int(np.cumsum(steps, dtype=np.int64).max())
