"""Algorithm 1 of the paper: the weighted Voronoi partition with connected segments.

Every centre floods outward from the element nearest to it, and a priority queue over all of them
decides who reaches an element first (Sec. 4, after Cohen-Steiner, Alliez, Desbrun 2004,
doi:10.1145/1015706.1015817). As corrected: a popped element is labelled only if it has no label
yet. Ties go by (distance, centre, element). An element that no flood reaches, on a component
without a seed, takes its nearest weighted centre.

Three things make the loop fast without changing what comes out:

- An (element, centre) pair always carries the same priority, so it enters the queue at most once.
- The queue is an implicit binary heap over two flat arrays: the distance, and one integer that
  holds centre and element.
- Most elements need no queue. Take a path from the element nearest to a centre, along which the
  distance to that centre rises strictly and every element is strictly nearer to it than to all
  others. As long as an element of the path has no label, the queue holds an entry for the first
  such one, with a priority below all that could take a later one away: so all get this centre.
  They are found by a plain search, in whatever order. Those of them that touch the rest enter the
  queue under their own distance, to be opened when they would have been: until then their path's
  entries stood in the queue below them, so every other entry is popped in the same order.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.heap import push, sift
from moseg_core.types import FloatArray, Int32Array, IntArray


@kernel
def _distances(points: FloatArray, centers: FloatArray, weights: FloatArray) -> FloatArray:
    """(n, F) weighted distances ||p - c|| / w, one row per centre."""
    n, size = centers.shape[0], points.shape[0]
    distance = np.empty((n, size))
    for i in range(n):
        cx, cy, cz, w = centers[i, 0], centers[i, 1], centers[i, 2], weights[i]
        for f in range(size):
            dx, dy, dz = points[f, 0] - cx, points[f, 1] - cy, points[f, 2] - cz
            distance[i, f] = np.sqrt(dx * dx + dy * dy + dz * dz) / w
    return distance


@kernel
def _nearest(distance: FloatArray, f: int) -> int:
    best = 0
    for i in range(1, distance.shape[0]):
        if distance[i, f] < distance[best, f]:
            best = i
    return best


@kernel
def _strictly_nearest(distance: FloatArray) -> Int32Array:
    """(F,) the nearest centre of each element; -1 where two are equally near."""
    n, size = distance.shape
    nearest = np.zeros(size, np.int32)
    for f in range(size):
        best = distance[0, f]
        for i in range(1, n):
            d = distance[i, f]
            if d < best:
                best = d
                nearest[f] = i
            elif d == best:
                nearest[f] = -1
    return nearest


@kernel
def _climb(
    start: int,
    center: int,
    distance: FloatArray,
    nearest: Int32Array,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
    stack: IntArray,
) -> None:
    """Label what rising paths through elements nearest to one centre reach from its start."""
    labels[start] = center
    stack[0] = start
    top = 1
    while top > 0:
        top -= 1
        f = stack[top]
        for e in range(indptr[f], indptr[f + 1]):
            g = indices[e]
            if labels[g] < 0 and nearest[g] == center and distance[g] > distance[f]:
                labels[g] = center
                stack[top] = g
                top += 1


@kernel
def voronoi_labels(
    points: FloatArray, centers: FloatArray, weights: FloatArray, labels: Int32Array
) -> None:
    """Nearest weighted centre of each point, written into `labels`; ties to the lower centre."""
    distance = _distances(points, centers, weights)
    for f in range(points.shape[0]):
        labels[f] = _nearest(distance, f)


@kernel
def flood_labels(
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
) -> None:
    """Connected weighted Voronoi partition, written into `labels`.

    Parameters
    ----------
    points : (F, 3) float
    centers : (n, 3) float
        In the same coordinates.
    weights : (n,) float, positive
    indptr, indices : (F + 1,), (E,) int32
        Adjacency in CSR form.
    labels : (F,) int32, written
        Index of the centre that each element belongs to.
    """
    n, size = centers.shape[0], points.shape[0]
    distance = _distances(points, centers, weights)
    nearest = _strictly_nearest(distance)
    queued = np.zeros((n, size), np.bool_)
    key = np.empty(n * size)
    code = np.empty(n * size, np.int64)
    count = 0
    labels[:] = -1

    stack = np.empty(size, np.int64)
    for i in range(n):
        f = int(np.argmin(distance[i]))
        if nearest[f] == i:
            _climb(f, i, distance[i], nearest, indptr, indices, labels, stack)
        else:
            queued[i, f] = True
            count = push(key, code, count, distance[i, f], i * size + f)
    for g in range(size):
        if labels[g] >= 0:
            continue
        for e in range(indptr[g], indptr[g + 1]):
            f = indices[e]
            i = labels[f]
            if i >= 0 and not queued[i, f]:
                queued[i, f] = True
                count = push(key, code, count, distance[i, f], i * size + f)

    while count > 0:
        i, f = divmod(int(code[0]), size)
        # The first neighbour queued takes the place of the entry that leaves: one walk down
        # the heap instead of two.
        vacant = True
        if labels[f] < 0:
            labels[f] = i
        if labels[f] == i:
            for e in range(indptr[f], indptr[f + 1]):
                g = indices[e]
                if labels[g] < 0 and not queued[i, g]:
                    queued[i, g] = True
                    if vacant:
                        sift(key, code, count, distance[i, g], i * size + g)
                        vacant = False
                    else:
                        count = push(key, code, count, distance[i, g], i * size + g)
        if vacant:
            count -= 1
            sift(key, code, count, key[count], code[count])

    for f in range(size):
        if labels[f] < 0:
            labels[f] = _nearest(distance, f)
