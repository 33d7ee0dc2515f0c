"""Labels of elements as numbers, checked before anything is made of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.data import ShapeData
from moseg_core.shape.geometry import Geometry
from moseg_core.types import UNLABELLED


def checked_labels(
    shape: Geometry | ShapeData,
    labels: npt.ArrayLike,
    n_labels: int,
    *,
    unlabelled: bool = False,
) -> npt.NDArray[np.integer[Any]]:
    """Labels as an array, one for each element, and none out of range.

    Parameters
    ----------
    shape : Geometry or Shape
        Of F elements.
    labels : (F,) array_like of int
    n_labels : int
        Labels are 0 to ``n_labels - 1``.
    unlabelled : bool
        Whether an element may have no label, -1.

    Returns
    -------
    (F,) integer array
        Of the type given; the same array if it was one.

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label out of range.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> checked_labels(mesh, [1], 2).tolist()
    [1]
    """
    try:
        array = np.asarray(labels)
    except ValueError as error:
        raise ShapeError(f"labels must be one number per {shape.noun}: {error}") from error
    if array.shape != (shape.n_elements,):
        raise ShapeError(
            f"a labelling needs one label for each of the {shape.n_elements} {shape.noun}s, not"
            f" an array of shape {array.shape}"
        )
    if not np.issubdtype(array.dtype, np.integer):
        raise ShapeError(f"labels must be integers, not {array.dtype}")
    least = UNLABELLED if unlabelled else 0
    if array.min() < least or array.max() >= n_labels:
        wrong = int(np.argmax((array < least) | (array >= n_labels)))
        raise ShapeError(
            f"{shape.noun} {wrong} has the label {array[wrong]}; allowed are 0 to {n_labels - 1}"
            + (", and -1 where there is none" if unlabelled else "")
        )
    return array
