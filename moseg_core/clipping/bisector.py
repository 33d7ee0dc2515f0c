r"""Where two or three weighted centres are equally near: on an edge, and in a triangle.

In a multiplicatively weighted Voronoi partition (Sec. 4) a point ``x`` is at the distance
``||x - c_i|| / w_i`` from centre ``i``. Squared, with ``s_i = 1 / w_i^2``, that is the polynomial

    q_i(x) = s_i ||x - c_i||^2.

The bisector of ``i`` and ``j`` is ``q_i = q_j``: a plane where the weights are equal, else a sphere
of Apollonius. Along an edge it is a quadratic equation in one unknown, solved here in closed form;
the point of a triangle where three centres are equally near is found by Newton's method.
:mod:`moseg_core.clipping.clip` asks the one question of edges and the other of faces that straddle
a boundary.

Source: Okabe et al., Spatial Tessellations, 2nd ed., 2000, Sec. 3.1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.types import FloatArray, IntArray

_STEPS = 12


@dataclass(frozen=True, eq=False)
class Bisectors:
    """The bisectors of weighted centres.

    Parameters
    ----------
    centers : (n, 3) float
        In the coordinates of the points that are asked about.
    weights : (n,) float, positive
        Only their ratios matter.
    """

    centers: FloatArray
    weights: FloatArray

    @property
    def scales(self) -> FloatArray:
        """(n,) float: s_i, up to a factor that all share."""
        scales: FloatArray = (self.weights.max() / self.weights) ** 2
        return scales

    def distances(self, points: FloatArray) -> FloatArray:
        """(P, n) float: q_i at (P, 3) points, squared distances up to a factor that all share.

        Examples
        --------
        >>> pair = Bisectors(np.array([[0.0, 0, 0], [3, 0, 0]]), np.array([1.0, 2]))
        >>> pair.distances(np.array([[1.0, 0, 0]])).tolist()  # 1 / 1 and 2 / 2: on the bisector
        [[4.0, 4.0]]
        """
        squared = np.empty((len(points), len(self.centers)))
        for i, (center, scale) in enumerate(zip(self.centers, self.scales, strict=True)):
            apart = points - center
            squared[:, i] = scale * np.einsum("pd,pd->p", apart, apart)
        return squared

    def crossing(self, start: FloatArray, end: FloatArray, i: IntArray, j: IntArray) -> FloatArray:
        """Where edges from nearer `i` to nearer `j` meet the bisector of the two.

        The difference ``q_i - q_j`` is a quadratic that goes from negative to positive along the
        edge, and so has exactly one root on it: of the two the one at which it rises.

        Parameters
        ----------
        start, end : (E, 3) float
            ``q_i <= q_j`` at the start, ``q_i >= q_j`` at the end, not both with equality.
        i, j : (E,) int

        Returns
        -------
        (E,) float
            0 at the start to 1 at the end.

        Examples
        --------
        >>> pair = Bisectors(np.array([[0.0, 0, 0], [3, 0, 0]]), np.array([1.0, 2]))
        >>> zero, one = np.array([0]), np.array([1])
        >>> pair.crossing(np.zeros((1, 3)), np.array([[4.0, 0, 0]]), zero, one).tolist()
        [0.25]
        """
        s_i, s_j = self.scales[i], self.scales[j]
        along = end - start
        from_i, from_j = start - self.centers[i], start - self.centers[j]
        # q_i - q_j = a t^2 + b t + c at start + t along.
        a = (s_i - s_j) * np.einsum("ed,ed->e", along, along)
        b = 2.0 * np.einsum("ed,ed->e", along, s_i[:, None] * from_i - s_j[:, None] * from_j)
        c = s_i * np.einsum("ed,ed->e", from_i, from_i)
        c -= s_j * np.einsum("ed,ed->e", from_j, from_j)
        root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
        # Twice the same root; each form where it does not subtract what is nearly equal.
        above = np.where(b >= 0.0, -2.0 * c, root - b)
        below = np.where(b >= 0.0, b + root, 2.0 * a)
        where: FloatArray = np.divide(above, below, out=np.zeros_like(c), where=below != 0.0)
        return np.clip(where, 0.0, 1.0)

    def junction(self, corners: FloatArray, triples: IntArray, start: FloatArray) -> FloatArray:
        """Points of triangles that are equally near to three centres.

        Newton's method on ``q_i = q_j`` and ``q_i = q_k`` in the plane of the triangle.

        Parameters
        ----------
        corners : (T, 3, 3) float
        triples : (T, 3) int
            The three centres of each triangle.
        start : (T, 3) float
            Barycentric coordinates to start from.

        Returns
        -------
        (T, 3) float
            Barycentric coordinates, which add up to 1. Some may be negative: the junction lies
            outside. NaN where no junction was found.

        Examples
        --------
        >>> three = Bisectors(np.array([[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]), np.ones(3))
        >>> triangle = np.array([[[0.0, 0, 0], [3, 0, 0], [0, 3, 0]]])
        >>> three.junction(triangle, np.array([[0, 1, 2]]), np.full((1, 3), 1 / 3)).tolist()
        [[0.0, 0.5, 0.5]]
        """
        origin, sides = corners[:, 0], corners[:, 1:] - corners[:, :1]
        scales, centers = self.scales[triples], self.centers[triples]
        place = start[:, 1:].copy()
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(_STEPS):
                x = origin + np.einsum("tk,tkd->td", place, sides)
                apart = x[:, None] - centers
                q = scales * np.einsum("tkd,tkd->tk", apart, apart)
                slope = 2.0 * np.einsum("tk,tkd,tsd->tks", scales, apart, sides)
                gap, (m, n) = q[:, :1] - q[:, 1:], np.moveaxis(slope[:, :1] - slope[:, 1:], 1, 0)
                determinant = m[:, 0] * n[:, 1] - m[:, 1] * n[:, 0]
                step = np.stack(
                    [
                        gap[:, 0] * n[:, 1] - gap[:, 1] * m[:, 1],
                        gap[:, 1] * m[:, 0] - gap[:, 0] * n[:, 0],
                    ],
                    axis=1,
                )
                step /= determinant[:, None]
                place -= step
            # A step doubles the digits that are right: what still moves does not converge.
            still = np.abs(step) < 1e-9 * (1.0 + np.abs(place))
            place[~(still[:, 0] & still[:, 1])] = np.nan
        return np.column_stack([1.0 - place.sum(axis=1), place])
