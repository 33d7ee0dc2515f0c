"""Reflections and turns, and how their images change with the plane or the axis.

A symmetry of a surface is a motion that maps it onto itself. To find one, a motion that nearly
does is improved (:mod:`moseg_symmetry.refine`), and for that it must say how the images of points
move as its own numbers change. There are two families:

- :class:`Reflection` at a plane, of three numbers: two for the normal, one for the offset;
- :class:`Turns` by given angles about an axis, of four: two for its direction, two for its place.

Coordinates are those of :class:`moseg_symmetry.surface.Surface`: the centroid is the origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from moseg_symmetry.planes import Plane

FloatArray = npt.NDArray[np.float64]
_Self = TypeVar("_Self")


class Motion(Protocol):
    """One or several maps of space, which depend on a few numbers."""

    def images(self, points: FloatArray) -> FloatArray:
        """(m, k, 3) float: the images of (k, 3) points under each of m maps."""
        ...

    def tangents(self, points: FloatArray) -> FloatArray:
        """(p, m, k, 3) float: how fast the images move with each of the p numbers."""
        ...

    def changed(self: _Self, step: FloatArray) -> _Self:
        """The motion with its numbers changed by the (p,) values of `step`."""
        ...

    def apart(self: _Self, other: _Self) -> float:
        """How far apart two are: the greatest distance of images in the unit ball, about."""
        ...


@dataclass(frozen=True, eq=False)
class Reflection:
    """The reflection at ``{x : n . x = h}``.

    Parameters
    ----------
    normal : (3,) float
        Of length 1.
    offset : float
        Signed distance of the plane from the origin, along the normal.
    """

    normal: FloatArray
    offset: float

    @property
    def plane(self) -> Plane:
        """The plane, through the foot of the origin."""
        return Plane.through(self.offset * self.normal, self.normal)

    def images(self, points: FloatArray) -> FloatArray:
        """(1, k, 3) float: the mirror images."""
        return (points - 2.0 * self._heights(points)[:, None] * self.normal)[None]

    def tangents(self, points: FloatArray) -> FloatArray:
        """(3, 1, k, 3) float: by the two tilts of the normal, and by the offset."""
        n, heights = self.normal, self._heights(points)[:, None]
        tilts = [-2.0 * ((points @ u)[:, None] * n + heights * u) for u in self.plane.axes()]
        return np.stack([*tilts, np.broadcast_to(2.0 * n, points.shape)])[:, None]

    def changed(self, step: FloatArray) -> Reflection:
        """The normal tilted by two small angles, the offset changed by the third number."""
        normal = self.normal + step[:2] @ self.plane.axes()
        return Reflection(normal / np.linalg.norm(normal), self.offset + float(step[2]))

    def apart(self, other: Reflection) -> float:
        """Sine of the angle between the planes, and the difference of their offsets."""
        cosine = float(self.normal @ other.normal)
        offset = self.offset - float(np.sign(cosine)) * other.offset
        return float(np.hypot(np.sqrt(max(0.0, 1.0 - cosine**2)), offset))

    def _heights(self, points: FloatArray) -> FloatArray:
        heights: FloatArray = points @ self.normal - self.offset
        return heights


@dataclass(frozen=True, eq=False)
class Turns:
    """Turns about one axis by several angles.

    Parameters
    ----------
    direction : (3,) float
        Of length 1.
    point : (3,) float
        Of the axis.
    angles : (m,) float, radians
    """

    direction: FloatArray
    point: FloatArray
    angles: FloatArray

    def images(self, points: FloatArray) -> FloatArray:
        """(m, k, 3) float: the turned points, for each angle."""
        turned: FloatArray = (points - self.point) @ self._matrices().transpose(0, 2, 1)
        return turned + self.point

    def tangents(self, points: FloatArray) -> FloatArray:
        """(4, m, k, 3) float: by the two tilts of the direction, and by the two shifts."""
        matrices = self._matrices().transpose(0, 2, 1)
        local = points - self.point
        turned = local @ matrices
        found = []
        axes = self._axes()
        for u in axes:
            # The axis goes round q; what was turned about it goes along, what will be goes back.
            q = np.cross(self.direction, u)
            found.append(np.cross(q, turned) - np.cross(q, local) @ matrices)
        found += [np.broadcast_to((u - u @ matrices)[:, None], turned.shape) for u in axes]
        return np.stack(found)

    def changed(self, step: FloatArray) -> Turns:
        """The direction tilted by two small angles, the axis shifted by the other two numbers."""
        u, v = self._axes()
        direction = self.direction + step[0] * u + step[1] * v
        point = self.point + step[2] * u + step[3] * v
        return Turns(direction / np.linalg.norm(direction), point, self.angles)

    def apart(self, other: Turns) -> float:
        """Sine of the angle between the axes, and their distance at the origin."""
        cosine = float(self.direction @ other.direction)
        gap = self._foot() - other._foot()
        return float(np.hypot(np.sqrt(max(0.0, 1.0 - cosine**2)), np.linalg.norm(gap)))

    def _foot(self) -> FloatArray:
        """The point of the axis nearest to the origin."""
        return self.point - (self.point @ self.direction) * self.direction

    def _axes(self) -> FloatArray:
        return Plane(self.point, self.direction).axes()

    def _matrices(self) -> FloatArray:
        return Rotation.from_rotvec(self.angles[:, None] * self.direction).as_matrix()
