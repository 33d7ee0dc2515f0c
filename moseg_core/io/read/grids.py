"""Voxel grids: ``.npy`` arrays and the run-length encoded ``.binvox``.

Both are read as solids, every occupied cell an element, in C order; the command line's
``--voxels surface`` (:meth:`moseg_core.shape.shape.Shape.with_elements`) reads the surface alone.
An array of two axes, or of floats with three columns at its end, is no grid but a cloud of points
(:mod:`moseg_core.io.read.clouds`).

An array knows no units: its cells have side 1 and begin at the origin. A ``.binvox`` file (Min
2004, the output of his program of that name) says in its header where the grid is: cell
``(i, j, k)`` has its least corner at ``translate + (i, j, k) * scale / dim``. Its cells follow each
other with y fastest, then z, then x, as pairs of bytes: a value and how often it comes.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.clouds import shape_from_table
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.io.read.npy_bytes import array_from_bytes
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray

_MOST_COLUMNS = 100


def read_npy(path: Path, *, limits: ReadLimits = LIMITS) -> Shape:
    """Read an array of three axes as a voxel grid, what is not 0 is occupied; or points.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        The file is no such array, or nothing in it is occupied, or the points make no surface, or
        there is more of them than the limits allow.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "block.npy"
    ...     np.save(file, np.ones((2, 2, 2), bool))
    ...     read_npy(file).volume
    8.0
    """
    array = read_array(path)
    if array.dtype.kind in "iuf" and array.size:
        if array.ndim == 2 and array.shape[1] >= 3:
            if len(array) == 3 and array.shape[1] > _MOST_COLUMNS:
                raise file_error(
                    path,
                    f"holds an array of shape {array.shape}; points are rows: save it transposed",
                )
            limits.refuse_columns(path, array.shape[1])
            return shape_from_table(path, array.astype(np.float64))
        if array.ndim == 3 and array.shape[2] == 3 and array.dtype.kind == "f":
            note = f"{array.shape[0]} x {array.shape[1]} points, row by row"
            return shape_from_table(path, array.reshape(-1, 3).astype(np.float64), notes=[note])
    if array.ndim != 3:
        raise file_error(
            path,
            f"holds an array of shape {array.shape}; a voxel grid has three axes, a cloud of points"
            f" the shape (N, 3), or more columns",
        )
    if array.dtype.kind not in "biu":
        raise file_error(
            path, f"holds {array.dtype}; save the grid as bool, such as 'values > threshold'"
        )
    if array.size and array.min() < 0:
        raise file_error(path, "holds negative numbers; save 'labels >= 0', or the like, as bool")
    limits.refuse_cells(path, occupied=0, grid=array.size, size=array.nbytes)
    occupied = array != 0
    limits.refuse_cells(
        path, occupied=int(np.count_nonzero(occupied)), grid=array.size, size=array.nbytes
    )
    return _shape(path, occupied, 1.0, (0.0, 0.0, 0.0))


def read_array(path: Path) -> npt.NDArray[np.generic]:
    """The array in an ``.npy`` file.

    Raises
    ------
    ShapeError
        The file cannot be read, is no such file, is cut off, or holds objects.
    """
    try:
        return array_from_bytes(read_file(path))
    except ValueError as error:
        raise file_error(path, str(error)) from error


def read_binvox(path: Path, *, limits: ReadLimits = LIMITS) -> Shape:
    """Read a binvox file as a voxel grid, at its place and in its units.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        The file is malformed or cut off, or nothing in it is occupied, or more than the limits
        allow.
    """
    data = read_file(path)
    if not data.startswith(b"#binvox"):
        raise file_error(path, "does not begin with '#binvox'; it is not a binvox file")
    head = re.search(rb"^data\r?\n", data, re.MULTILINE)
    if head is None:
        raise file_error(path, "has no line 'data' behind its header; it is cut off")
    fields = {
        words[0]: words[1:]
        for words in map(bytes.split, data[: head.start()].splitlines())
        if words
    }
    sizes = _numbers(path, fields, b"dim", 3, "1 1 1")
    if not all(size.is_integer() and 1 <= size < 2**31 for size in sizes):
        raise file_error(
            path,
            f"has a grid of {' x '.join(f'{size:.10g}' for size in sizes)}, which are no numbers of"
            " cells; it is damaged",
        )
    depth, width, height = map(int, sizes)
    translate = _numbers(path, fields, b"translate", 3, "0 0 0")
    (scale,) = _numbers(path, fields, b"scale", 1, "1")
    if not 0 < scale < math.inf or not all(map(math.isfinite, translate)):
        raise file_error(path, f"has the scale {scale:g} and translation {translate}; repair it")
    limits.refuse_cells(path, occupied=0, grid=depth * width * height, size=len(data))
    runs = np.frombuffer(data, np.uint8, len(data) - head.end(), head.end())
    if len(runs) % 2 or int(runs[1::2].sum(dtype=np.int64)) != depth * width * height:
        raise file_error(
            path,
            f"holds {int(runs[1::2].sum(dtype=np.int64))} cells instead of"
            f" {depth * width * height}; it is cut off or damaged",
        )
    occupied = int(runs[1::2][runs[::2] != 0].sum(dtype=np.int64))
    if not occupied:
        raise file_error(path, f"is empty: none of the {depth * width * height} cells is occupied")
    limits.refuse_cells(path, occupied=occupied, grid=depth * width * height, size=len(data))
    cells = np.repeat(runs[::2] != 0, runs[1::2]).reshape(depth, height, width)
    pitch = scale / max(depth, width, height)
    return _shape(path, cells.transpose(0, 2, 1), pitch, translate)


def _numbers(
    path: Path, fields: dict[bytes, list[bytes]], name: bytes, count: int, example: str
) -> list[float]:
    """The numbers of a header line."""
    try:
        numbers = [float(token) for token in fields[name]]
    except (KeyError, ValueError):
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise file_error(
            path, f"has no header line like '{name.decode()} {example}'; it is damaged"
        )
    return numbers


def _shape(path: Path, occupied: BoolArray, pitch: float, origin: npt.ArrayLike) -> Shape:
    try:
        return Shape.from_voxels(occupied, pitch=pitch, origin=origin, name=path.stem)
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error
