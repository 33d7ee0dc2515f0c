"""What clipping asks of a partition of space: how far points are from its parts, and where equally.

:class:`~moseg_core.clipping.bisector.Bisectors` answers for weighted centres, in closed form.
:class:`DistanceField` answers for any parts whose distances are known (Sec. 4 allows any family of
segmentations), by searching along an edge and within a triangle.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from moseg_core.types import FloatArray, IntArray

#: Halvings of an edge, until what is left of it is rounding.
_HALVINGS = 50
#: Newton's steps within a triangle, and the step of its finite differences, in sides.
_STEPS, _DIFFERENCE = 20, 1e-6


class Boundaries(Protocol):
    """Where parts meet: a point belongs to the part that it is least distant from."""

    def distances(self, points: FloatArray) -> FloatArray:
        """(P, n) float: how far (P, 3) points are from the parts, or what grows with that."""
        ...

    def crossing(self, start: FloatArray, end: FloatArray, i: IntArray, j: IntArray) -> FloatArray:
        """(E,) float: where edges from nearer `i` to nearer `j` have both at one distance."""
        ...

    def junction(self, corners: FloatArray, triples: IntArray, start: FloatArray) -> FloatArray:
        """(T, 3) float: barycentric points that three parts are equally far from; or NaN."""
        ...


@dataclass(frozen=True, eq=False)
class DistanceField:
    """Boundaries of parts of which nothing is known but distances.

    Parameters
    ----------
    of : callable
        From (P, 3) points to (P, n) distances.
    """

    of: Callable[[FloatArray], FloatArray]

    def distances(self, points: FloatArray) -> FloatArray:
        """(P, n) float: how far (P, 3) points are from the parts."""
        return self.of(points)

    def crossing(self, start: FloatArray, end: FloatArray, i: IntArray, j: IntArray) -> FloatArray:
        """Where edges cross the boundary of two parts, by halving.

        Parameters
        ----------
        start, end : (E, 3) float
            Nearer to part `i` than to `j`, and the other way round.
        i, j : (E,) int

        Returns
        -------
        (E,) float
            0 at the start to 1 at the end.

        Examples
        --------
        >>> centers = np.array([[0.0, 0, 0], [3, 0, 0]])
        >>> field = DistanceField(lambda x: np.abs(x[:, None] - centers).max(axis=2))
        >>> ends = np.zeros((1, 3)), np.array([[3.0, 1, 0]])
        >>> field.crossing(*ends, np.array([0]), np.array([1])).round(9).tolist()
        [0.5]
        """
        low, high = np.zeros(len(start)), np.ones(len(start))
        if not len(start):
            return low
        rows = np.arange(len(start))
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            apart = self.of(start + middle[:, None] * (end - start))
            beyond = apart[rows, i] > apart[rows, j]
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        return 0.5 * (low + high)

    def junction(self, corners: FloatArray, triples: IntArray, start: FloatArray) -> FloatArray:
        """Points of triangles that are equally far from three parts.

        Newton's method with finite differences, in the plane of the triangle.

        Parameters
        ----------
        corners : (T, 3, 3) float
        triples : (T, 3) int
            The three parts of each triangle.
        start : (T, 3) float
            Barycentric coordinates to start from.

        Returns
        -------
        (T, 3) float
            Barycentric coordinates, which add up to 1. Some may be negative: the junction lies
            outside. NaN where no junction was found.

        Examples
        --------
        >>> centers = np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]])
        >>> field = DistanceField(lambda x: np.linalg.norm(x[:, None] - centers, axis=2))
        >>> triangle = np.array([[[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]])
        >>> found = field.junction(triangle, np.array([[0, 1, 2]]), np.full((1, 3), 1 / 3))
        >>> bool(np.allclose(found, [[0, 0.5, 0.5]]))
        True
        """
        if not len(corners):
            return start.copy()
        origin, sides = corners[:, 0], corners[:, 1:] - corners[:, :1]

        def gaps(share: FloatArray) -> FloatArray:
            """(T, 2) float: how much farther the first part is than the other two."""
            apart = self.of(origin + np.einsum("tk,tkd->td", share, sides))
            three = np.take_along_axis(apart, triples, axis=1)
            gap: FloatArray = three[:, :1] - three[:, 1:]
            return gap

        share = start[:, 1:].copy()
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(_STEPS):
                gap = gaps(share)
                along, across = (
                    (gaps(share + _DIFFERENCE * axis) - gap) / _DIFFERENCE for axis in np.eye(2)
                )
                determinant = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
                step = np.stack(
                    [
                        gap[:, 0] * across[:, 1] - gap[:, 1] * across[:, 0],
                        gap[:, 1] * along[:, 0] - gap[:, 0] * along[:, 1],
                    ],
                    axis=1,
                )
                step /= determinant[:, None]
                # Nobody needs to know how far outside a junction is; nor are all distances
                # known there.
                share = np.clip(share - step, -2.0, 2.0)
            still = (np.abs(step) < 1e-7).all(axis=1)
        share[~still] = np.nan
        return np.column_stack([1.0 - share.sum(axis=1), share])
