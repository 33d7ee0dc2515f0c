"""Rows of a text file of points: what is a comment, a header, a count, a cell.

Programs that write points as text agree in one thing, a point a line. Cells are parted by blanks,
commas, semicolons or tabs. Names of columns stand in the first line, as such or as a comment
(``# x,y,z`` of ``numpy.savetxt``, ``//X Y Z R G B`` of CloudCompare), or are numbers from 0
(pandas). The ``.pts`` files of scanners begin with how many points follow, and may hold several
scans, each with its count. Where the semicolon or the blank parts cells, numbers may have a decimal
comma.

:func:`read_rows` takes such a file apart without knowing what its columns mean, which
:mod:`moseg_core.io.read.point_columns` finds out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from moseg_core.io.read.checked import file_error
from moseg_core.io.read.text_rows import Row, word

# How programs write that there is no number, in small letters.
MISSING = frozenset(b"nan,-nan,na,n/a,null,none,-,--".split(b","))

_MARKS = (b"#", b"//", b"%", b"!")
_SEPARATORS = (b";", b",", b"\t")
_COMMA_NUMBERS = re.compile(rb"\s*[-+]?\d+,\d+(\s+[-+]?\d+,\d+){2,}\s*")
_NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+|#\w+)?$|-?nan|-?inf")
_UNIT = re.compile(r"\s*[\[(].*[\])]$")
_MOST_DIGITS = 18
_WIDE = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True, eq=False, kw_only=True)
class PointRows:
    """The cells of a file of points.

    Parameters
    ----------
    rows : list of list of bytes
        All of one length, without quotes.
    lines : list of int
        The line of each row, counted from 1.
    names : tuple of str
        What a header calls the columns, in small letters; empty where there is no header.
    ended : bool
        Whether the last line has an end.
    notes : tuple of str
        What was passed over or understood in a way that may surprise.
    """

    rows: list[Row]
    lines: list[int]
    names: tuple[str, ...]
    ended: bool
    notes: tuple[str, ...]


def read_rows(path: Path, data: bytes) -> PointRows:
    r"""Take a text file of points apart.

    Parameters
    ----------
    path : Path
        For messages.
    data : bytes

    Raises
    ------
    ShapeError
        There is no row, a count does not fit, or rows differ in length; says where.

    Examples
    --------
    >>> found = read_rows(Path("a.csv"), b"// X, Y, Z\n2\n1,2,3\n4,5,6\n")
    >>> found.names, found.rows[1], found.lines
    (('x', 'y', 'z'), [b'4', b'5', b'6'], [3, 4])
    """
    if data.startswith(_WIDE):
        data = data.decode("utf-16", "replace").encode()
    text = data.removeprefix(b"\xef\xbb\xbf").splitlines()
    comments, bare, lines = _parted(text)
    if not bare:
        raise file_error(path, "holds nothing but comments; export it again")
    # The first row may be a header, or a count, or both stand in front.
    sample = bare[min(2, len(bare) - 1)]
    separator = _separator(sample)
    notes: list[str] = []
    header = b"" if _numeric(bare[0]) else bare[0]
    if (separator == b";" and b"," in sample) or _COMMA_NUMBERS.fullmatch(sample):
        notes.append("commas are taken for decimal points")
        bare = [line.replace(b",", b".") for line in bare]
    if separator is None:
        rows = [line.split() for line in bare]
    else:
        rows = [[cell.strip().strip(b'"') for cell in line.split(separator)] for line in bare]
    names: tuple[str, ...] = ()
    if _numbered(rows):
        notes.append("the first line numbers the columns; it is passed over")
        if not rows[0][0]:
            notes.append("passed over: the first column, which numbers the rows")
            rows = [row[1:] for row in rows]
        rows, lines = rows[1:], lines[1:]
    elif header:
        names = _names(header, separator)
        rows, lines = rows[1:], lines[1:]
        if not rows:
            raise file_error(path, "has no rows below its header; export it again")
    else:
        names = next((n for n in map(_names, reversed(comments)) if {"x", "y"} & set(n)), ())
    rows, lines = _counted(path, rows, lines)
    if all(len(row) > 1 and row[-1] == b"" for row in rows) and len(rows[0]) != len(names):
        rows = [row[:-1] for row in rows]  # a separator behind the last cell
    width = len(names) if header else len(rows[0])
    for row, line in zip(rows, lines, strict=True):
        if len(row) != width:
            what = "header" if header else "first"
            raise file_error(
                path,
                f"the row has {len(row)} cells, the {what} {width}; it is cut off or damaged",
                line=line,
            )
    if not header and len(names) != width:
        names = ()
    return PointRows(
        rows=rows,
        lines=lines,
        names=names,
        ended=data.endswith((b"\n", b"\r")),
        notes=tuple(notes),
    )


def _parted(text: list[bytes]) -> tuple[list[bytes], list[bytes], list[int]]:
    """Comments in front of the first row, without their marks; rows; and the lines of these."""
    comments: list[bytes] = []
    bare: list[bytes] = []
    lines: list[int] = []
    for number, line in enumerate(text, 1):
        stripped = line.strip()
        if stripped.startswith(_MARKS) or (not bare and stripped[:4].lower() == b"sep="):
            if not bare:
                comments.append(stripped.lstrip(b"#/%!").strip())
            continue
        if b"#" in stripped:
            # Only behind a blank: 1.#QNAN is how some programs write what is not a number.
            stripped = re.split(rb"\s#", stripped, maxsplit=1)[0].strip()
        if stripped:
            bare.append(line.lstrip(b" ").rstrip(b" \r\n") if b"\t" in line else stripped)
            lines.append(number)
    return comments, bare, lines


def _separator(sample: bytes) -> bytes | None:
    """What parts the cells of a row of numbers; None for blanks."""
    if _COMMA_NUMBERS.fullmatch(sample):
        return None
    for mark in _SEPARATORS:
        # A tab among blanks is one of them.
        if mark in sample and (mark != b"\t" or sample.strip().count(mark) > 1):
            return mark
    return None


def _numeric(line: bytes) -> bool:
    """Whether a row is one of data: a cell is a number, or says that it is none."""
    cells = [cell.strip(b'"').lower() for cell in re.split(rb"[,;\s]+", line.strip())]
    return any(_NUMBER.match(cell) or cell in MISSING for cell in cells)


def _numbered(rows: list[Row]) -> bool:
    """Whether the first row numbers the columns from 0, as tables of pandas without names do.

    Whole numbers above ones with a point are no data of one program.
    """
    head = rows[0][1:] if rows[0][0] == b"" else rows[0]
    counted = len(head) > 2 and head == [b"%d" % k for k in range(len(head))]
    return counted and len(rows) > 1 and any(b"." in cell for cell in rows[1])


def _names(header: bytes, separator: bytes | None = None) -> tuple[str, ...]:
    """The names in a header: in small letters, without quotes and units."""
    if separator is None or separator not in header:
        separator = next((mark for mark in _SEPARATORS if mark in header), None)
    cells = header.split() if separator is None else header.split(separator)
    words = [cell.decode("utf-8", "replace").strip().strip('"').lower() for cell in cells]
    return tuple(_UNIT.sub("", name) or name for name in words)


def _counted(path: Path, rows: list[Row], lines: list[int]) -> tuple[list[Row], list[int]]:
    """The rows without those that say how many follow, each of which must be right."""
    if len(rows) < 2 or len(rows[0]) != 1 or not rows[0][0].isdigit() or len(rows[1]) < 3:
        return rows, lines
    kept: list[int] = []
    at = 0
    while at < len(rows):
        if len(rows[at]) != 1 or not rows[at][0].isdigit():
            raise file_error(
                path,
                "there are more points than announced; correct the count in front of them",
                line=lines[at],
            )
        # A count of more digits is beyond any file, and beyond what Python reads.
        end = at + 1 + (int(rows[at][0]) if len(rows[at][0]) <= _MOST_DIGITS else len(rows))
        if end > len(rows):
            raise file_error(
                path,
                f"{word(rows[at][0])} points are announced, {len(rows) - at - 1} follow;"
                " the file is cut off",
                line=lines[at],
            )
        kept += range(at + 1, end)
        at = end
    if not kept:
        raise file_error(path, "announces no points; export it again")
    return [rows[i] for i in kept], [lines[i] for i in kept]
