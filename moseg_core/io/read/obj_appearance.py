"""Texture coordinates, normals and materials of an OBJ file (:mod:`moseg_core.shape.appearance`).

A corner of a face line is ``v``, ``v/vt``, ``v//vn`` or ``v/vt/vn``: numbers of a position, of
texture coordinates and of a normal, each counted on its own. What decides over parts is the first;
so a file whose other numbers are damaged is read without them, and a note says so. Corners of one
form, as programs write them, are read in one go, in less time than it takes to cut each apart.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from operator import methodcaller
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from moseg_core.io.read.text_rows import Row
from moseg_core.shape.appearance import CornerValues
from moseg_core.types import BoolArray, FloatArray, IntArray

_Number = TypeVar("_Number", np.int64, np.float64)

_INTEGER = re.compile(rb"[+-]?[0-9]{1,18}")
_LARGEST = 10**18  # above it a number may be one that 64 bits do not hold
_WIDTHS = {"texture coordinates": 2, "normals": 3}


def corner_numbers(tokens: Sequence[bytes]) -> IntArray | None:
    """The numbers of corners that are all of one form.

    Parameters
    ----------
    tokens : sequence of bytes
        Corners, such as ``1/2/3``.

    Returns
    -------
    (C, k) int or None
        From 1, negative ones counted back, 0 where a corner leaves one out; k is 1, 2 or 3. None
        where corners differ in form, or are no numbers.

    Examples
    --------
    >>> corner_numbers([b"1//4", b"2//4"]).tolist()
    [[1, 0, 4], [2, 0, 4]]
    >>> corner_numbers([b"1/1", b"2"]) is None
    True
    """
    if not tokens:
        return None
    width = tokens[0].count(b"/") + 1
    text = b" ".join(tokens)
    if width > 3 or set(map(methodcaller("count", b"/"), tokens)) != {width - 1}:
        return None
    plain = text.replace(b"//", b"/0/").replace(b"/", b" ")
    numbers = _in_one_go(plain, b"0123456789- ", np.int64)
    if numbers is None or len(numbers) != width * len(tokens):
        return None
    return None if np.abs(numbers).max() > _LARGEST else numbers.reshape(-1, width)


def _in_one_go(text: bytes, letters: bytes, kind: type[_Number]) -> npt.NDArray[_Number] | None:
    """The numbers of a text of these letters; None where it has others, or is no row of numbers."""
    if text.translate(None, letters):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of what is left behind the numbers
        try:
            return np.fromstring(text, kind, sep=" ")
        except (DeprecationWarning, ValueError):
            return None


def other_numbers(tokens: Sequence[bytes]) -> IntArray:
    """The numbers behind the first of corners of any form.

    Returns
    -------
    (C, 2) int
        Of texture coordinates and normals; 0 where there is none, or no number.

    Examples
    --------
    >>> other_numbers([b"1", b"2/7", b"2/x/-1"]).tolist()
    [[0, 0], [7, 0], [0, -1]]
    """
    found = np.zeros((len(tokens), 2), np.int64)
    for row, token in enumerate(tokens):
        for column, number in enumerate(token.split(b"/")[1:3]):
            if _INTEGER.fullmatch(number):
                found[row, column] = int(number)
    return found


def corner_values(
    what: str, rows: Sequence[Row], named: BoolArray, corners: IntArray
) -> tuple[CornerValues | None, list[str]]:
    """What the corners of faces have of texture coordinates, or of normals.

    Parameters
    ----------
    what : {"texture coordinates", "normals"}
    rows : sequence of rows
        The statements ``vt`` or ``vn``.
    named : (C,) bool
        Whether a corner names one.
    corners : (C,) int
        Which, from 0; those that are not there may be out of range.

    Returns
    -------
    CornerValues or None
        None where no corner has one.
    notes : list of str
        What was passed over.

    Examples
    --------
    >>> rows = [[b"vt", b"0", b"1"], [b"vt", b"0.5"]]
    >>> found, _ = corner_values(
    ...     "texture coordinates", rows, np.array([True, True]), np.array([0, 1]))
    >>> found.values.tolist(), found.corners.tolist()
    ([[0.0, 1.0], [0.5, 0.0]], [0, 1])
    """
    if not named.any():
        return None, []
    values = _values(rows, _WIDTHS[what]) if rows else np.empty((0, _WIDTHS[what]))
    if values is None:
        return None, [f"{what} that are no numbers; all are passed over"]
    outside = (corners < 0) | (corners >= len(values))
    missing = int((outside & named).sum())
    notes = [f"{what} that corners name and that are not there: {missing}"] if missing else []
    row = np.where(outside | ~named, -1, corners)
    if (row < 0).all():
        return None, notes
    return CornerValues(values=values, corners=row), notes


def _values(rows: Sequence[Row], width: int) -> FloatArray | None:
    """(n, width) float; what a row leaves out is 0. None where one is no finite number."""
    keyword, (size, *others) = rows[0][0] + b" ", sorted(set(map(len, rows)))
    text = b" ".join(map(b" ".join, rows))
    if not others and size > width and text.count(b"v") == len(rows):
        quick = _in_one_go(text.replace(keyword, b""), b"0123456789+-.eE ", np.float64)
        if quick is not None and len(quick) == (size - 1) * len(rows) and np.isfinite(quick).all():
            return np.ascontiguousarray(quick.reshape(len(rows), -1)[:, :width])
    words = [(row[1:] + [b"0"] * width)[:width] for row in rows]
    try:
        values = np.array([list(map(float, row)) for row in words], np.float64)
    except ValueError:
        return None
    return values if np.isfinite(values).all() else None
