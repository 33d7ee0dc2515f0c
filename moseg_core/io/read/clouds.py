"""Point clouds from text: ``.xyz`` and ``.csv``, and what readers of clouds have in common.

An ``.xyz`` file has a point a line, its numbers parted by blanks: x, y, z and maybe a normal. Many
programs put a colour where others put the normal; three more numbers are taken for a normal where
all of them are of length 0 or about 1, and left alone otherwise. A ``.csv`` file names its columns
in the first line, ``x``, ``y``, ``z`` and maybe ``nx``, ``ny``, ``nz`` and ``area``, in any order
and among others; without such a line the columns are those of an ``.xyz`` file.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, read_file, refuse_far
from moseg_core.io.read.text_rows import Row, floats, text_rows, word
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

_COLUMNS = ("x", "y", "z", "nx", "ny", "nz", "area")


def shape_from_points(
    path: Path,
    points: FloatArray,
    *,
    normals: FloatArray | None = None,
    areas: FloatArray | None = None,
    notes: Iterable[str] = (),
) -> Shape:
    """The point cloud that a file describes, named after the file.

    Parameters
    ----------
    path : Path
    points : (F, 3) float, model units
    normals : (F, 3) float, optional
    areas : (F,) float, model units squared, optional
    notes : iterable of str
        What the reader passed over or repaired; the shape's first notes.

    Raises
    ------
    ShapeError
        The points make no surface; the message begins with the file's name.

    Examples
    --------
    >>> shape_from_points(Path("a/tile.xyz"), np.eye(3)).name
    'tile'
    """
    refuse_far(path, points, "point")
    try:
        return Shape.from_points(points, normals=normals, areas=areas, name=path.stem, notes=notes)
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error


def read_xyz(path: Path) -> Shape:
    r"""Read an XYZ file: one element per line.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ShapeError
        The file cannot be read, or a line does not hold three or six numbers.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "corner.xyz"
    ...     _ = file.write_text("# three points\n1 0 0\n0 1 0\n0 0 1\n")
    ...     read_xyz(file).n_elements
    3
    """
    rows, lines = text_rows(read_file(path))
    if not rows:
        raise file_error(path, "holds nothing but comments; export it again")
    return _of_columns(path, rows, lines)


def read_csv(path: Path) -> Shape:
    r"""Read a table of points, its cells parted by commas, semicolons or tabs.

    Parameters
    ----------
    path : Path

    Raises
    ------
    ShapeError
        The file cannot be read, columns are missing, or cells hold no numbers.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "corner.csv"
    ...     _ = file.write_text("id,x,y,z,area\n7,1,0,0,0.5\n8,0,1,0,0.5\n9,0,0,1,1\n")
    ...     read_csv(file).areas.tolist()
    [0.5, 0.5, 1.0]
    """
    text = read_file(path).removeprefix(b"\xef\xbb\xbf").splitlines()
    lines = [number for number, line in enumerate(text, 1) if line.strip()]
    separator = next((mark for mark in (b",", b";", b"\t") if mark in text[lines[0] - 1]), b",")
    rows = [[cell.strip().strip(b'"') for cell in text[n - 1].split(separator)] for n in lines]
    header = [cell.decode("utf-8", "replace").lower() for cell in rows[0]]
    if not set(header) & set(_COLUMNS):
        return _of_columns(path, rows, lines)
    for axis in "xyz":
        if axis not in header:
            raise file_error(
                path, f"has no column '{axis}'; name its columns x, y, z", line=lines[0]
            )
    rows, lines = rows[1:], lines[1:]
    if not rows:
        raise file_error(path, "has no rows below its header; export it again")
    for row, line in zip(rows, lines, strict=True):
        if len(row) != len(header):
            raise file_error(
                path, f"the row has {len(row)} cells, the header {len(header)}", line=line
            )

    def column(name: str) -> FloatArray:
        place = header.index(name)
        return floats(path, [row[place] for row in rows], lambda i: lines[i])

    points = np.stack([column(axis) for axis in "xyz"], axis=1)
    normals = None
    if {"nx", "ny", "nz"} <= set(header):
        normals = np.stack([column(f"n{axis}") for axis in "xyz"], axis=1)
    areas = column("area") if "area" in header else None
    return shape_from_points(path, points, normals=normals, areas=areas)


def _of_columns(path: Path, rows: list[Row], lines: list[int]) -> Shape:
    """The cloud of rows of three or six numbers, all of the same length."""
    width = len(rows[0])
    if width not in (3, 6):
        raise file_error(
            path,
            f"expected x y z, or x y z and a normal, found {width} words that begin with"
            f" {word(rows[0][0])}",
            line=lines[0],
        )
    for row, line in zip(rows, lines, strict=True):
        if len(row) != width:
            raise file_error(
                path,
                f"the row has {len(row)} numbers, the first {width}; it is cut off or damaged",
                line=line,
            )
    tokens = [token for row in rows for token in row]
    table = floats(path, tokens, lambda i: lines[i // width]).reshape(-1, width)
    return shape_from_points(path, table[:, :3], normals=_normals(table[:, 3:]))


def _normals(columns: FloatArray) -> FloatArray | None:
    """The columns as normals; None where they are something else."""
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.sqrt((columns**2).sum(axis=1))
        unit = (length == 0.0) | (np.abs(length - 1.0) < 0.1)
    return columns if columns.shape[1] == 3 and unit.all() and length.any() else None
