"""Thickness: how far it is from a face to the other side of the shape, across its inside.

The shape diameter of Shapira, Shamir and Cohen-Or 2008 (doi:10.1007/s00371-007-0197-5): rays go
from a face into the shape, in a cone around the inward normal, and the median of their lengths
counts. A leg is thinner than a body however the animal stands.

The directions are fixed: five rings evenly spaced in angle, up to 37.5 degrees from the normal, of
four directions each, turned with the longest side of the triangle that they start from. So the
values of a shape are the same in every run, and do not change when it is moved or reflected. The
median is

- of a large plate ``1 / cos(22.5 deg)`` = 1.08 times its thickness,
- of a ball ``cos(22.5 deg)`` = 0.92 times its diameter,
- of a long cylinder within 8 % of its diameter.

Which side is the inside is found by looking (:mod:`moseg_objectives_basic.fields.rays`), and on an
open surface there is a value wherever a ray meets something.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from moseg_core import Shape, field_values
from moseg_objectives_basic.fields.places import Places
from moseg_objectives_basic.fields.rays import Frames, Rays, outsides

FloatArray = npt.NDArray[np.float64]

_MOST = 10_000
"""From how many places rays are cast at most."""

_RINGS = np.deg2rad([7.5, 15.0, 22.5, 30.0, 37.5])
_AROUND = 4


def thickness(shape: Shape) -> FloatArray:
    """How thick the shape is below each face, in diagonals of its bounding box.

    Parameters
    ----------
    shape : Shape
        A surface. It need not enclose a volume.

    Returns
    -------
    (F,) float
        Positive. The diagonal is :attr:`moseg_core.Shape.box_diagonal`. A face from which no ray
        meets the surface, at the rim of an open one, has the value of the nearest that has
        one; where no ray meets anything, as from a single sheet, all values are 1.

    Notes
    -----
    After Shapira, Shamir and Cohen-Or 2008, doi:10.1007/s00371-007-0197-5, with fixed directions
    in place of random ones and the median in place of a mean without outliers. On more than 10,000
    elements rays are cast from one in each of as many groups, whose value all its elements have.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> hammer = moseg.load(moseg.sample_path("hammer"))
    >>> values = moseg.field_values(hammer, "basic:thickness")
    >>> bool(0 < values.min() < values.max() < 0.5)
    True
    """
    places = Places.of(shape, _MOST)
    rays, frames = Rays(shape), Frames.of(shape, places.chosen)
    inward = -outsides(shape, places.chosen, rays, frames)[:, None] * frames.normals
    across = np.cross(inward, frames.sides)
    lengths = [rays.lengths(frames.origins, inward)]
    for k, angle in enumerate(_RINGS):
        for turn in (np.arange(_AROUND) + k % 2 / 2) * 2 * np.pi / _AROUND:
            beside = np.cos(turn) * frames.sides + np.sin(turn) * across
            direction = np.cos(angle) * inward + np.sin(angle) * beside
            direction[~frames.normals.any(axis=1)] = 0.0
            lengths.append(rays.lengths(frames.origins, direction))
    found = _median(np.stack(lengths, axis=1))
    return _filled(shape.points[places.chosen], found)[places.members]


def _median(lengths: FloatArray) -> FloatArray:
    """(k,) float: the median of the finite numbers in each row; infinite where there are none."""
    ordered = np.sort(lengths, axis=1)
    count = np.isfinite(ordered).sum(axis=1)
    rows = np.arange(len(ordered))
    middle: FloatArray = (
        ordered[rows, np.maximum(count - 1, 0) // 2] + ordered[rows, count // 2 * (count > 0)]
    ) / 2
    return middle


def _filled(points: FloatArray, values: FloatArray) -> FloatArray:
    """Values with that of the nearest point in place of infinite ones; 1 where all are."""
    known = np.isfinite(values)
    if known.all():
        return values
    if not known.any():
        return np.ones(len(values))
    nearest = cKDTree(points[known]).query(points[~known])[1]
    filled = values.copy()
    filled[~known] = values[known][nearest]
    return filled


def log_thickness(shape: Shape) -> FloatArray:
    """The natural logarithm of :func:`thickness`, in which ratios are differences.

    Parameters
    ----------
    shape : Shape

    Returns
    -------
    (F,) float
    """
    logarithm: FloatArray = np.log(field_values(shape, "basic:thickness"))
    return logarithm
