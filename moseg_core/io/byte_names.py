r"""Names of files that are no UTF-8, in files that are.

To Linux the name of a file is a row of bytes, and old archives are full of names in other codes.
Python keeps a byte that is no UTF-8 as half of a surrogate pair (PEP 383, ``os.fsdecode``), which
opens the file, but can be in no text. Where such a name is only to be read, each of its strange
bytes is written as ``\xf6`` (:func:`readable`). Where the file is to be found again, the bytes of
its path stand beside that, in hexadecimal (:func:`path_entries`).
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any


def readable(name: str) -> str:
    r"""A name as it can stand in any text; the same where it can already.

    Examples
    --------
    >>> print(readable(os.fsdecode(b"M\xf6bel.off")), readable("Möbel.off"))
    M\xf6bel.off Möbel.off
    """
    # Halves of pairs that stand for no byte are shown as \ud800.
    errors = "surrogateescape" if _from_bytes(name) else "backslashreplace"
    return name.encode("utf-8", errors).decode("utf-8", "backslashreplace")


def path_entries(file: str) -> dict[str, str]:
    r"""The path of a file as JSON holds it: ``file``, and ``file_bytes`` where that is no UTF-8.

    Examples
    --------
    >>> path_entries("horse.off")
    {'file': 'horse.off'}
    >>> path_entries(os.fsdecode(b"M\xf6bel.off"))
    {'file': 'M\\xf6bel.off', 'file_bytes': '4df662656c2e6f6666'}
    """
    shown = readable(file)
    if shown == file or not _from_bytes(file):
        return {"file": shown}
    return {"file": shown, "file_bytes": os.fsencode(file).hex()}


def with_path(entries: Mapping[str, Any]) -> dict[str, Any]:
    r"""Entries as :func:`path_entries` wrote them among others, with the path that was meant.

    Raises
    ------
    ValueError, TypeError
        The bytes are not understood.

    Examples
    --------
    >>> with_path({"name": "x", **path_entries(os.fsdecode(b"M\xf6bel.off"))})
    {'name': 'x', 'file': 'M\udcf6bel.off'}
    """
    found = dict(entries)
    if "file_bytes" in found:
        found["file"] = os.fsdecode(bytes.fromhex(found.pop("file_bytes")))
    return found


def _from_bytes(name: str) -> bool:
    """Whether a name is what bytes became."""
    try:
        name.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        return False
    return True
