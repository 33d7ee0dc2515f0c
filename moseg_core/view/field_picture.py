"""The picture of a field: each element in the colour of its value, over a ramp that says which.

As the picture of a segmentation (:mod:`moseg_core.view.picture`), without lines between parts. The
ramp (:mod:`moseg_core.view.ramp`) goes from the least value to the greatest; light and shade are
laid over it, so that a value is read off a place that faces the light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.up import Up
from moseg_core.view.legend import draw_ramp
from moseg_core.view.picture import draw_sides
from moseg_core.view.point_bodies import drawable
from moseg_core.view.ramp import ramp, shades
from moseg_core.view.upright import find_standing

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw


def render_field(
    mesh: Geometry,
    values: npt.ArrayLike,
    *,
    title: str = "",
    mean: float | None = None,
    size: tuple[int, int] = (1400, 700),
    up: Up | None = None,
) -> bytes:
    """Draw a shape from two sides, coloured by a number of each element.

    Parameters
    ----------
    mesh : Geometry
        Points are drawn as small bodies (:mod:`moseg_core.view.point_bodies`).
    values : (F,) array_like of float
        Finite.
    title : str
    mean : float, optional
        Marked in the legend, between the least and the greatest value.
    size : (int, int), pixels
    up : {"x", "-x", "y", "-y", "z", "-z"}, optional
        The axis that points up; guessed where it is not given, which the picture says.

    Returns
    -------
    bytes
        A PNG file.

    Raises
    ------
    ShapeError
        Not one finite number per element.
    UsageError
        A size below 240 x 160 or above 4000 x 2000 pixels.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                                 [[0, 1, 2, 3]])
    >>> render_field(square, [0.5])[1:4]
    b'PNG'
    """
    array = np.asarray(values, np.float64)
    if array.shape != (mesh.n_elements,) or not np.isfinite(array).all():
        raise ShapeError(
            f"a field has a finite number for each of {mesh.n_elements} elements; given is an"
            f" array of the shape {array.shape}"
        )
    low, high = float(array.min()), float(array.max())
    share = 0.5 if mean is None or not high > low else (mean - low) / (high - low)
    middle = None if mean is None else (share, f"mean {mean:.4g}")
    ends = f"least {low:.4g}", f"greatest {high:.4g}"

    def legend(draw: ImageDraw, /, *, size: tuple[int, int], pad: int) -> int:
        return draw_ramp(draw, ramp(), *ends, middle=middle, size=size, pad=pad)

    same = np.zeros(mesh.n_elements, np.int64)
    drawn = drawable(mesh)
    return draw_sides(
        drawn,
        same,
        shades(array),
        ramp(),
        legend=legend,
        title=title,
        size=size,
        standing=find_standing(drawn, up),
    )
