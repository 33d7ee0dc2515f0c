"""Landmarks: vertices far from each other, from which alone distances are computed.

All pairs of distances on a mesh of ten thousand vertices are too many to compute and to keep. The
farthest-point rule covers a surface evenly with a few hundred, in an order in which any first
``k`` do so too: each is the vertex farthest from those before it. It finds the tips of limbs first
(V. de Silva, J. Tenenbaum 2004, "Sparse multidimensional scaling using landmark points"; T.
Gonzalez 1985, doi:10.1016/0304-3975(85)90224-5).

Nothing but distances along the surface decides, so that a shape in another pose has the same
landmarks.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


def farthest_points(
    distances: Callable[[int], FloatArray], count: int, *, near: int = 0
) -> tuple[IntArray, FloatArray]:
    """Choose landmarks, with their distances to everything.

    Parameters
    ----------
    distances : callable
        From a vertex to the (V,) distances of all; finite.
    count : int
        How many; fewer come back where every vertex is a landmark before.
    near : int
        A vertex to look for the first landmark from, the end of a longest way. It matters where
        there are several.

    Returns
    -------
    landmarks : (k,) int
        Different vertices. Of vertices that are equally far the first is taken.
    table : (k, V) float
        Distances from each landmark to every vertex.

    Examples
    --------
    On a line, the ends come first and then the middle:

    >>> places = np.arange(9.0)
    >>> farthest_points(lambda k: np.abs(places - places[k]), 3)[0].tolist()
    [8, 0, 4]
    """
    first = _extremity(distances, near)
    landmarks, rows = [first], [distances(first)]
    gap = rows[0].copy()
    while len(landmarks) < min(count, len(gap)):
        following = int(gap.argmax())
        if gap[following] <= 0.0:
            break
        landmarks.append(following)
        rows.append(distances(following))
        np.minimum(gap, rows[-1], out=gap)
        gap[following] = 0.0  # whatever an approximate method says
    return np.array(landmarks, np.int64), np.array(rows)


def _extremity(distances: Callable[[int], FloatArray], near: int) -> int:
    """An end of the shape.

    Of the two ends of a longest way, found by going to the farthest vertex a few times, it is the
    one that is farther from everything.
    """
    here = int(distances(near).argmax())
    row = distances(here)
    there = int(row.argmax())
    return here if row.sum() >= distances(there).sum() else there
