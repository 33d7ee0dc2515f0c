"""Labels as arrays for numpy: ``.npz`` of any shape, ``.npy`` of a voxel grid.

An ``.npz`` file holds ``labels`` (F,), ``names`` (n,), and what it takes to use them without the
shape: ``points`` (F, 3) and ``areas`` (F,). An ``.npy`` file holds the grid itself, of the input's
size, with the label of every element and -1 where there is none; it takes nothing but
``numpy.load`` to cut a part out of a volume. Equal results give equal bytes.
"""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.shape import Shape
from moseg_core.shape.voxels import VoxelGrid


def encode_npz(shape: Shape, labels: npt.ArrayLike, names: Sequence[str]) -> bytes:
    """Labels, their names and the elements' places and areas, as a compressed archive.

    Parameters
    ----------
    shape : Shape
    labels : (F,) array_like of int
    names : sequence of str

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.

    Examples
    --------
    >>> shape = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> found = np.load(io.BytesIO(encode_npz(shape, [0, 1, 1], ["a", "b"])))
    >>> found["labels"].tolist(), found["names"].tolist()
    ([0, 1, 1], ['a', 'b'])
    """
    label = checked_labels(shape.geometry, labels, len(names)).astype(np.int64)
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        labels=label.astype(np.int32),
        names=np.array(names, np.str_),
        points=shape.points,
        areas=shape.areas,
    )
    return buffer.getvalue()


def encode_npy(shape: Shape, labels: npt.ArrayLike, names: Sequence[str]) -> bytes:
    """The labels of a voxel grid, at their places in the grid.

    Parameters
    ----------
    shape : Shape
        A voxel grid.
    labels : (F,) array_like of int
    names : sequence of str

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.
    UsageError
        The shape is no voxel grid.

    Examples
    --------
    >>> bar = Shape.from_voxels(np.array([[[True, False, True]]]))
    >>> np.load(io.BytesIO(encode_npy(bar, [0, 1], ["a", "b"]))).tolist()
    [[[0, -1, 1]]]
    """
    label = checked_labels(shape.geometry, labels, len(names)).astype(np.int64)
    check_grid(shape)
    assert isinstance(shape.geometry, VoxelGrid)  # just checked
    buffer = io.BytesIO()
    np.save(buffer, shape.geometry.spread(label.astype(np.int32), -1))
    return buffer.getvalue()


def check_grid(shape: Shape) -> None:
    """Refuse what ``.npy`` cannot hold.

    Raises
    ------
    UsageError
        The shape is no voxel grid.
    """
    if not isinstance(shape.geometry, VoxelGrid):
        raise UsageError(
            f"'{shape.name}' is a {shape.geometry.kind}; an .npy file holds the labels of a voxel"
            f" grid, of everything else .npz does"
        )
