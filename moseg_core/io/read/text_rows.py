"""Words and numbers in text files, with the line that each stands on.

The text formats (OFF, OBJ, ASCII PLY and STL, label files) are rows of words. A file is cut
into rows once; numbers are then converted in bulk, and only when a conversion fails is the
culprit looked for, so that exact messages cost nothing while all is well.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error
from moseg_core.types import FloatArray, IntArray

Row = list[bytes]

# How the C libraries of some systems write what is not finite, in small letters.
_NOT_FINITE = frozenset(
    b"nan(ind),-nan(ind),nan(snan),1.#ind,-1.#ind,1.#qnan,-1.#qnan,1.#snan,1.#inf,-1.#inf,"
    b"1.#ind00,-1.#ind00,1.#qnan0,-1.#qnan0,1.#inf00,-1.#inf00".split(b",")
)


def text_rows(
    data: bytes, *, comment: bytes | None = b"#", continuation: bool = False
) -> tuple[list[Row], list[int]]:
    r"""Cut text into rows of words; lines without a word are left out.

    Parameters
    ----------
    data : bytes
        Lines end in LF, CR LF or CR; a byte-order mark at the beginning is skipped, and so are the
        zeros or the mark of old systems behind the end.
    comment : bytes or None
        From here to the end of a line nothing is read.
    continuation : bool
        Whether a backslash at the end of a line joins the next line to it.

    Returns
    -------
    rows : list of list of bytes
    lines : list of int
        The line of each row, counted from 1; of a continued row, its first.

    Examples
    --------
    >>> text_rows(b"OFF # tile\n\n4 1 4\n")
    ([[b'OFF'], [b'4', b'1', b'4']], [1, 3])
    >>> text_rows(b"f 1 2 \\\n3\n", continuation=True)
    ([[b'f', b'1', b'2', b'3']], [1])
    """
    text = data.removeprefix(b"\xef\xbb\xbf").rstrip(b"\0\x1a").splitlines()
    if comment is not None and comment in data:
        text = [line.partition(comment)[0] for line in text]
    if continuation and b"\\" in data:
        return _continued_rows(text)
    split = [line.split() for line in text]
    lines = [number for number, row in enumerate(split, 1) if row]
    return [row for row in split if row], lines


def _continued_rows(text: list[bytes]) -> tuple[list[Row], list[int]]:
    rows: list[Row] = []
    lines: list[int] = []
    row: Row = []
    first = 1
    for number, line in enumerate(text, 1):
        bare = line.rstrip()
        row += bare.removesuffix(b"\\").split()
        if bare.endswith(b"\\") and number < len(text):
            continue
        if row:
            rows.append(row)
            lines.append(first)
        row, first = [], number + 1
    return rows, lines


def word(token: bytes | str) -> str:
    """A word from a file as it is shown in a message: quoted, and not too long.

    Examples
    --------
    >>> word(b"1.0e")
    "'1.0e'"
    >>> len(word(b"x" * 1000))
    42
    """
    text = token if isinstance(token, str) else token.decode("utf-8", "replace")
    return repr(text if len(text) <= 40 else text[:37] + "...")


def end_notes(data: bytes) -> list[str]:
    r"""The note about a text that ends within a line, whose last number may have been cut short.

    Examples
    --------
    >>> end_notes(b"0 0 1\n"), end_notes(b"0 0 1 ")
    ([], [])
    >>> end_notes(b"0 0 1")
    ['the last line has no end: if the file was cut off there, its last number is wrong']
    """
    if not data or data[-1:].isspace() or data[-1:] in b"\0\x1a":
        return []
    return ["the last line has no end: if the file was cut off there, its last number is wrong"]


def line_of_item(offsets: IntArray, lines: Sequence[int]) -> Callable[[int], int]:
    """For words that were taken from rows, some from each: the function from word to line.

    Parameters
    ----------
    offsets : (R + 1,) int
        Row ``r`` gave the words ``offsets[r]`` to ``offsets[r + 1]``.
    lines : sequence of int
        The line of each row.

    Examples
    --------
    >>> line_of = line_of_item(np.array([0, 3, 7]), [10, 12])
    >>> line_of(2), line_of(3)
    (10, 12)
    """
    return lambda i: lines[int(np.searchsorted(offsets, i, side="right")) - 1]


def floats(path: Path, tokens: Sequence[bytes], line_of: Callable[[int], int]) -> FloatArray:
    """Convert words to floats.

    Parameters
    ----------
    path : Path
        For the message.
    tokens : sequence of bytes
    line_of : callable
        The line on which token ``i`` stands, asked only for the first that is no number.

    Returns
    -------
    (len(tokens),) float

    Raises
    ------
    ShapeError
        A word is not a number; says which and where. "nan" and "inf" are numbers here.

    Examples
    --------
    >>> floats(Path("a.off"), [b"1", b"-2.5e1"], lambda i: i).tolist()
    [1.0, -25.0]
    """
    # Python reads 1_000 as a number; no file format does.
    if b"_" not in b" ".join(tokens):
        try:
            return np.array(list(map(float, tokens)), np.float64)
        except ValueError:
            pass  # found and reported below
        if not _NOT_FINITE.isdisjoint(lowered := [token.lower() for token in tokens]):
            return floats(path, [b"nan" if t in _NOT_FINITE else t for t in lowered], line_of)
    raise _first_culprit(path, tokens, line_of, _is_float, "a number")


def integers(path: Path, tokens: Sequence[bytes], line_of: Callable[[int], int]) -> IntArray:
    """Convert words to integers of 64 bits; see :func:`floats`.

    Raises
    ------
    ShapeError
        A word is not an integer, or too large for one; says which and where.

    Examples
    --------
    >>> integers(Path("a.seg"), [b"1", b"-2"], lambda i: i).tolist()
    [1, -2]
    """
    if b"_" not in b" ".join(tokens):
        try:
            return np.array(list(map(int, tokens)), np.int64)
        except (ValueError, OverflowError):
            pass  # found and reported below
    raise _first_culprit(path, tokens, line_of, _is_integer, "an integer")


def _first_culprit(
    path: Path,
    tokens: Sequence[bytes],
    line_of: Callable[[int], int],
    good: Callable[[bytes], bool],
    wanted: str,
) -> ShapeError:
    """The error about the first token that is not `good`."""
    index = next(i for i, token in enumerate(tokens) if not good(token))
    what = f"{word(tokens[index])} is not {wanted}; the file is damaged or of another format"
    return file_error(path, what, line=line_of(index))


def _is_float(token: bytes) -> bool:
    try:
        float(token)
    except ValueError:
        return False
    return b"_" not in token


def _is_integer(token: bytes) -> bool:
    try:
        value = int(token)
    except ValueError:
        return False
    return b"_" not in token and -(2**63) <= value < 2**63


def leading_floats(
    path: Path, rows: Sequence[Row], lines: Sequence[int], *, start: int = 0, what: str = "vertex"
) -> FloatArray:
    """The three numbers at the beginning of each row; further words are not looked at.

    Parameters
    ----------
    path : Path
    rows, lines : sequences
        As :func:`text_rows` returns them.
    start : int
        How many words precede the numbers in each row.
    what : str
        What a row stands for, for the message.

    Returns
    -------
    (len(rows), 3) float

    Raises
    ------
    ShapeError
        A row is too short or holds something else than numbers; says which line.

    Examples
    --------
    >>> leading_floats(Path("a.obj"), [[b"v", b"1", b"2", b"3", b"0.5"]], [1], start=1).tolist()
    [[1.0, 2.0, 3.0]]
    """
    stop = start + 3
    cut = [row[start:stop] for row in rows]
    for index, row in enumerate(cut):
        if len(row) < 3:
            raise file_error(
                path,
                f"a {what} needs 3 coordinates, this one has {len(row)};"
                " the file is cut off or damaged",
                line=lines[index],
            )
    tokens = [token for row in cut for token in row]
    return floats(path, tokens, lambda i: lines[i // 3]).reshape(-1, 3)
