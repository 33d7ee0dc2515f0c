"""The thirteen measures that tell parts apart: what ``is`` compares, for others to read.

``part.measure("basic:likeness")`` has all that the objective ``is``
(:mod:`moseg_objectives_basic.likeness`) compares with targets. Of many parts of one name, the mean
and spread of each measure are a profile, and so the parameters of an ``is`` for the next part.

Each measure is computed by :func:`moseg_objectives_basic.likeness.measured`, as for ``is``, so that
a measure and its target cannot come apart.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from moseg_core import Part, ShapeError
from moseg_objectives_basic.likeness import BY_RATIO, measured

_NEEDED = (
    ("area", "length", "width", "depth", "spread", "offcenter"),
    ("thickness", "unevenness"),
    ("remoteness", "nearest", "farthest"),
    ("boundary",),
    ("crease",),
)
"""Names of the measures, together where they need the same of a shape."""


class Likeness(NamedTuple):
    """What is measured of a part; NaN for what the shape does not tell.

    Of the measures that are in :attr:`by_ratio` half as much is as far away as twice as much. On
    solids, areas are volumes, lengths of boundaries areas, and roots are taken accordingly.

    Parameters
    ----------
    area : float
        Share of the shape's area.
    length, width, depth : float
        Extent along the part's principal axes, in diagonals of the shape: ``sqrt(12)`` times the
        scales, exact for the length of a rod, the sides of a plate and the diameter of a ball.
    spread : float
        Radius of gyration over the root of the area: 0.28 for a ball, 0.41 for a square.
    offcenter : float
        Distance of the part's centroid from that of the shape, in diagonals.
    thickness : float
        Mean thickness, in diagonals.
    unevenness : float
        Standard deviation of the thickness over its mean; 0 where it is even.
    remoteness, nearest, farthest : float
        Mean, least and greatest remoteness: 1 in the middle of the shape, 2 at the end of a rod.
    boundary : float
        Length of the boundary over the root of the area; 3.5 for a disc.
    crease : float
        Mean concavity along the boundary, from -2 to 2; 0 without a boundary.
    """

    area: float
    length: float
    width: float
    depth: float
    spread: float
    offcenter: float
    thickness: float
    unevenness: float
    remoteness: float
    nearest: float
    farthest: float
    boundary: float
    crease: float

    @property
    def by_ratio(self) -> tuple[str, ...]:
        """Names of the measures of which ratios count: :meth:`moseg_core.Target.ratio_cost`."""
        return tuple(name for name in self._fields if name in BY_RATIO)


def likeness(part: Part) -> Likeness:
    """All that ``is`` compares, of a part.

    Parameters
    ----------
    part : Part

    Examples
    --------
    >>> from moseg_core import Segmentation, Shape
    >>> strip = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 0, 0], [5, 1, 0]],
    ...                         [[0, 1, 2, 3], [1, 4, 5, 2]])
    >>> short = likeness(Segmentation.from_labels(strip, [0, 1], 2).parts[0])
    >>> round(short.area, 9), round(short.boundary, 9), round(short.spread, 9)
    (0.2, 1.0, 0.40824829)
    """
    found: dict[str, float] = {}
    for names in _NEEDED:
        try:
            found |= measured(part, names)
        except ShapeError:
            continue  # stays at NaN
    return Likeness(*(found.get(name, math.nan) for name in Likeness._fields))
