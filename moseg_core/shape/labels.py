"""Labels of a shape's elements as numbers, checked before they are written or drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.geometry import Geometry
from moseg_core.types import IntArray


def checked_labels(geometry: Geometry, labels: npt.ArrayLike, names: Sequence[str]) -> IntArray:
    """Labels as a (F,) int array, one for each element and each with a name.

    Parameters
    ----------
    geometry : Geometry
    labels : (F,) array_like of int
        0 to ``len(names) - 1``.
    names : sequence of str

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> checked_labels(mesh, [1], ["head", "handle"]).tolist()
    [1]
    """
    array = np.asarray(labels)
    noun, count = geometry.noun, geometry.n_elements
    if array.shape != (count,) or not np.issubdtype(array.dtype, np.integer):
        raise ShapeError(
            f"a picture or mesh file needs one integer label for each of the {count}"
            f" {noun}s, not an array of {array.dtype} of shape {array.shape}"
        )
    wrong = (array < 0) | (array >= len(names))
    if wrong.any():
        element = int(np.argmax(wrong))
        raise ShapeError(
            f"{noun} {element} has the label {array[element]}, which has no name;"
            f" allowed are 0 to {len(names) - 1}"
        )
    return array.astype(np.int64)
