"""What masks have in common, whatever file they come from.

A *mask* is a volume of numbers that says which cells belong to the shape: those that are not 0. A
*label map* has several such numbers; the shape is all of them together, since moseg is to find the
parts. Intensities, as scanners give them, are no mask, and most cells of a CT are not 0: what is
surely none is refused with what to do.

Coordinates are those of the patient in millimetres, *RAS*: x to the right, y to the front
(anterior), z up (superior). An *affine* ``[M | t]`` maps the index of a cell to the middle of the
cell, in both formats. The grid of a shape has one step per axis of the array, the columns of ``M``,
and begins half a step in each direction before that middle, at a corner. So a tilted scan stays
tilted, cells keep their order, and nothing is resampled.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core import Labelling, ReadLimits, Result, Shape, ShapeError, UsageError, VoxelGrid

FloatArray = npt.NDArray[np.float64]

_MANY = 256
"""Different numbers from which on they are no labels."""

_LARGEST = 2**53
"""Number from which on floats leave whole numbers out."""

_APART = 0.1
"""How far cells of a label map may be from those of a shape, in sides; affines are rounded."""

_FARTHEST = 1e50
"""Millimetres that an affine may have; in files that are not damaged a few thousand."""

_SLAB = 2**22
"""Cells that are looked at in one go, so that numbers of all of them are never made at once."""

_LIMITS = ReadLimits()


def stem_of(name: str, suffixes: tuple[str, ...]) -> str:
    """The name of a file without its suffix, of which the longest counts.

    Examples
    --------
    >>> stem_of("femur.nii.gz", (".nii", ".nii.gz"))
    'femur'
    """
    found = [suffix for suffix in suffixes if name.lower().endswith(suffix)]
    return name[: -len(max(found, key=len))] if found else name


def shape_of_mask(
    path: Path,
    values: Any,
    affine: FloatArray,
    *,
    name: str,
    header: Mapping[str, Any],
    limits: ReadLimits = _LIMITS,
) -> Shape:
    """The cells of a volume that are not 0, as a solid shape.

    Parameters
    ----------
    path : Path
        For messages.
    values : (nx, ny, nz) array of numbers
        Or what is indexed like one, and reads them from a file then.
    affine : (4, 4) float
        From the index of a cell to its middle, in millimetres, RAS.
    name : str
        What to call the shape.
    header : mapping of str to any
        What the file says beside that, for a writer.
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        The volume is no mask, is empty, or has more cells than the limits allow; the affine spans
        no space.
    """
    _refuse_place(path, affine)
    size = _size(path, values)
    occupied, found, count = np.zeros(size, np.bool_), np.empty(0), 0
    for where, numbers in _slabs(path, values, size):
        here = numbers != 0
        occupied[where] = here
        count += int(np.count_nonzero(here))
        # A mask is packed by what packs anything, so cells count against what is unpacked.
        limits.refuse_cells(path, occupied=count, grid=occupied.size, size=occupied.size)
        found = _united(path, found, numbers[here])
    labels = found.tolist()
    notes = []
    if len(labels) > 1:
        some = ", ".join(f"{label:g}" for label in labels[:8])
        more = ", ..." if len(labels) > 8 else ""
        notes.append(f"{len(labels)} labels ({some}{more}): all of them together are the shape")
    steps = affine[:3, :3].T
    try:
        return Shape.from_voxels(
            occupied,
            pitch=steps.tolist(),
            origin=(affine[:3, 3] - steps.sum(axis=0) / 2.0).tolist(),
            name=name,
            notes=notes,
            header=header,
        )
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error


def labels_on(
    path: Path,
    shape: Shape,
    values: Any,
    affine: FloatArray,
    called: Mapping[int, str],
) -> Labelling:
    """What a label map says of the cells of a shape.

    Parameters
    ----------
    path : Path
        For messages.
    shape : Shape
        A voxel grid of the same size, at the same place.
    values : (nx, ny, nz) array of numbers
    affine : (4, 4) float
        From the index of a cell to its middle, in millimetres, RAS.
    called : mapping of int to str
        Names of the numbers, where they are known.

    Returns
    -------
    Labelling
        Of 0 no label. Without any name labels are the numbers themselves.

    Raises
    ------
    ShapeError
        It is no label map, or one of another grid.
    """
    _refuse_place(path, affine)
    size = _size(path, values)
    grid = shape.geometry
    if not isinstance(grid, VoxelGrid) or grid.occupied.shape != size:
        told = " x ".join(map(str, size))
        raise ShapeError(f"{path.name} labels a grid of {told} cells, which '{shape.name}' is not")
    ends = np.array([[*corner, 1.0] for corner in np.ndindex(2, 2, 2)]) * [*size, 1]
    apart = np.abs(ends @ (affine - affine_of(grid)).T).max()
    if not apart < _APART * grid.pitch.min():
        raise ShapeError(
            f"{path.name} labels another place than '{shape.name}': its cells are up to"
            f" {apart:.3g} mm away"
        )
    numbers, found = np.zeros(grid.n_elements, np.int64), np.empty(0)
    for where, slab in _slabs(path, values, size):
        found = _united(path, found, slab[slab != 0])
        # Elements of some layers follow each other as those of all do, in C order.
        within = np.logical_and.reduce(
            [
                (along >= (part.start or 0)) & (along < (part.stop or count))
                for along, part, count in zip(grid.cells.T, where, size, strict=True)
                if part != slice(None)
            ]
        )
        numbers[within] = slab[grid.is_element[where]]
    if not called:
        return Labelling(labels=np.where(numbers > 0, numbers, -1), names=None)
    used = [number for number in found.astype(np.int64).tolist() if number > 0]
    labels = np.where(numbers > 0, np.searchsorted(used, numbers), -1)
    names = tuple(called.get(number, f"label {number}") for number in used)
    return Labelling(labels=labels, names=names)


def _refuse_place(path: Path, affine: FloatArray) -> None:
    """Refuse an affine of numbers that cannot be computed with."""
    if not np.isfinite(affine).all() or np.abs(affine).max() > _FARTHEST:
        raise ShapeError(
            f"{path.name} places its cells beyond what can be measured, by numbers up to"
            f" {np.abs(affine).max():.3g}; repair its affine"
        )


def _size(path: Path, values: Any) -> tuple[int, int, int]:
    """The sizes of a volume of three axes; those of one cell at the end, as for time, left out."""
    size = tuple(int(count) for count in values.shape)
    while len(size) > 3 and size[-1] == 1:
        size = size[:-1]
    if len(size) != 3:
        raise ShapeError(
            f"{path.name} has a volume of {len(size)} axes, {' x '.join(map(str, size))};"
            f" moseg reads one mask of three: save a single volume, or export the segments as one"
            f" label map"
        )
    if values.dtype.kind not in "biuf":
        raise ShapeError(
            f"{path.name} holds {values.dtype}, not numbers; save the mask as integers"
        )
    return size


def _slabs(
    path: Path, values: Any, size: tuple[int, int, int]
) -> Iterator[tuple[tuple[slice, ...], npt.NDArray[Any]]]:
    """The numbers of a volume, some layers at a time, and where they are; none but of a mask."""
    axis = 2 if size[0] * size[1] <= _SLAB else int(np.argmax(size))
    layer = size[0] * size[1] * size[2] // size[axis]
    thick = max(1, _SLAB // layer)
    for begin in range(0, size[axis], thick):
        where = tuple(slice(begin, begin + thick) if a == axis else slice(None) for a in range(3))
        numbers = np.asanyarray(values[where])
        numbers = numbers.reshape(numbers.shape[:3])
        if numbers.dtype.kind == "f" and not (np.rint(numbers) == numbers).all():  # nor NaN
            raise _no_mask(path, "numbers that are not whole")
        if numbers.min() < 0:
            raise _no_mask(path, "negative numbers")
        if numbers.max() >= _LARGEST:
            raise _no_mask(path, f"numbers up to {numbers.max():.3g}")
        yield where, numbers


def _united(path: Path, found: npt.NDArray[Any], numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The different numbers that there are, ascending; too many are no labels."""
    labels = np.union1d(found, numbers)
    if len(labels) > _MANY:
        raise _no_mask(path, f"{len(labels)} different numbers")
    return labels


def _no_mask(path: Path, what: str) -> ShapeError:
    return ShapeError(
        f"{path.name} holds {what}, as images do; moseg reads masks, 0 outside of the shape and a"
        f" whole number within: segment the image first, for instance by a threshold in ITK-SNAP or"
        f" 3D Slicer, and save the mask"
    )


def label_map(result: Result, format: str) -> tuple[VoxelGrid, npt.NDArray[Any]]:
    """The grid of a result, and the number of each cell: of part ``i`` ``i + 1``, else 0.

    Where only cells of the surface are elements, those within have the number of the nearest of
    these: a label map is to divide the whole mask.

    Parameters
    ----------
    result : Result
    format : str
        What the format is called, for messages.

    Returns
    -------
    grid : VoxelGrid
    numbers : (nx, ny, nz) uint8, or uint16 of more than 255 parts

    Raises
    ------
    UsageError
        The shape is no voxel grid.
    """
    grid = result.shape.geometry
    if not isinstance(grid, VoxelGrid):
        raise UsageError(
            f"'{result.shape.name}' is a {grid.kind}; {format} holds the label map of a voxel grid:"
            f" write .ply, .glb or .npz instead"
        )
    count = len(result.problem.labels)
    if count >= 2**16:
        raise UsageError(f"{count} parts are more than a label map has numbers for; write .npz")
    kind = np.uint8 if count < 2**8 else np.uint16
    return grid, _filled(grid, grid.spread(np.asarray(result.labels + 1, kind), 0))


def _filled(grid: VoxelGrid, numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Numbers for all occupied cells: of those that have none the nearest one, by their sides."""
    missing = grid.occupied & (numbers == 0)
    if not missing.any():
        return numbers
    from scipy import ndimage

    filled = numbers.copy()
    box = ndimage.find_objects(grid.occupied.astype(np.uint8))[0]
    near = ndimage.distance_transform_edt(
        numbers[box] == 0, sampling=grid.pitch, return_distances=False, return_indices=True
    )
    filled[box][missing[box]] = numbers[box][tuple(near)][missing[box]]
    return filled


def affine_of(grid: VoxelGrid) -> FloatArray:
    """(4, 4) float: from the index of a cell of a grid to its middle.

    Examples
    --------
    >>> cube = Shape.from_voxels(np.ones((1, 1, 1), bool), pitch=2.0, origin=(9, 9, 9))
    >>> affine_of(cube.geometry).tolist()[0]
    [2.0, 0.0, 0.0, 10.0]
    """
    affine = np.eye(4)
    affine[:3, :3] = grid.steps.T
    affine[:3, 3] = grid.origin + grid.steps.sum(axis=0) / 2.0
    return affine


@contextmanager
def quietly() -> Iterator[None]:
    """Within this context libraries do not warn of damaged files, which are refused anyway."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
