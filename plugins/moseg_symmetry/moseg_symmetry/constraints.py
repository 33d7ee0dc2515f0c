"""Symmetry of the centres (Sec. 8): one is the mirror image of another, or lies on the plane.

A segmentation whose centres are symmetric is symmetric itself, by construction, and has fewer
numbers to search: the bulldog of Fig. 9 goes from 24 to 14, since two of its legs have no numbers
of their own and head and body have three instead of four. Both constraints answer the protocol
``Constraint`` of the core, which composes them, and both take the plane from
:func:`moseg_symmetry.plane_of.plane_of`, in unit coordinates.

Each also says which feasible centres are nearest to any given ones, so that a search can begin
from centres that know of no constraint. Both are orthogonal projections in the coordinates
``x, y, z, w``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from moseg_core import Shape, UsageError
from moseg_symmetry.plane_of import plane_of

FloatArray = npt.NDArray[np.float64]


class Mirror:
    """The mirror image of another label's centre at the plane of symmetry.

    Both have the same weight. The first has no numbers of its own.

    Parameters
    ----------
    shape : Shape
    labels : sequence of int
        Follower and source.
    plane : str
        ``auto``, ``x``, ``y``, ``z`` or ``px,py,pz,nx,ny,nz``.

    Raises
    ------
    UsageError
        Not exactly two different labels; a malformed plane.
    ShapeError
        The shape has no plane of symmetry to be found.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> mirror = Mirror(horse, [0, 1], plane="x")
    >>> given = np.array([[9.0, 9.0, 9.0, 9.0], [0.25, 0.5, 0.0, 1.0]])
    >>> mirror.expand(np.empty(0), given).tolist()
    [[-0.25, 0.5, 0.0, 1.0], [0.25, 0.5, 0.0, 1.0]]
    """

    def __init__(self, shape: Shape, labels: Sequence[int], *, plane: str = "auto") -> None:
        if len(labels) != 2 or labels[0] == labels[1]:
            raise UsageError(
                "constraint 'mirror' takes two different labels, that which follows and that which"
                f" it mirrors, as in mirror(leg2, leg1); it was given {_count(labels)}"
            )
        self._follower, self._source = (int(label) for label in labels)
        self.plane = plane_of(shape, plane)

    @property
    def determines(self) -> tuple[int, ...]:
        """The follower."""
        return (self._follower,)

    @property
    def reads(self) -> tuple[int, ...]:
        """The source."""
        return (self._source,)

    @property
    def lower(self) -> FloatArray:
        """(0,) float: there are no numbers of its own."""
        return np.empty(0)

    @property
    def upper(self) -> FloatArray:
        """(0,) float: there are no numbers of its own."""
        return np.empty(0)

    def expand(self, free: FloatArray, centers: FloatArray) -> FloatArray:
        """(n, 4) float: the centres, that of the follower the mirror image of the source's."""
        rows = centers.copy()
        rows[self._follower] = self._image(centers[self._source])
        return rows

    def reduce(self, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """No numbers, and the nearest centres that mirror each other.

        The source goes half the way to the mirror image of the follower, and the follower half
        the way to that of the source: no other two that mirror each other are as near, in the
        sum of squares.
        """
        rows = centers.copy()
        meant = self._image(centers[self._follower])
        rows[self._source] = (centers[self._source] + meant) / 2.0
        rows[self._follower] = self._image(rows[self._source])
        return np.empty(0), rows

    def _image(self, row: FloatArray) -> FloatArray:
        return np.append(self.plane.reflect(row[:3]), row[3])


class OnPlane:
    """Centres on the plane of symmetry, by their coordinates within it.

    Each label has three numbers of its own instead of four: two coordinates in the plane and the
    weight, label after label.

    Parameters
    ----------
    shape : Shape
    labels : sequence of int
        One or more, all different.
    plane : str
        ``auto``, ``x``, ``y``, ``z`` or ``px,py,pz,nx,ny,nz``.

    Raises
    ------
    UsageError
        No label, or one twice; a malformed plane.
    ShapeError
        The shape has no plane of symmetry to be found.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = moseg.load(moseg.sample_path("horse"))
    >>> on_plane = OnPlane(horse, [0], plane="x")
    >>> free, rows = on_plane.reduce(np.array([[0.25, 0.5, -0.125, 1.0]]))
    >>> len(free), (0.0 + rows).tolist()
    (3, [[0.0, 0.5, -0.125, 1.0]])
    """

    #: Given several labels in an expression, it is made for each of them.
    each = True

    def __init__(self, shape: Shape, labels: Sequence[int], *, plane: str = "auto") -> None:
        if not labels or len(set(labels)) < len(labels):
            raise UsageError(
                "constraint 'on_plane' takes one or more different labels, as in on_plane(body,"
                f" head); it was given {_count(labels)}"
            )
        self._labels = tuple(int(label) for label in labels)
        self.plane = plane_of(shape, plane)
        # The foot of the origin, so that the numbers are no larger than the coordinates.
        self._origin = self.plane.project(np.zeros(3))
        self._axes = self.plane.axes()

    @property
    def determines(self) -> tuple[int, ...]:
        """All its labels."""
        return self._labels

    @property
    def reads(self) -> tuple[int, ...]:
        """None."""
        return ()

    @property
    def lower(self) -> FloatArray:
        """(3k,) float: coordinates are free, weights are positive."""
        smallest = np.finfo(np.float64).tiny
        return np.tile([-np.inf, -np.inf, smallest], len(self._labels))

    @property
    def upper(self) -> FloatArray:
        """(3k,) float: unbounded."""
        return np.full(3 * len(self._labels), np.inf)

    def expand(self, free: FloatArray, centers: FloatArray) -> FloatArray:
        """(n, 4) float: the centres, those of its labels at the given places in the plane."""
        rows = centers.copy()
        u, v, weights = np.reshape(free, (-1, 3)).T
        places = list(self._labels)
        rows[places, :3] = self._origin + u[:, None] * self._axes[0] + v[:, None] * self._axes[1]
        rows[places, 3] = weights
        return rows

    def reduce(self, centers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The places of the centres in the plane and their weights; the centres there.

        A centre goes to the foot of its perpendicular.
        """
        chosen = centers[list(self._labels)]
        apart = chosen[:, :3] - self._origin
        free = np.column_stack(
            [(apart * self._axes[0]).sum(axis=1), (apart * self._axes[1]).sum(axis=1), chosen[:, 3]]
        ).reshape(-1)
        return free, self.expand(free, centers)


def _count(labels: Sequence[int]) -> str:
    if len(set(labels)) < len(labels):
        return "one twice"
    return f"{len(labels)}"
