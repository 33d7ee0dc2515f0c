"""NRRD: masks in ``.nrrd``, and label maps back (teem.sourceforge.net/nrrd/format.html).

A header says in which *space* its directions are: ``left-posterior-superior`` as a rule, which is
turned into RAS by the signs of x and y. Without directions cells have the ``spacings``, or side 1.
A label map is written with the header that was read, in the same space, but for what is about the
values; with the keys that 3D Slicer knows segments by (:mod:`moseg_medical.label_names`). Keys of
segments that the input had are left out.
"""

from __future__ import annotations

import bz2
import io
import math
import re
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

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

SUFFIXES = (".nrrd",)
_HEADER = "nrrd"
_GZIP = ("gzip", "gz")
_PACKED = (*_GZIP, "bzip2", "bz2")
_OF_GZIP = zlib.MAX_WBITS | 16
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


def read_nrrd(path: Path, *, limits: ReadLimits | None = None) -> Shape:
    """Read a mask or label map as a solid voxel grid.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional
        How large a grid may be.

    Returns
    -------
    Shape
        An element for each cell that is not 0, the first axis of the file first, in C order, in
        millimetres, x to the right, y to the front, z up, if the file says in which space it is.

    Raises
    ------
    ShapeError
        The file is no such file, is cut off, holds an image and no mask, or is empty; its values
        are in another file.
    """
    limits = limits or ReadLimits()
    values, affine, header = _volume(path, limits)
    limits.refuse_cells(
        path, occupied=int(np.count_nonzero(values)), grid=values.size, size=path.stat().st_size
    )
    name = stem_of(path.name, SUFFIXES)
    shape = shape_of_mask(path, values, affine, name=name, header={_HEADER: header})
    return shape.with_up("z") if _space(header) in _SIGNS else shape


def nrrd_labels(path: Path, shape: Shape) -> Labelling:
    """What a label map says of the cells of a shape; with the names of its segments.

    Parameters
    ----------
    path : Path
    shape : Shape
        A voxel grid of the same size, at the same place.

    Raises
    ------
    ShapeError
        The file is no such file, or labels another grid.
    """
    values, affine, header = _volume(path, ReadLimits())
    return labels_on(path, shape, values, affine, segments_in(header))


def _volume(path: Path, limits: ReadLimits) -> tuple[Any, FloatArray, dict[str, Any]]:
    """The values, the affine and the header."""
    import nrrd

    stream = io.BytesIO(path.read_bytes())
    try:
        with quietly():
            header = dict(nrrd.read_header(stream))
            _check(path, header, limits)
            known, stream = _unpacked(nrrd, path, header, stream)
            values = nrrd.read_data(known, stream, index_order="F")
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
    """Refuse values elsewhere, since a file that names others could name any; and too many."""
    for key in ("data file", "datafile"):
        if key in header:
            raise ShapeError(
                f"{path.name} keeps its values in another file, '{header[key]!s:.80}'; save header"
                f" and values as one .nrrd file"
            )
    cells = math.prod(int(size) for size in header["sizes"])
    size = path.stat().st_size
    limits.refuse_cells(path, occupied=0, grid=cells, size=size)
    if any(int(header.get(key, 0)) > size for key in ("line skip", "lineskip")):
        raise ShapeError(f"{path.name} skips more lines than it has bytes; it is damaged")


def _unpacked(
    nrrd: Any, path: Path, header: dict[str, Any], stream: io.BytesIO
) -> tuple[dict[str, Any], io.BytesIO]:
    """Header and values of packed values that are unpacked, as many as the header announces.

    pynrrd unpacks all that there is, which may be any number.
    """
    encoding = header.get("encoding")
    if encoding not in _PACKED:
        return header, stream
    if any(int(header.get(key, 0)) for key in ("line skip", "lineskip", "byte skip", "byteskip")):
        raise ShapeError(f"{path.name} skips a part of its packed values; save it anew")
    needed = math.prod(map(int, header["sizes"])) * nrrd.reader._determine_datatype(header).itemsize
    unpacker = zlib.decompressobj(_OF_GZIP) if encoding in _GZIP else bz2.BZ2Decompressor()
    values = unpacker.decompress(stream.read(), max(0, needed) + 1)
    if len(values) != needed:
        more = "more" if len(values) > needed else "less"
        raise ShapeError(f"{path.name} holds {more} than it announces; it is damaged")
    return {**header, "encoding": "raw"}, io.BytesIO(values)


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
