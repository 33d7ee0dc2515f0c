r"""Labels as a column of text: a number or a name a line, alone or among other columns.

The plainest form, under many suffixes (``.seg`` of Chen et al. 2009, ``.txt`` of Maron et al.
2017, ``.labels``, ``.csv``), and everyone's own: whole numbers written as floats, by
``numpy.savetxt``; a header; all numbers on one line; a column of names; a table that pairs faces
with labels; the points of a cloud with their labels behind (x y z label, x y z nx ny nz label).

Cells are parted by tabs, semicolons or commas where there are any, else by blanks. Lines that
begin with ``#``, ``//`` or ``%`` are comments, of which the last before the data may be the
header.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from moseg_core.io.labels.listing import (
    BEARERS,
    NO_LABEL,
    Listing,
    Wanted,
    labels_of_ids,
    numbered_names,
    whole_labels,
)
from moseg_core.io.labels.properties import chosen, familiar, plain
from moseg_core.io.read.checked import file_error
from moseg_core.io.read.text_rows import word
from moseg_core.types import UNLABELLED, FloatArray, IntArray

COMMENTS = ("#", "//", "%")
"""What a line begins with that is no data."""

_DELIMITERS = ("\t", ";", ",")
# Columns that say which element a row is about.
_INDICES = frozenset(["", "index", "id", "row", "i", *BEARERS])
# Points with a label behind: x y z, with a normal or a colour, with both.
_POINT_COLUMNS = (4, 7, 10)

_DIGITS = re.compile(r"[-+.0-9eE\s]*")
_EXACT = 2.0**53  # below which every whole number is a float of its own

Cells = list[str]


@dataclass(frozen=True, kw_only=True)
class Rows:
    """The cells of a text.

    Parameters
    ----------
    cells : list of list of str
    lines : list of int
        The line of each row, from 1.
    header : list of str
        Names of the columns; empty where there are none.
    """

    cells: list[Cells]
    lines: list[int]
    header: Cells


def read_columns(path: Path, text: str, wanted: Wanted) -> Listing:
    r"""Read a column of labels.

    Parameters
    ----------
    path : Path
        For messages.
    text : str
        What is in the file.
    wanted : Wanted

    Raises
    ------
    ShapeError
        There is no such column, or there are several and none is known by its name; or a cell is
        no label. Says where.

    Examples
    --------
    >>> wanted = Wanted(n_elements=3)
    >>> read_columns(Path("a.csv"), "face,part\n0,leg\n1,body\n2,leg\n", wanted).names
    ('leg', 'body')
    >>> read_columns(Path("a.seg"), "0.0\n1.0\nnan\n", wanted).labels.tolist()
    [0, 1, -1]
    """
    plain_numbers = _plain_numbers(text)
    if plain_numbers is not None:
        return Listing(labels=plain_numbers)
    rows = _rows(path, text, wanted)
    if not rows.cells:
        return Listing(labels=np.empty(0, np.int64))
    width = len(rows.cells[0])
    if len(rows.cells) == 1 and width > 1 and not rows.header:
        line = rows.lines[0]
        return _listing(path, rows.cells[0], [line] * width, wanted)
    for row, line in zip(rows.cells, rows.lines, strict=True):
        if len(row) != width:
            expected = "one label" if width == 1 else f"{width} columns as in the lines before"
            raise file_error(path, f"expected {expected}, found {len(row)} words", line=line)
    column, index, notes = _columns(path, rows, wanted)
    cells = [row[column] for row in rows.cells]
    found = _listing(path, cells, rows.lines, wanted)
    if rows.header:
        wanted = wanted.told(rows.header[column])
        wanted = wanted if index is None else wanted.told(rows.header[index])
    if index is not None:
        ids = [int(row[index]) for row in rows.cells]
        return _placed(path, found, np.array(ids, np.int64), wanted)
    return Listing(labels=found.labels, names=found.names, of=wanted.bearer, notes=notes)


def _plain_numbers(text: str) -> IntArray | None:
    """The labels of a text of one whole number a line and nothing else; None of any other.

    Several times as fast as the slow reading, which accepts or names what is out of the ordinary.
    """
    if not _DIGITS.fullmatch(text):
        return None
    words = text.split()
    if len(words) != sum(1 for line in text.splitlines() if line.strip()):
        return None
    try:
        numbers = np.array(list(map(float, words)), np.float64)
    except ValueError:
        return None
    if not (np.abs(numbers) < _EXACT).all():
        return None
    labels = numbers.astype(np.int64)
    return labels if (labels == numbers).all() and (labels >= UNLABELLED).all() else None


def _rows(path: Path, text: str, wanted: Wanted) -> Rows:
    numbered = [
        (line.strip(), number) for number, line in enumerate(text.splitlines(), 1) if line.strip()
    ]
    said: list[str] = []
    while numbered and numbered[0][0].startswith(COMMENTS):
        said.append(numbered.pop(0)[0])
    numbered = [(line, number) for line, number in numbered if not line.startswith(COMMENTS)]
    delimiter = next((d for d in _DELIMITERS if any(d in line for line, _ in numbered[:2])), None)
    if delimiter is None and not _all_numbers(line for line, _ in numbered[1:]):
        cells = [[_unquoted(line)] for line, _ in numbered]  # names may hold blanks
    else:
        cells = [_cells(line, delimiter) for line, _ in numbered]
    if all(len(row) > 1 and not row[-1] for row in cells):  # lines end in a delimiter
        cells = [row[:-1] for row in cells]
    lines = [number for _, number in numbered]
    if _is_header(cells, wanted):
        return Rows(cells=cells[1:], lines=lines[1:], header=cells[0])
    header = _cells(said[-1].lstrip("#/% "), delimiter) if said else []
    fits = bool(cells) and len(header) == len(cells[0])
    return Rows(cells=cells, lines=lines, header=header if fits else [])


def _cells(line: str, delimiter: str | None) -> Cells:
    if '"' in line and delimiter is not None:  # a quoted name may hold the delimiter
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
        except csv.Error:  # cells beyond the reader's limit
            pass
    return [_unquoted(cell) for cell in line.split(delimiter)]


def _unquoted(cell: str) -> str:
    return cell.strip().strip("\"'").strip()


def _all_numbers(lines: Iterable[str]) -> bool:
    """Whether every word of every line is a number, or says that there is none."""
    return all(_is_number(_unquoted(cell)) for line in lines for cell in line.split())


def _is_number(cell: str) -> bool:
    if cell.lower() in NO_LABEL:
        return True
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _is_header(cells: list[Cells], wanted: Wanted) -> bool:
    """Whether the first row names columns: numbers follow, or it is over and names labels."""
    if len(cells) < 2:
        return False
    if len(cells[0]) > 1 and not cells[0][0] and cells[1][0]:  # pandas does not name its index
        return True
    if any(cell and _is_number(cell) for cell in cells[0]):
        return False
    if any(map(_is_number, cells[1])) or (len(cells[0]) > 1 and familiar(cells[0])):
        return True
    over = len(cells) - 1 in (wanted.n_elements, wanted.n_vertices)
    return over and bool(familiar(cells[0]) or set(cells[0]) & set(wanted.properties))


def _columns(path: Path, rows: Rows, wanted: Wanted) -> tuple[int, int | None, tuple[str, ...]]:
    """The column of labels, that of what they belong to, and what is to be said of the choice."""
    width = len(rows.cells[0])
    if width == 1:
        return 0, None, ()
    index = _index_column(rows)
    for name in wanted.properties:
        if name.isdecimal() and 1 <= int(name) <= width:
            return int(name) - 1, index, ()
    if rows.header or wanted.properties:
        found, notes = chosen(path, "column", rows.header, wanted.properties)
        if found is not None:
            return rows.header.index(found), index, notes
    if width == 2 and index == 0:
        return 1, 0, ()
    last = width - 1
    if width in _POINT_COLUMNS and all(_is_whole(row[last]) for row in rows.cells):
        return last, None, (f"{path.name}: labels are the last of {width} columns",)
    if width == 2 and not rows.header:
        raise file_error(path, "expected one label, found 2 words", line=rows.lines[0])
    there = f": {', '.join(rows.header)}" if rows.header else ""
    raise file_error(
        path,
        f"has {width} columns{there}; say which holds the labels, by its name or its number from 1:"
        f" --label-property {width}",
    )


def _index_column(rows: Rows) -> int | None:
    """The first column, where it counts the elements by its name, or in fact."""
    first = [row[0] for row in rows.cells]
    if not all(cell.isdecimal() and len(cell) < 19 for cell in first):
        return None
    if rows.header:
        return 0 if plain(rows.header[0]) in _INDICES else None
    ids = np.array([int(cell) for cell in first])
    counts = np.array_equal(np.sort(ids) - ids.min(), np.arange(len(ids))) and ids.min() <= 1
    return 0 if counts and len(ids) > 1 else None


def _is_whole(cell: str) -> bool:
    return _is_number(cell) and (cell.lower() in NO_LABEL or float(cell).is_integer())


def _listing(path: Path, cells: Cells, lines: Sequence[int], wanted: Wanted) -> Listing:
    """Labels from the cells of a column: numbers, or names."""
    numeric = [_is_number(cell) for cell in cells]
    missing = [cell.lower() in NO_LABEL for cell in cells]
    if not any(n and not m for n, m in zip(numeric, missing, strict=True)):
        labels, names = numbered_names(cells)
        return Listing(labels=labels, names=names or None)
    if not all(numeric):
        wrong = numeric.index(False)
        raise file_error(
            path,
            f"{word(cells[wrong])} is not an integer, which the labels before or behind it"
            " are; the file is damaged or of another format",
            line=lines[wrong],
        )
    try:
        numbers: IntArray | FloatArray = np.array(list(map(int, cells)), np.int64)
    except ValueError:
        words = ("nan" if m else cell for m, cell in zip(missing, cells, strict=True))
        numbers = np.array(list(map(float, words)), np.float64)
    except OverflowError as error:
        large = next(k for k, cell in enumerate(cells) if abs(int(cell)) >= 2**63)
        raise file_error(
            path, f"{word(cells[large])} is too large for a label", line=lines[large]
        ) from error
    return Listing(labels=whole_labels(path, numbers, line_of=lambda k: lines[k]))


def _placed(path: Path, found: Listing, ids: IntArray, wanted: Wanted) -> Listing:
    """Labels that stand beside what they belong to."""
    n, noun = wanted.bearers(path, ids)
    groups = [(k, str(ids[k]), ids[k : k + 1]) for k in range(len(ids))]
    rows, notes = labels_of_ids(path, groups, n, noun=noun)
    labels = np.where(rows < 0, UNLABELLED, found.labels[rows])
    return Listing(labels=labels, names=found.names, of=wanted.bearer, notes=notes)
