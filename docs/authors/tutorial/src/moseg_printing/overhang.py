"""Faces up: parts that can be printed as they stand, without support.

A printer that lays down one layer upon another needs something underneath. Walls may lean out by
about 45 degrees; what leans further sags, unless columns of support are printed below it and broken
off afterwards. So a shape is best cut into parts that have nothing that hangs over high up: an
underside is welcome where it lies on the printer's plate. Up is the z axis.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from moseg_core import Interval, Part, objective


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("scale", "order", "tessellation"),
    cost="moderate",
)
def overhang(part: Part, *, angle: Annotated[float, Interval(0, 90)] = 45.0) -> float:
    """How much support a part needs: 0 for none, 1 for columns as high as itself under all of it.

    A face with the outward unit normal ``n`` and the area ``A`` looks down on ``A max(0, -n_z)`` of
    the plate. It leans out by the angle whose sine is ``-n_z``, and needs a column of support from
    the plate, where the part is lowest, up to its own height ``h`` if that is more than `angle`::

        overhang = (sum over leaning faces of A max(0, -n_z) h) / (sum over all A max(0, -n_z) H)

    where ``H`` is the part's height. The face that closes a part where it was cut off is not there
    to be counted, and columns that end on the part itself are counted down to the plate.

    Parameters
    ----------
    part : Part
        Faces are oriented outwards.
    angle : float
        How far from the vertical walls may lean out, in degrees, 0 to 90.

    Returns
    -------
    float
        0 where it can be printed without support, which is best.

    Examples
    --------
    A roof upside down, 1 high: it leans out by 45 degrees, from the plate up to its height.

    >>> from moseg_core import Problem, Shape
    >>> ridge_down = [[0, -1, 1], [4, -1, 1], [4, 0, 0], [0, 0, 0], [4, 1, 1], [0, 1, 1]]
    >>> roof = Shape.from_mesh(ridge_down, [[0, 3, 2, 1], [3, 5, 4, 2]])
    >>> def cost(expression):
    ...     value = Problem(["roof"], expression).evaluate(roof, [0, 0]).cost.value
    ...     return round(value, 9)
    >>> cost("printing:overhang(roof, angle=50)"), cost("printing:overhang(roof, angle=40)")
    (0.0, 0.5)
    """
    corners = part.vertices[part.triangles]  # (t, 3, 3)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normals = np.cross(b - a, c - a) / 2  # outwards, as long as the area
    areas = np.linalg.norm(normals, axis=1)
    down = np.maximum(0.0, -normals[:, 2])
    heights = corners[:, :, 2].mean(axis=1) - corners[:, :, 2].min()
    height = np.ptp(corners[:, :, 2])
    leaning = down > math.sin(math.radians(angle)) * areas
    most = down.sum() * height
    return float((down * heights)[leaning].sum() / most) if most > 0 else 0.0
