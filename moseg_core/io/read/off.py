"""OFF files: a header, the counts, one vertex a line, one polygon a line.

Read are the ASCII variants in three dimensions: ``OFF`` and, with more columns behind the
coordinates, ``COFF``, ``NOFF``, ``STOFF`` and their combinations. The extra columns, and the
colours behind a face's corners, are left alone. Tolerated are comments, the counts on the line
of the keyword (even without a blank between them), a missing keyword and a missing number of
edges, which files in circulation all have. Not tolerated is a file that holds more or less than
its counts say.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from moseg_core.io.read.checked import file_error, read_file, shape_from_polygons
from moseg_core.io.read.text_rows import (
    Row,
    floats,
    integers,
    leading_floats,
    line_of_item,
    text_rows,
    word,
)
from moseg_core.shape.shape import Shape
from moseg_core.types import IntArray

_KEYWORD = re.compile(rb"(ST)?C?N?(4)?(n)?OFF")
_COUNTS = "the numbers of vertices, faces and edges"


def read_off(path: Path) -> Shape:
    r"""Read an OFF file: one element per face line, in file order.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Shape
        Named after the file.

    Raises
    ------
    ShapeError
        The file cannot be read or is not a mesh in OFF; says where and why.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "tile.off"
    ...     _ = file.write_text("OFF\n4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
    ...     read_off(file).n_elements
    1
    """
    rows, lines = text_rows(read_file(path))
    if not rows:
        raise file_error(path, "holds nothing but comments; export it again")
    rows, lines = _without_keyword(path, rows, lines)
    n_vertices, n_faces = _counts(path, rows, lines)
    rows, lines = rows[1:], lines[1:]
    announced = f"announces {n_vertices} vertices and {n_faces} faces, but"
    total = n_vertices + n_faces
    if len(rows) < n_vertices:
        raise file_error(path, f"{announced} ends after {len(rows)} vertices; it is cut off")
    if len(rows) < total:
        missing = len(rows) - n_vertices
        raise file_error(path, f"{announced} ends after {missing} faces; it is cut off")
    if len(rows) > total:
        raise file_error(
            path, f"{announced} goes on behind them; correct the counts", line=lines[total]
        )
    vertices = leading_floats(path, rows[:n_vertices], lines[:n_vertices])
    corners, offsets = _faces(path, rows[n_vertices:], lines[n_vertices:])
    return shape_from_polygons(path, vertices, corners, offsets)


def _without_keyword(path: Path, rows: list[Row], lines: list[int]) -> tuple[list[Row], list[int]]:
    """Take away the keyword; what is left begins with the counts."""
    first, rest = rows[0][0], rows[0][1:]
    match = _KEYWORD.match(first)
    if match is None:
        if first.isdigit():
            return rows, lines
        raise file_error(
            path,
            f"begins with {word(first)} instead of OFF; it is not an OFF file",
            line=lines[0],
        )
    if match.group(2) or match.group(3):
        raise file_error(
            path, f"{word(first)} is not in three dimensions; export it as OFF", line=lines[0]
        )
    if rest and rest[0].upper() == b"BINARY":
        raise file_error(path, "binary OFF is not supported; export it as ASCII", line=lines[0])
    glued = first[match.end() :]
    rest = [glued, *rest] if glued else rest
    if rest:
        return [rest, *rows[1:]], lines
    return rows[1:], lines[1:]


def _counts(path: Path, rows: list[Row], lines: list[int]) -> tuple[int, int]:
    if not rows:
        raise file_error(path, f"ends before {_COUNTS}; it is cut off")
    if not 2 <= len(rows[0]) <= 3:
        raise file_error(
            path,
            f"expected {_COUNTS}, found {len(rows[0])} words; it is not an OFF file",
            line=lines[0],
        )
    counts = integers(path, rows[0], lambda _: lines[0])
    if counts.min() < 0:
        raise file_error(path, f"{_COUNTS} must not be negative", line=lines[0])
    return int(counts[0]), int(counts[1])


def _faces(path: Path, rows: list[Row], lines: list[int]) -> tuple[IntArray, IntArray]:
    """Corners and offsets of the face lines: a number of corners, the corners, maybe colours."""
    sizes = integers(path, [row[0] for row in rows], lambda i: lines[i])
    held = np.array([len(row) - 1 for row in rows], np.int64)
    bad = (sizes < 3) | (sizes > held)
    if bad.any():
        face = int(np.argmax(bad))
        if sizes[face] < 3:
            what = f"a face needs at least 3 corners, this one has {sizes[face]}; remove it"
        else:
            what = (
                f"the face announces {sizes[face]} corners and holds {held[face]};"
                " the file is cut off or damaged"
            )
        raise file_error(path, what, line=lines[face])
    offsets = np.zeros(len(rows) + 1, np.int64)
    np.cumsum(sizes, out=offsets[1:])
    ends = (sizes + 1).tolist()
    tokens = [token for row, end in zip(rows, ends, strict=True) for token in row[1:end]]
    corners = integers(path, tokens, line_of_item(offsets, lines))
    colours = [
        (token, line)
        for row, end, line in zip(rows, ends, lines, strict=True)
        for token in row[end:]
    ]
    floats(path, [token for token, _ in colours], lambda i: colours[i][1])
    return corners, offsets
