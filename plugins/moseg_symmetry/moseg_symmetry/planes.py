"""Planes: reflection and projection at them, and how a user writes one.

A plane is a point and a unit normal, ``{x : n . (x - p) = 0}``. Everything here works in whatever
units the plane is in: model units in what users write and read, unit coordinates
(``shape.frame.to_unit``) in the search. :meth:`Plane.to_unit` goes from the first to the second.

The text that names a plane is ``auto`` (found on the shape, :mod:`moseg_symmetry.plane_of`), an
axis of the file or six numbers; :func:`read_plane` reads it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core import ShapeError, UsageError

FloatArray = npt.NDArray[np.float64]

ALLOWED = (
    "allowed are 'auto' (found on the shape), 'x', 'y' or 'z' (across that axis of the file,"
    " through the middle of the bounding box) and 'px,py,pz,nx,ny,nz' (a point and the normal,"
    " in the file's units)"
)


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane through a point, across a normal. Make one with :meth:`through`.

    Parameters
    ----------
    point : (3,) float
        Any point of the plane.
    normal : (3,) float
        Of length 1, its component of greatest size positive: both normals mean one plane.
    """

    point: FloatArray
    normal: FloatArray

    @classmethod
    def through(cls, point: npt.ArrayLike, normal: npt.ArrayLike) -> Plane:
        """The plane through a point, across a direction of any length but 0.

        Examples
        --------
        >>> Plane.through([0, 0, 1], [0, 0, -2]).normal.tolist()
        [0.0, 0.0, 1.0]
        """
        direction = np.array(normal, np.float64)
        # By the greatest component first: the squares of 1e-200 are 0.
        direction = direction / direction[np.argmax(np.abs(direction))]
        direction = direction / np.linalg.norm(direction) + 0.0  # no -0.0
        return cls(np.array(point, np.float64), direction)

    def heights(self, points: FloatArray) -> FloatArray:
        """(k,) float: signed distances of (k, 3) points from the plane."""
        # Not `@`, whose last bits depend on how many points come together.
        return np.asarray(((points - self.point) * self.normal).sum(axis=-1))

    def reflect(self, points: FloatArray) -> FloatArray:
        """(k, 3) float: the mirror images of points.

        Examples
        --------
        >>> Plane.through([1, 0, 0], [1, 0, 0]).reflect(np.array([[3.0, 4.0, 5.0]])).tolist()
        [[-1.0, 4.0, 5.0]]
        """
        return points - 2.0 * self.heights(points)[..., None] * self.normal

    def project(self, points: FloatArray) -> FloatArray:
        """(k, 3) float: the points of the plane nearest to those given."""
        return points - self.heights(points)[..., None] * self.normal

    def axes(self) -> FloatArray:
        """(2, 3) float: two directions in the plane, of length 1, at right angles.

        The first is across the axis of the file with which the normal has the widest angle, so
        that a small change of the plane is a small change of the directions.

        Examples
        --------
        >>> (0.0 + Plane.through([0, 0, 0], [0, 0, 1]).axes()).tolist()
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
        """
        least = np.zeros(3)
        least[np.argmin(np.abs(self.normal))] = 1.0
        first = np.cross(self.normal, least)
        first /= np.linalg.norm(first)
        return np.stack([first, np.cross(self.normal, first)])

    def to_unit(self, center: FloatArray, scale: float) -> Plane:
        """The plane in the unit coordinates of a frame: ``unit = (x - center) / scale``."""
        return Plane((self.point - center) / scale, self.normal)

    def __str__(self) -> str:
        """``px,py,pz,nx,ny,nz``, as :func:`read_plane` reads it."""
        numbers = [*self.point, *self.normal]
        return ",".join(f"{number + 0.0:.9g}" for number in numbers)


def read_plane(text: str, *, center: FloatArray) -> Plane:
    """The plane that a text other than ``auto`` names.

    Parameters
    ----------
    text : str
        ``x``, ``y`` or ``z``: across that axis, through `center`. Or six numbers with commas
        between: a point of the plane and its normal, of any length but 0.
    center : (3,) float, model units
        Middle of the bounding box.

    Returns
    -------
    Plane
        In model units.

    Raises
    ------
    UsageError
        Anything else; says what is allowed.

    Examples
    --------
    >>> print(read_plane("x", center=np.array([5.0, 0.0, 0.0])))
    5,0,0,1,0,0
    >>> print(read_plane("0, 0, 1, 0, 0, -3", center=np.zeros(3)))
    0,0,1,0,0,1
    """
    word = text.strip()
    if word in ("x", "y", "z"):
        return Plane.through(center, np.eye(3)["xyz".index(word)])
    try:
        numbers = [float(number) for number in word.split(",")]
    except ValueError:
        raise UsageError(f"plane '{text}' is not understood; {ALLOWED}") from None
    if len(numbers) != 6:
        raise UsageError(
            f"plane '{text}' has {len(numbers)} number{'s' if len(numbers) != 1 else ''} instead"
            f" of 6; {ALLOWED}"
        )
    if not all(map(math.isfinite, numbers)):
        raise UsageError(f"plane '{text}' has a number that is not finite; {ALLOWED}")
    if not any(numbers[3:]):
        raise UsageError(f"plane '{text}' has a normal of length 0; {ALLOWED}")
    return Plane.through(numbers[:3], numbers[3:])


def tidy(numbers: FloatArray, unit: float) -> FloatArray:
    """The numbers, those that rounding left instead of 0 being 0: below 1e-12 of a unit.

    Examples
    --------
    >>> tidy(np.array([1e-16, -3.0]), 1.0).tolist()
    [0.0, -3.0]
    """
    return np.where(np.abs(numbers) < 1e-12 * unit, 0.0, numbers)


def refuse_in(space: str, text: str) -> None:
    """Refuse a plane of the file in another space, where it means nothing.

    Raises
    ------
    ShapeError
        The space is not the user's own.
    """
    if space != "original":
        raise ShapeError(
            f"plane '{text}' is one of the file and means nothing in the space '{space}', in which"
            " the shape is deformed; there only 'auto' is allowed"
        )
