"""OFF files: a header, the counts, one vertex a line, one polygon a line.

Read are the ASCII variants in three dimensions: ``OFF`` and, with more columns behind the
coordinates, ``COFF``, ``NOFF``, ``STOFF`` and their combinations. The extra columns, and the
colours behind a face's corners, are left alone. Tolerated are comments, the counts on the line
of the keyword (even without a blank between them), a missing keyword and a missing number of
edges, which files in circulation all have. Faces of one or two corners are passed over, with a
note. Not tolerated is a file that holds more or less than
its counts say.
"""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np

from moseg_core.io.read.checked import (
    file_error,
    read_file,
    shape_from_polygons,
    small_faces_note,
)
from moseg_core.io.read.text_rows import (
    Row,
    end_notes,
    floats,
    integers,
    leading_floats,
    line_of_item,
    text_rows,
    word,
)
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray

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
    data = read_file(path)
    regular = _regular_mesh(data)
    if regular is not None:
        vertices, corners = regular
        return shape_from_polygons(
            path, vertices, corners, np.arange(0, len(corners) + 1, 3), notes=end_notes(data)
        )
    rows, lines = text_rows(data)
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
    notes: list[str] = []
    vertices = leading_floats(path, rows[:n_vertices], lines[:n_vertices])
    rows, lines = rows[n_vertices:], lines[n_vertices:]
    small = [i for i, row in enumerate(rows) if row[0] in (b"1", b"2") and len(row) > int(row[0])]
    if small:
        notes = small_faces_note(len(small), f"line {lines[small[0]]}")
        left = np.delete(np.arange(len(rows)), small).tolist()
        rows, lines = [rows[i] for i in left], [lines[i] for i in left]
    corners, offsets = _faces(path, rows, lines)
    return shape_from_polygons(path, vertices, corners, offsets, notes=notes + end_notes(data))


def _regular_mesh(data: bytes) -> tuple[FloatArray, IntArray] | None:
    """Vertices (V, 3) and corners (3 F,) of a file of plain triangles, without regard to lines.

    Ten times as fast as row by row. None where anything is out of the ordinary, which the slow
    reading then accepts or names.
    """
    head = re.match(rb"OFF\s+(\d{1,9})[ \t]+(\d{1,9})([ \t]+\d+)?[ \t]*\r?\n", data)
    if head is None or re.search(rb"[^0-9eE+\-.\s]", memoryview(data)[head.end() :]):
        return None
    n_vertices, n_faces = int(head[1]), int(head[2])
    body = data[head.end() :]
    ends = np.flatnonzero(np.frombuffer(body, np.uint8) == ord("\n"))
    lines = len(ends) + (not body.endswith(b"\n"))
    if min(n_faces, n_vertices) < 1 or lines != n_vertices + n_faces:
        return None
    if re.search(rb"[^0-9\s]", memoryview(body)[ends[n_vertices - 1] :]):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # words that are no numbers
        try:
            numbers = np.fromstring(body, np.float64, sep=" ")
        except (DeprecationWarning, ValueError):
            return None
    if len(numbers) != 3 * n_vertices + 4 * n_faces:
        return None
    faces = numbers[3 * n_vertices :].reshape(-1, 4)
    if (faces[:, 0] != 3.0).any() or faces.max() >= n_vertices + 3:
        return None
    corners = faces[:, 1:].astype(np.int64).reshape(-1)
    return numbers[: 3 * n_vertices].reshape(-1, 3), corners


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
