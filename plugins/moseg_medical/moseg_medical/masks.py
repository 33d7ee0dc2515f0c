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

from moseg_core import Labelling, Result, Shape, ShapeError, UsageError, VoxelGrid

FloatArray = npt.NDArray[np.float64]

_MANY = 256
"""Different numbers from which on they are no labels."""

_APART = 0.1
"""How far cells of a label map may be from those of a shape, in sides; affines are rounded."""


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
    values: npt.NDArray[Any],
    affine: FloatArray,
    *,
    name: str,
    header: Mapping[str, Any],
) -> Shape:
    """The cells of a volume that are not 0, as a solid shape.

    Parameters
    ----------
    path : Path
        For messages.
    values : (nx, ny, nz) array of numbers
    affine : (4, 4) float
        From the index of a cell to its middle, in millimetres, RAS.
    name : str
        What to call the shape.
    header : mapping of str to any
        What the file says beside that, for a writer.

    Raises
    ------
    ShapeError
        The volume is no mask, or is empty; the affine spans no space.
    """
    occupied, labels = _checked(path, _in_three(path, values))
    notes = []
    if len(labels) > 1:
        some = ", ".join(f"{label:g}" for label in labels[:8].tolist())
        more = ", ..." if len(labels) > 8 else ""
        notes.append(f"{len(labels)} labels ({some}{more}): all of them together are the shape")
    steps = affine[:3, :3].T
    try:
        return Shape.from_voxels(
            np.ascontiguousarray(occupied),
            pitch=steps,
            origin=affine[:3, 3] - steps.sum(axis=0) / 2.0,
            name=name,
            notes=notes,
            header=header,
        )
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error


def labels_on(
    path: Path,
    shape: Shape,
    values: npt.NDArray[Any],
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
    values = _in_three(path, values)
    _, found = _checked(path, values)
    grid = shape.geometry
    if not isinstance(grid, VoxelGrid) or grid.occupied.shape != values.shape:
        size = " x ".join(map(str, values.shape))
        raise ShapeError(f"{path.name} labels a grid of {size} cells, which '{shape.name}' is not")
    ends = np.array([[*corner, 1.0] for corner in np.ndindex(2, 2, 2)]) * [*values.shape, 1]
    apart = np.abs(ends @ (affine - affine_of(grid)).T).max()
    if not apart < _APART * grid.pitch.min():
        raise ShapeError(
            f"{path.name} labels another place than '{shape.name}': its cells are up to"
            f" {apart:.3g} mm away"
        )
    numbers = values[tuple(grid.cells.T)].astype(np.int64)
    if not called:
        return Labelling(labels=np.where(numbers > 0, numbers, -1), names=None)
    used = [number for number in found.astype(np.int64).tolist() if number > 0]
    labels = np.where(numbers > 0, np.searchsorted(used, numbers), -1)
    names = tuple(called.get(number, f"label {number}") for number in used)
    return Labelling(labels=labels, names=names)


def _in_three(path: Path, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """A volume of three axes; those of one cell at the end, as for time, are left out."""
    while values.ndim > 3 and values.shape[-1] == 1:
        values = values[..., 0]
    if values.ndim != 3:
        raise ShapeError(
            f"{path.name} has a volume of {values.ndim} axes, {' x '.join(map(str, values.shape))};"
            f" moseg reads one mask of three: save a single volume, or export the segments as one"
            f" label map"
        )
    return values


def _checked(path: Path, values: npt.NDArray[Any]) -> tuple[npt.NDArray[np.bool_], Any]:
    """Which cells are not 0, and the numbers that there are; an error for what is no mask."""
    if values.dtype.kind not in "biuf":
        raise ShapeError(
            f"{path.name} holds {values.dtype}, not numbers; save the mask as integers"
        )
    if values.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            whole = np.nan_to_num(values, nan=0.5) == np.rint(np.nan_to_num(values, nan=0.5))
        if not whole.all():
            raise _no_mask(path, "numbers that are not whole")
    if values.size and values.min() < 0:
        raise _no_mask(path, "negative numbers")
    occupied = values != 0
    labels = np.unique(values[occupied])
    if len(labels) > _MANY:
        raise _no_mask(path, f"{len(labels)} different numbers")
    return occupied, labels


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
