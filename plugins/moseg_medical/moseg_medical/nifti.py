"""NIfTI-1 and -2: masks in ``.nii`` and ``.nii.gz``, and label maps back (nifti.nimh.nih.gov).

A header may hold two affines, ``sform`` and ``qform``, each with a code for what it refers to.
nibabel says which counts. A label map is written with the header that was read, both affines and
codes included, but for what is about the values: their type, scaling, range and intent. Extensions,
which may hold what a scanner knew of a patient, are not taken over.

Names of labels have no place in the format that programs agree on; they stand in a text beside the
image, ``femur_labels.txt``, in the form that ITK-SNAP imports.
"""

from __future__ import annotations

import gzip
import io
import logging
import math
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from moseg_core import Labelling, ReadLimits, Result, Shape, ShapeError
from moseg_medical.label_names import described, label_descriptions
from moseg_medical.masks import (
    FloatArray,
    affine_of,
    label_map,
    labels_on,
    quietly,
    shape_of_mask,
    stem_of,
)

SUFFIXES = (".nii", ".nii.gz")
_NAMES = "_labels.txt"
_HEADER = "nifti"
_ZIPPED = b"\x1f\x8b"
_SECOND = 540
"""Bytes of a header of NIfTI-2."""
_LONGEST_HEADER = 1 << 24
"""Bytes in front of the values, extensions included, beyond which a file is damaged."""


def read_nifti(path: Path, *, limits: ReadLimits | None = None) -> Shape:
    """Read a mask or label map as a solid voxel grid.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional
        How large a grid may be.

    Returns
    -------
    Shape
        An element for each cell that is not 0, in the order of the array (C order), in
        millimetres, x to the right, y to the front, z up.

    Raises
    ------
    ShapeError
        The file is no such file, is cut off, holds an image and no mask, or is empty.
    """
    limits = limits or ReadLimits()
    values, affine, header = _volume(path, limits)
    limits.refuse_cells(
        path, occupied=int(np.count_nonzero(values)), grid=values.size, size=path.stat().st_size
    )
    name = stem_of(path.name, SUFFIXES)
    shape = shape_of_mask(path, values, affine, name=name, header={_HEADER: header})
    return shape.with_up("z")


def nifti_labels(path: Path, shape: Shape) -> Labelling:
    """What a label map says of the cells of a shape; with names from the text beside it.

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
    values, affine, _ = _volume(path, ReadLimits())
    beside = path.with_name(f"{stem_of(path.name, SUFFIXES)}{_NAMES}")
    text = beside.read_text(encoding="utf-8", errors="replace") if beside.is_file() else ""
    return labels_on(path, shape, values, affine, described(text))


def _volume(path: Path, limits: ReadLimits) -> tuple[Any, FloatArray, bytes]:
    """The values, the affine and the header."""
    data = path.read_bytes()
    if data.startswith(_ZIPPED):
        data = _unzipped(path, data, limits)
    image = _image(path, data)
    header, needed = image.header, _checked_size(path, image, len(data), limits)
    if needed > len(data):
        size = " x ".join(map(str, header.get_data_shape()))
        raise ShapeError(
            f"{path.name} announces a volume of {size} and has {len(data)} bytes instead of"
            f" {needed}; it is cut off or damaged"
        )
    with quietly():
        values = np.asanyarray(image.dataobj)
    return values, image.affine, header.binaryblock


def _checked_size(path: Path, image: Any, size: int, limits: ReadLimits) -> int:
    """How many bytes the whole file takes, header and values, as the header says."""
    shape, item = image.header.get_data_shape(), image.header.get_data_dtype().itemsize
    offset, cells = image.dataobj.offset, math.prod(map(int, shape))
    if not shape or min(shape) < 1 or not 0 <= offset < _LONGEST_HEADER:
        raise ShapeError(
            f"{path.name} announces a volume of {' x '.join(map(str, shape))} behind {offset:g}"
            " bytes of header; it is damaged"
        )
    limits.refuse_cells(path, occupied=0, grid=cells, size=size)
    return int(offset) + cells * int(item)


def _unzipped(path: Path, data: bytes, limits: ReadLimits) -> bytes:
    """The bytes within, as many as the header asks for: a zipped file may hold any number."""
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as zipped:
            head = zipped.read(_SECOND)
            needed = _checked_size(path, _image(path, head), len(data), limits)
            whole = head + zipped.read(max(0, needed - len(head)))
            zipped.read(1)  # the sum behind the end is checked
            return whole
    except (OSError, EOFError, zlib.error) as error:
        raise ShapeError(f"{path.name} cannot be unzipped ({error}); copy it anew") from error


def _image(path: Path, data: bytes) -> Any:
    """The image with its header read and its values not yet."""
    import nibabel
    from nibabel.filebasedimages import ImageFileError
    from nibabel.spatialimages import HeaderDataError
    from nibabel.wrapstruct import WrapStructError

    size = data[:4]
    second = size in (struct.pack("<i", _SECOND), struct.pack(">i", _SECOND))
    kind = nibabel.Nifti2Image if second else nibabel.Nifti1Image
    log = logging.getLogger("nibabel.global")
    level = log.level
    log.setLevel(logging.CRITICAL)  # what nibabel repairs is no news, what it cannot is raised
    try:
        with quietly():
            image = kind.from_bytes(data)
            if image.affine is None or not np.isfinite(image.affine).all():
                raise ValueError("its affine has numbers that are none")
            return image
    except (
        ImageFileError,
        HeaderDataError,
        WrapStructError,
        ValueError,
        TypeError,
        KeyError,
        OverflowError,
        EOFError,
        OSError,
    ) as error:
        line = " ".join(str(error).split())[:120]
        raise ShapeError(f"{path.name} is not a NIfTI file ({line}); save it anew") from error
    finally:
        log.setLevel(level)


def write_nifti(result: Result, *, name: str) -> dict[str, bytes]:
    """A label map of the grid that was read: 0 outside, ``i + 1`` in part ``i``; and its names.

    Parameters
    ----------
    result : Result
        Of a voxel grid.
    name : str
        ``parts.nii`` or ``parts.nii.gz``; the names go to ``parts_labels.txt``.

    Raises
    ------
    UsageError
        The shape is no voxel grid.
    """
    import nibabel

    grid, numbers = label_map(result, "NIfTI")
    block = grid.header.get(_HEADER)
    if block is None:
        image: Any = nibabel.Nifti1Image(numbers, affine_of(grid))
        image.header.set_xyzt_units("mm")
    else:
        kind: Any = nibabel.Nifti2Image if len(block) == _SECOND else nibabel.Nifti1Image
        known = kind.header_class(block, check=False)
        known.set_data_shape(numbers.shape)
        image = kind(numbers, None, known)
    header = image.header
    header.set_data_dtype(numbers.dtype)
    header.set_slope_inter(1, 0)
    header.set_intent("label")
    header["cal_min"], header["cal_max"] = 0, len(result.problem.labels)
    data = image.to_bytes()
    if name.lower().endswith(".gz"):
        stream = io.BytesIO()
        with gzip.GzipFile(filename="", fileobj=stream, mode="wb", mtime=0) as zipped:
            zipped.write(data)
        data = stream.getvalue()
    names = label_descriptions(result.problem.labels).encode()
    return {f"{stem_of(name, SUFFIXES)}{_NAMES}": names, name: data}
