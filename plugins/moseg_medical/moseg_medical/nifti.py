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
from collections.abc import Iterator
from contextlib import contextmanager
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
from moseg_medical.unpacking import opened, unpacked

SUFFIXES = (".nii", ".nii.gz")
_NAMES = "_labels.txt"
_HEADER = "nifti"
_ZIPPED = b"\x1f\x8b"
_FIRST, _SECOND = 348, 540
"""Bytes of a header of NIfTI-1 and of NIfTI-2."""
_LIMITS = ReadLimits()


def read_nifti(path: Path, *, limits: ReadLimits = _LIMITS) -> Shape:
    """Read a mask or label map as a solid voxel grid.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Returns
    -------
    Shape
        An element for each cell that is not 0, in the order of the array (C order), in
        millimetres, x to the right, y to the front, z up.

    Raises
    ------
    ShapeError
        The file is no such file, is cut off, holds an image and no mask, is empty, or becomes more
        than the limits allow.
    """
    values, affine, header = _volume(path, limits)
    name = stem_of(path.name, SUFFIXES)
    shape = shape_of_mask(path, values, affine, name=name, header={_HEADER: header}, limits=limits)
    return shape.with_up("z")


def nifti_labels(path: Path, shape: Shape, *, limits: ReadLimits = _LIMITS) -> Labelling:
    """What a label map says of the cells of a shape; with names from the text beside it.

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
    values, affine, _ = _volume(path, limits)
    beside = path.with_name(f"{stem_of(path.name, SUFFIXES)}{_NAMES}")
    text = beside.read_text(encoding="utf-8", errors="replace") if beside.is_file() else ""
    return labels_on(path, shape, values, affine, described(text))


def _volume(path: Path, limits: ReadLimits) -> tuple[Any, FloatArray, bytes]:
    """The values, which are read where they are indexed, the affine and the header."""
    data = path.read_bytes()
    packed = data.startswith(_ZIPPED)
    with _damage_told(path):
        kind, sizes, needed = _announced(_beginning(path, data) if packed else data[:_SECOND])
    told = " x ".join(map(str, sizes))
    if not sizes or min(sizes) < 1:
        raise ShapeError(f"{path.name} announces a volume of {told or 'no axes'}; it is damaged")
    stream = io.BytesIO(data)
    if packed:
        limits.refuse_cells(path, occupied=0, grid=math.prod(sizes), size=len(data))
        stream = unpacked(path, data, "gzip", announced=needed, limits=limits)
    there = stream.seek(0, io.SEEK_END)
    stream.seek(0)
    if needed > there:
        raise ShapeError(
            f"{path.name} announces a volume of {told} and has {there} bytes instead of {needed};"
            " it is cut off or damaged"
        )
    limits.refuse_cells(path, occupied=0, grid=math.prod(sizes), size=len(data))
    with _damage_told(path):
        image = kind.from_stream(stream)
        if image.affine is None or not np.isfinite(image.affine).all():
            raise ValueError("its affine has numbers that are none")
    return image.dataobj, image.affine, image.header.binaryblock


def _beginning(path: Path, data: bytes) -> bytes:
    """The header of a packed file."""
    with opened(data, "gzip") as stream:
        try:
            head: bytes = stream.read(_SECOND)
        except (OSError, EOFError, zlib.error) as error:
            raise ShapeError(f"{path.name} cannot be unzipped ({error}); copy it anew") from error
    return head


def _announced(head: bytes) -> tuple[Any, list[int], int]:
    """What a header announces: the kind of image, the sizes of axes, and bytes of the file."""
    import nibabel

    size = head[:4]
    second = size in (struct.pack("<i", _SECOND), struct.pack(">i", _SECOND))
    kind: Any = nibabel.Nifti2Image if second else nibabel.Nifti1Image
    block = head[: _SECOND if second else _FIRST]
    header = kind.header_class(block, check=False)
    sizes = [int(size) for size in header.get_data_shape()]
    begin = int(header["vox_offset"])
    if begin < 0:
        raise ValueError(f"its values begin at byte {begin}")
    return kind, sizes, begin + math.prod(sizes) * header.get_data_dtype().itemsize


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    """What nibabel raises over damaged headers becomes a line; what it repairs is no news."""
    from nibabel.filebasedimages import ImageFileError
    from nibabel.spatialimages import HeaderDataError
    from nibabel.wrapstruct import WrapStructError

    log = logging.getLogger("nibabel.global")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        with quietly():
            yield
    except ShapeError:
        raise
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
