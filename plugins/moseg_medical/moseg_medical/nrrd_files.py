"""NRRD: masks in ``.nrrd``, and label maps back (teem.sourceforge.net/nrrd/format.html).

A header says in which *space* its directions are: ``left-posterior-superior`` as a rule, which is
turned into RAS by the signs of x and y. Without directions cells have the ``spacings``, or side 1.
A label map is written with the header that was read, in the same space, but for what is about the
values; with the keys that 3D Slicer knows segments by (:mod:`moseg_medical.label_names`). Keys of
segments that the input had are left out.
"""

from __future__ import annotations

import io
import math
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from moseg_core import Labelling, ReadLimits, Result, Shape, ShapeError
from moseg_medical.label_names import segment_keys, segments_in
from moseg_medical.masks import (
    FloatArray,
    affine_of,
    label_map,
    labels_on,
    quietly,
    shape_of_mask,
    stem_of,
)
from moseg_medical.unpacking import unpacked

SUFFIXES = (".nrrd",)
_HEADER = "nrrd"
_LPS = "left-posterior-superior"
_RAS = (1.0, 1.0, 1.0)
#: Signs that turn a space into RAS; in all of them the third axis goes up the patient.
_SIGNS = {
    "right-anterior-superior": _RAS,
    "ras": _RAS,
    _LPS: (-1.0, -1.0, 1.0),
    "lps": (-1.0, -1.0, 1.0),
    "left-anterior-superior": (-1.0, 1.0, 1.0),
    "las": (-1.0, 1.0, 1.0),
}
_OF_SEGMENTS = re.compile(r"Segment(ation)?\d*_")
#: Fields that are about the values, or where they are; made anew.
_OF_VALUES = {
    *("type", "dimension", "sizes", "endian", "encoding", "content", "min", "max", "old min"),
    *("old max", "data file", "line skip", "byte skip", "sample units", "block size", "number"),
}
#: How values are packed, by the names of it that a header may give.
_PACKINGS: dict[str, Literal["gzip", "bzip2"]] = {
    **dict.fromkeys(("gzip", "gz"), "gzip"),
    **dict.fromkeys(("bzip2", "bz2"), "bzip2"),
}
#: Bytes of a value, by what the name of its type has in it; the first that fits.
_BYTES = {
    **{"8": 1, "char": 1, "16": 2, "short": 2, "32": 4, "64": 8, "long": 8},
    **{"int": 4, "float": 4},
}
#: Cells that no file holds, whatever limits are lifted.
_MOST = 2**40
_LIMITS = ReadLimits()


def read_nrrd(path: Path, *, limits: ReadLimits = _LIMITS) -> Shape:
    """Read a mask or label map as a solid voxel grid.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Returns
    -------
    Shape
        An element for each cell that is not 0, the first axis of the file first, in C order, in
        millimetres, x to the right, y to the front, z up, if the file says in which space it is.

    Raises
    ------
    ShapeError
        The file is no such file, is cut off, holds an image and no mask, or is empty; its values
        are in another file, or become more than the limits allow.
    """
    values, affine, header = _volume(path, limits)
    name = stem_of(path.name, SUFFIXES)
    shape = shape_of_mask(path, values, affine, name=name, header={_HEADER: header}, limits=limits)
    return shape.with_up("z") if _space(header) in _SIGNS else shape


def nrrd_labels(path: Path, shape: Shape, *, limits: ReadLimits = _LIMITS) -> Labelling:
    """What a label map says of the cells of a shape; with the names of its segments.

    Parameters
    ----------
    path : Path
    shape : Shape
        A voxel grid of the same size, at the same place.
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        The file is no such file, labels another grid, or becomes more than the limits allow.
    """
    values, affine, header = _volume(path, limits)
    return labels_on(path, shape, values, affine, segments_in(header))


def _volume(path: Path, limits: ReadLimits) -> tuple[Any, FloatArray, dict[str, Any]]:
    """The values, the affine and the header."""
    import nrrd

    stream = io.BytesIO(path.read_bytes())
    try:
        with quietly():
            header = dict(nrrd.read_header(stream))
            _check(path, header, limits)
            values = _values(path, header, stream, limits)
        affine = _affine(path, header)
    except (
        nrrd.NRRDError,
        ValueError,
        TypeError,
        KeyError,
        IndexError,
        EOFError,
        StopIteration,  # an empty file
        OSError,
        OverflowError,
        MemoryError,
        zlib.error,
    ) as error:
        if isinstance(error, ShapeError):
            raise
        line = " ".join(str(error).split())[:120]
        raise ShapeError(
            f"{path.name} is not a NRRD file, or is damaged ({line}); save it anew"
        ) from error
    # A list of one layer in front, as 3D Slicer may write it.
    while values.ndim > 3 and values.shape[0] == 1:
        values = values[0]
    return values, affine, header


def _check(path: Path, header: dict[str, Any], limits: ReadLimits) -> None:
    """Refuse values elsewhere, as a file that names others could name any; and too many cells."""
    for key in ("data file", "datafile"):
        if key in header:
            raise ShapeError(
                f"{path.name} keeps its values in another file, '{header[key]!s:.80}'; save header"
                f" and values as one .nrrd file"
            )
    sizes = [int(size) for size in header["sizes"]]
    if not sizes or min(sizes) < 1 or math.prod(sizes) > _MOST:
        raise ShapeError(
            f"{path.name} announces a volume of {' x '.join(map(str, sizes))} cells; it is damaged"
        )
    limits.refuse_cells(path, occupied=0, grid=math.prod(sizes), size=path.stat().st_size)


def _values(
    path: Path, header: dict[str, Any], stream: io.BytesIO, limits: ReadLimits
) -> npt.NDArray[Any]:
    """The values behind a header; packed ones unpacked as far as it announces them."""
    import nrrd

    lines = int(header.get("lineskip", header.get("line skip", 0)))
    if lines > stream.getvalue().count(b"\n"):
        raise ValueError(f"it is to skip {lines} lines and has fewer")
    packing = _PACKINGS.get(header["encoding"])
    values: npt.NDArray[Any]
    if packing is None:
        values = nrrd.read_data(header, stream, index_order="F")
        return values
    for _ in range(lines):
        stream.readline()
    skipped = int(header.get("byteskip", header.get("byte skip", 0)))
    item = next((count for word, count in _BYTES.items() if word in header["type"]), 8)
    count = math.prod(map(int, header["sizes"])) * item
    announced = max(skipped, 0) + count
    plain = unpacked(path, stream.read(), packing, announced=announced, limits=limits)
    if skipped >= 0 and plain.getbuffer().nbytes > announced:  # else the values are the last ones
        raise ValueError(f"it unpacks to {plain.getbuffer().nbytes} bytes instead of {announced}")
    bare = {key: value for key, value in header.items() if key not in ("lineskip", "line skip")}
    values = nrrd.read_data({**bare, "encoding": "raw"}, plain, index_order="F")
    return values


def _affine(path: Path, header: dict[str, Any]) -> FloatArray:
    """(4, 4) float: from the index of a cell to its middle, in RAS."""
    affine = np.eye(4)
    directions = header.get("space directions")
    if directions is None:
        spacings = np.array(header.get("spacings", [1.0] * 3), np.float64)[-3:]
        affine[:3, :3] = np.diag(np.where(np.isfinite(spacings) & (spacings > 0), spacings, 1.0))
        return affine
    rows = np.array([row for row in _rows(directions) if np.isfinite(row).all()], np.float64)
    if rows.shape != (3, 3):
        raise ShapeError(
            f"{path.name} has {len(rows)} axes in space, not three; save a volume of three axes"
        )
    signs = np.array(_SIGNS.get(_space(header), _RAS))
    origin = np.array(header.get("space origin", np.zeros(3)), np.float64)
    affine[:3, :3] = (rows * signs).T
    affine[:3, 3] = origin * signs
    return affine


def _space(header: dict[str, Any]) -> str:
    """The space that directions are in, in small letters; empty where the file does not say."""
    return str(header.get("space", "")).lower()


def _rows(directions: Any) -> Iterator[FloatArray]:
    """A vector for each axis, NaN for one that is not in space, such as a list of layers."""
    for row in directions:
        yield np.full(3, np.nan) if row is None else np.asarray(row, np.float64)


def write_nrrd(result: Result) -> bytes:
    """A label map of the grid that was read: 0 outside, ``i + 1`` in part ``i``, with its names.

    Parameters
    ----------
    result : Result
        Of a voxel grid.

    Raises
    ------
    UsageError
        The shape is no voxel grid.
    """
    import nrrd

    grid, numbers = label_map(result, "NRRD")
    known = grid.header.get(_HEADER)
    if known is None:
        affine = affine_of(grid)
        signs = np.array(_SIGNS[_LPS])
        header: dict[str, Any] = {
            "space": _LPS,
            "space directions": affine[:3, :3].T * signs,
            "space origin": affine[:3, 3] * signs,
            "kinds": ["domain"] * 3,
        }
    else:
        header = {
            key: _of_space(value, known)
            for key, value in known.items()
            if key not in _OF_VALUES and not _OF_SEGMENTS.match(key)
        }
    header |= {"encoding": "gzip", **segment_keys(result.problem.labels, numbers.shape)}
    return _encoded(nrrd, numbers, header)


def _of_space(value: Any, header: dict[str, Any]) -> Any:
    """What a field says of the three axes in space, without that of a list of layers."""
    axes = int(header["dimension"])
    listed = isinstance(value, list | np.ndarray) and len(value) == axes > 3
    return value[axes - 3 :] if listed else value


def _encoded(nrrd: Any, numbers: Any, header: dict[str, Any]) -> bytes:
    """The file as bytes, without the lines by which pynrrd says when it wrote them."""
    stream = io.BytesIO()
    with quietly():
        nrrd.write(stream, numbers, header, index_order="F", compression_level=6)
    lines, _, values = stream.getvalue().partition(b"\n\n")
    kept = [line for line in lines.split(b"\n") if not line.startswith(b"#")]
    return b"\n".join(kept) + b"\n\n" + values
