"""Height: how high up an element is, where a direction is known to be up."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from moseg_core import Shape, UsageError

FloatArray = npt.NDArray[np.float64]

#: Where "up" can be, by name: the axis and its sign.
DIRECTIONS = {
    f"{sign}{'xyz'[k]}": (k, value) for k in range(3) for sign, value in (("", 1), ("-", -1))
}


def direction(up: str) -> tuple[int, int]:
    """The number of an axis and its sign.

    Parameters
    ----------
    up : str
        ``x``, ``y``, ``z``, ``-x``, ``-y`` or ``-z``, in the file's axes.

    Raises
    ------
    UsageError
        It is none of these.

    Examples
    --------
    >>> direction("y"), direction("-z")
    ((1, 1), (2, -1))
    """
    if up not in DIRECTIONS:
        raise UsageError(f"up is one of {', '.join(DIRECTIONS)}, not {up!r}")
    return DIRECTIONS[up]


def height(shape: Shape, *, up: str = "z") -> FloatArray:
    """How high each element is, from 0, the lowest vertex, to 1, the highest.

    Parameters
    ----------
    shape : Shape
    up : str
        Which way is up, in the file's axes: x, y, z, -x, -y or -z.

    Returns
    -------
    (F,) float
        Of the element's middle, 0 to 1; 0.5 on a shape that has no height.

    Raises
    ------
    UsageError
        `up` is no axis.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> square = moseg.Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 0, 3], [0, 0, 3]], [[0, 1, 2, 3]])
    >>> moseg.field_values(square, "basic:height").tolist()
    [0.5]
    """
    axis, sign = direction(up)
    geometry = shape.geometry
    used = sign * geometry.vertices[np.unique(geometry.corners), axis]
    low, high = used.min(), used.max()
    if not high > low:
        return np.full(shape.n_elements, 0.5)
    values: FloatArray = np.clip((sign * shape.points[:, axis] - low) / (high - low), 0.0, 1.0)
    return values
