"""Labels in numpy's files: an ``.npy`` row or grid, an array of an ``.npz`` archive.

Rows of integers, whole floats, bools or names; a column or row of a matrix too. An array of the
size of a voxel grid has labels at its elements, whatever it has elsewhere. In a grid of three
axes, as moseg writes for voxels, -1 stands where there is no element, and elements follow each
other in C order.

An archive is compressed, a thousandfold where it can be, so what it says of its size is added up
before anything is unpacked; of a member that is larger than that the rest is not unpacked.
"""

from __future__ import annotations

import io
import lzma
import struct
import sys
import zlib
from pathlib import Path
from zipfile import BadZipFile, ZipFile

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.io.labels.listing import Listing, Wanted, numbered_names, whole_labels
from moseg_core.io.labels.properties import chosen, names_labels
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.grids import read_array
from moseg_core.io.read.npy_bytes import array_from_bytes
from moseg_core.untrusted.terminal import printable

# What zipfile and the decompressors raise over damaged archives.
_DAMAGED = (
    *(KeyError, ValueError, TypeError, IndexError, EOFError, OSError, MemoryError),
    *(NotImplementedError, RuntimeError, OverflowError, BadZipFile, zlib.error, struct.error),
    lzma.LZMAError,
)
#: Bytes that any archive may unpack to; beside these so many for each of its own, and for each
#: element, vertex or cell of the shape.
_DIGITS = 18  # of a label
_UNPACKED, _PER_BYTE, _PER_BEARER = 2**26, 100, 64


def read_npy(path: Path, wanted: Wanted) -> Listing:
    """Read labels from an ``.npy`` file.

    Raises
    ------
    ShapeError
        The file cannot be read, or its array is no row of labels; says what it is.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.npy"
    ...     np.save(file, np.array([1.0, 0.0]))
    ...     read_npy(file, Wanted(n_elements=2)).labels.tolist()
    [1, 0]
    """
    return _listing(path, read_array(path), wanted)


def read_npz(path: Path, wanted: Wanted) -> Listing:
    """Read labels from an ``.npz`` file: the array with a usual name, or the only one that fits.

    Raises
    ------
    ShapeError
        The file cannot be read, or has no such array; says which it has.
    """
    arrays = _arrays(path, wanted)
    counts = (wanted.n_elements, wanted.n_vertices)
    named = [
        name
        for name, array in arrays.items()
        if array.ndim == 1 and array.dtype.kind == "U" and names_labels(name, len(array), counts)
    ]
    others = [name for name in arrays if name not in named] or list(arrays)
    name, notes = chosen(path, "array", others, wanted.properties)
    if name is None:
        rows = [name for name in others if _is_row(arrays[name], wanted)]
        if len(rows) != 1 and len(others) == 1:
            rows = others
        if len(rows) != 1:
            called = [printable(name, longest=60) for name in arrays]
            some = ", ".join(called[:12]) or "none"
            more = f" and {len(arrays) - 12} more" if len(arrays) > 12 else ""
            raise file_error(
                path,
                f"has no array 'labels' but {some}{more}; say which holds the labels:"
                f" --label-property {printable((rows or [*called, 'NAME'])[0], longest=60)}",
            )
        name = rows[0]
    found = _listing(path, arrays[name], wanted)
    names = found.names
    if names is None and named and named[0] != name:
        names = tuple(_texts(path, arrays[named[0]]))
    elif names is None and "names" in arrays:
        raise file_error(path, "has an array 'names' that is not a row of texts; save it anew")
    return Listing(labels=found.labels, names=names, of=wanted.told(name).bearer, notes=notes)


def _arrays(path: Path, wanted: Wanted) -> dict[str, npt.NDArray[np.generic]]:
    """The arrays of an archive by name."""
    data = read_file(path)
    cells = 0 if wanted.grid is None else wanted.grid.occupied.size
    bearers = max(wanted.n_elements, wanted.n_vertices or 0, cells)
    most = _UNPACKED + _PER_BYTE * len(data) + _PER_BEARER * bearers
    found = {}
    try:
        with ZipFile(io.BytesIO(data)) as archive:
            members = archive.infolist()
            if (size := sum(member.file_size for member in members)) > most:
                raise file_error(
                    path, f"unpacks to {size} bytes, more than {most}, which labels can take"
                )
            for member in members:
                found[member.filename.removesuffix(".npy")] = archive.read(member)
    except _DAMAGED as problem:
        if isinstance(problem, ShapeError):
            raise
        said = printable(str(problem), longest=100)
        raise file_error(path, f"is no whole .npz file ({said}); save it anew") from problem
    arrays = {}
    for name, unpacked in found.items():
        try:
            arrays[name] = array_from_bytes(unpacked)
        except ValueError as error:
            raise file_error(path, f"has an array '{name}' that {error}") from error
    return arrays


def _is_row(array: npt.NDArray[np.generic], wanted: Wanted) -> bool:
    row = array.dtype.kind in "biufU" and array.size == max(array.shape, default=0)
    return row and array.size in (wanted.n_elements, wanted.n_vertices)


def _listing(path: Path, array: npt.NDArray[np.generic], wanted: Wanted) -> Listing:
    if array.ndim == 2 and min(array.shape) == 1:
        array = array.reshape(-1)
    if wanted.grid is not None and array.shape == wanted.grid.occupied.shape:
        array = array[tuple(wanted.grid.cells.T)]
    if array.ndim == 3 and array.dtype.kind in "iuf":
        labels = whole_labels(path, array.reshape(-1), noun="cell")
        return Listing(labels=labels[labels >= 0] if (labels < 0).any() else labels)
    column: tuple[str, ...] = ()
    if array.ndim == 2 and array.size and array.dtype.kind in "biuf":
        array, column = _column(path, array, wanted)
    if array.ndim == 1 and array.dtype.kind == "U":
        words = _texts(path, array)
        if not words or not all(word.lstrip("+-").isdecimal() for word in words):
            names_of, names = numbered_names(words)
            return Listing(labels=names_of, names=names or None)
        if any(len(word) > _DIGITS for word in words):
            raise file_error(path, "has labels that are too large; labels count from 0")
        array = np.array(list(map(int, words)), np.int64)
    if array.ndim != 1 or array.dtype.kind not in "biuf":
        raise file_error(
            path, f"holds {array.dtype} of shape {array.shape} instead of a row of whole labels"
        )
    return Listing(labels=whole_labels(path, array, noun=wanted.noun), notes=column)


def _texts(path: Path, array: npt.NDArray[np.generic]) -> list[str]:
    """The texts in a row; numpy itself does not check what a damaged file makes of them."""
    native = np.ascontiguousarray(array.astype(array.dtype.newbyteorder("=")))
    if native.nbytes and native.view(np.uint32).max() > sys.maxunicode:
        raise file_error(path, "holds texts that are damaged; save it anew")
    return [str(text) for text in native.tolist()]


def _column(
    path: Path, array: npt.NDArray[np.generic], wanted: Wanted
) -> tuple[npt.NDArray[np.generic], tuple[str, ...]]:
    """The column of a matrix that is asked for, or the label behind points."""
    rows, width = array.shape
    for name in wanted.properties:
        if name.isdecimal() and 1 <= int(name) <= width:
            return array[:, int(name) - 1], ()
    last = array[:, -1].astype(np.float64)
    if width in (4, 7, 10) and (np.isnan(last) | (np.floor(last) == last)).all():
        return last, (f"{path.name}: labels are the last of {width} columns",)
    if rows in (wanted.n_elements, wanted.n_vertices):
        raise file_error(
            path,
            f"holds {array.dtype} of shape {array.shape} instead of a row of whole labels; if these"
            " are scores of labels, save their argmax(axis=1); if one column holds the labels, say"
            " which, from 1: --label-property 2",
        )
    return array, ()
