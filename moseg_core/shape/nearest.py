"""Which points are the nearest of each, also where very many are in one place.

A search tree parts points by their coordinates, and those that have the same ones stay together:
to look for the nearest of each of n points in one place takes the square of n. But of a place with
more points than are asked for, the nearest of each are any others there. So such a place stands in
the tree with as many points as are asked for, and its own points have each other, in a ring.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from moseg_core.shape.positions import find_positions
from moseg_core.types import FloatArray, IntArray

# So many points in one place are no burden to a tree.
_CROWD = 32


def nearest_points(points: FloatArray, count: int) -> tuple[FloatArray, IntArray]:
    """The nearest points of each, itself or one in its very place first.

    Parameters
    ----------
    points : (F, 3) float
    count : int
        How many; from 1 to F.

    Returns
    -------
    distances : (F, count) float
        Ascending.
    numbers : (F, count) int

    Examples
    --------
    >>> distances, numbers = nearest_points(np.array([[0.0, 0, 0], [1, 0, 0], [5, 0, 0]]), 2)
    >>> distances.tolist(), numbers.tolist()
    ([[0.0, 1.0], [0.0, 1.0], [0.0, 4.0]], [[0, 1], [1, 0], [2, 1]])
    """
    place = find_positions(points).number
    sizes = np.bincount(place)
    crowd = max(_CROWD, count)
    if sizes.max() <= crowd:
        found = cKDTree(points).query(points, count)
        return tuple(np.asarray(each).reshape(-1, count) for each in found)  # type: ignore[return-value]  # of two arrays
    order = np.argsort(place, kind="stable")
    starts = np.cumsum(sizes) - sizes
    rank = np.empty(len(points), np.int64)  # among those in the same place
    rank[order] = np.arange(len(points)) - np.repeat(starts, sizes)
    crowded = sizes[place] > crowd
    distances = np.zeros((len(points), count))
    numbers = np.empty((len(points), count), np.int64)
    # Itself, and those before and behind it in turn: each is then among the nearest of the other.
    steps = np.array([(k + 1) // 2 * (-1) ** k for k in range(count)])
    here = place[crowded, None]
    numbers[crowded] = order[starts[here] + (rank[crowded, None] + steps) % sizes[here]]
    kept = np.flatnonzero(~crowded | (rank < count))
    if not crowded.all():
        found = cKDTree(points[kept]).query(points[~crowded], count)
        distances[~crowded] = np.asarray(found[0]).reshape(-1, count)
        numbers[~crowded] = kept[np.asarray(found[1]).reshape(-1, count)]
    return distances, numbers
