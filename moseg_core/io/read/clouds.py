"""Point clouds from text and from arrays: what readers of clouds have in common.

A text file has a point a line (:mod:`moseg_core.io.read.point_rows`); its columns are known by
their names or, without such, by what stands in them (:mod:`moseg_core.io.read.point_columns`).
The endings ``.xyz``, ``.pts``, ``.asc``, ``.txt`` and ``.csv`` are read alike. An array, from an
``.npy`` file, is such a table without names.

A cell that is empty or says that it is no number makes a point that is not finite: an element
without weight, so that the others keep their rows (:mod:`moseg_core.shape.cloud`).
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, quoted, read_file, refuse_far
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.io.read.point_columns import named_columns, passed_over, unnamed_columns
from moseg_core.io.read.point_rows import MISSING, PointRows, read_rows
from moseg_core.io.read.text_rows import end_notes, floats, word
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray


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
    refuse_far(path, points, np.arange(len(points)), "point")
    try:
        return Shape.from_points(points, normals=normals, areas=areas, name=path.stem, notes=notes)
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error


def shape_from_table(path: Path, table: FloatArray, *, notes: Iterable[str] = ()) -> Shape:
    """The point cloud of a table without names.

    Parameters
    ----------
    path : Path
    table : (F, k) float
        The place in the first three columns, maybe a normal among the others.
    notes : iterable of str

    Raises
    ------
    ShapeError
        The points make no surface; the message begins with the file's name.

    Examples
    --------
    >>> shape_from_table(Path("a/tile.npy"), np.eye(4)[:3]).notes[0]
    'passed over: column 4'
    """
    columns = unnamed_columns(table.shape[1], lambda k: table[:, k])
    said = passed_over(table.shape[1], list(columns.values()))
    return _shape(path, {name: table[:, k] for name, k in columns.items()}, [*notes, *said])


def read_points(path: Path, *, limits: ReadLimits = LIMITS) -> Shape:
    r"""Read a text file of points: one element per row.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        The file cannot be read, names no columns x, y, z or one of them twice, or a row is cut off
        or holds no numbers where they should stand.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "corner.csv"
    ...     _ = file.write_text("id,x,y,z,area\n7,1,0,0,0.5\n8,0,1,0,0.5\n9,0,0,1,1\n")
    ...     read_points(file).areas.tolist()
    [0.5, 0.5, 1.0]
    """
    data = read_file(path)
    found = read_rows(path, data)
    width = len(found.rows[0])
    limits.refuse_columns(path, width)
    if found.names:
        columns = named_columns(found.names)
        for k in columns.values():
            name = found.names[k]
            if found.names.count(name) > 1:
                places = [str(i + 1) for i, other in enumerate(found.names) if other == name]
                raise file_error(
                    path,
                    f"names several columns {quoted(name)}: {', '.join(places[:8])}; leave one of"
                    " them, or give the others another name",
                )
        for axis in "xyz":
            if axis not in columns:
                raise file_error(
                    path,
                    f"has no column '{axis}' among {', '.join(map(quoted, found.names[:8]))};"
                    " name its columns x, y, z",
                )
        if len({"nx", "ny", "nz"} & set(columns)) < 3:
            columns = {name: k for name, k in columns.items() if not name.startswith("n")}
    elif width < 3:
        raise file_error(
            path,
            f"expected x y z in the first columns, found {width} words that begin with"
            f" {word(found.rows[0][0])}",
            line=found.lines[0],
        )
    else:
        columns = unnamed_columns(width, lambda k: _numbers(path, found, k, needed=k < 3))
    said = passed_over(width, list(columns.values()), found.names)
    notes = [*found.notes, *said, *end_notes(data)]
    values = {name: _column(path, found, k) for name, k in columns.items()}
    return _shape(path, values, notes)


def _shape(path: Path, values: dict[str, FloatArray], notes: list[str]) -> Shape:
    normals = None
    if "nx" in values:
        normals = np.stack([values[f"n{axis}"] for axis in "xyz"], axis=1)
    return shape_from_points(
        path,
        np.stack([values[axis] for axis in "xyz"], axis=1),
        normals=normals,
        areas=values.get("area"),
        notes=notes,
    )


def _column(path: Path, found: PointRows, k: int) -> FloatArray:
    """The numbers of a column that is needed."""
    values = _numbers(path, found, k, needed=True)
    assert values is not None  # else refused
    return values


def _numbers(path: Path, found: PointRows, k: int, *, needed: bool) -> FloatArray | None:
    """The numbers of a column, "nan" where one is missing; None where others are words."""
    cells = [row[k] for row in found.rows]
    try:
        # Python reads 1_000 as a number; no file format does.
        if b"_" not in b"".join(cells):
            return np.array(list(map(float, cells)), np.float64)
    except ValueError:
        pass  # found below
    if cells[-1] == b"" and not found.ended:
        raise file_error(path, "the last row is cut off; export it again", line=found.lines[-1])
    cells = [b"nan" if not cell or cell.lower() in MISSING else cell for cell in cells]
    try:
        return floats(path, cells, lambda i: found.lines[i])
    except ShapeError:
        if needed:
            raise
        return None
