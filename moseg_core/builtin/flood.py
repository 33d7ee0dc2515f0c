"""Algorithm 1 of the paper: the weighted Voronoi partition with connected segments.

Every centre floods outward from the element nearest to it, and a priority queue over all of them
decides who reaches an element first (Sec. 4, after Cohen-Steiner, Alliez, Desbrun 2004,
doi:10.1145/1015706.1015817). As corrected: a popped element is labelled only if it has no label
yet. Ties go by (distance, centre, element). An element that no flood reaches, on a component
without a seed, takes its nearest weighted centre.

Four things make the loop fast without changing what comes out:

- An (element, centre) pair always carries the same priority, so it enters the queue at most once.
- The queue is an implicit binary heap over two flat arrays: the distance, and one integer that
  holds centre and element.
- Most elements need no queue. Take a path from the element nearest to a centre, or from any that
  was just opened with its label, along which the distance to that centre rises strictly and every
  element is strictly nearer to it than to all others. As long as an element of the path has no
  label, the queue holds an entry for the first such one, with a priority below all that could take
  a later one away: so all get this centre. They are found by a plain search, in whatever order.
  Those of them that touch the rest enter the queue under their own distance, to be opened when
  they would have been: until then their path's entries stood in the queue below them, so every
  other entry is popped in the same order.
- "All others" are those that can get to an element at all. Once every centre has been opened, only
  the labels around a region that has none can get into it: where these are one label, the region
  has it; elsewhere the nearest of these counts in place of the nearest of all. A large weight makes
  a centre the nearest to half of a shape, from which smaller ones cut it off.

A part may have several centres, each of which floods. What they reach may lie apart: then
:func:`flood_parts` keeps the piece with the first of the part's centres that has reached anything,
one on each component of the graph, and a second flood from all that is kept takes the others.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.heap import push, sift
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray

Workspace: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, IntArray]


def workspace(n_centers: int, n_elements: int) -> Workspace:
    """Arrays for floods to work in: distances, whose they are, and the two of the queue.

    They are large enough for the system to take back and hand out anew each time, which would take
    longer than to fill them; so floods of the same points, one after the other, share them. Those
    of a poll differ in one centre or two: what the others are away from each element is known from
    the flood before, and so is which is nearest to each.
    """
    entries = n_centers * n_elements
    table, known = np.empty((n_centers, n_elements)), np.full((n_centers, 5), np.nan)
    return table, known, np.empty(entries), np.empty(entries, np.int64)


@kernel
def _fill(
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    distance: FloatArray,
    known: FloatArray,
) -> None:
    """Write weighted distances ||p - c|| / w, one row per centre, where they are not there yet.

    `known` has for each row of the table the centre and weight that it is of, and the point that is
    nearest; a row depends on these and the points alone.
    """
    n, size = centers.shape[0], points.shape[0]
    # Coordinates one after the other, and no division that could fail: then the compiler takes
    # several elements at a time.
    x, y, z = points[:, 0].copy(), points[:, 1].copy(), points[:, 2].copy()
    for i in range(n):
        cx, cy, cz, w = centers[i, 0], centers[i, 1], centers[i, 2], weights[i]
        if w == 0:
            raise ZeroDivisionError("a weight is 0")
        last = known[i]
        if last[0] == cx and last[1] == cy and last[2] == cz and last[3] == w:
            continue
        row = distance[i]
        for f in range(size):
            dx, dy, dz = x[f] - cx, y[f] - cy, z[f] - cz
            row[f] = np.sqrt(dx * dx + dy * dy + dz * dz) / w
        last[0], last[1], last[2], last[3] = cx, cy, cz, w
        last[4] = np.argmin(row)


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
    nearest, least = np.zeros(size, np.int32), distance[0].copy()
    for i in range(1, n):
        row = distance[i]
        for f in range(size):  # without branches, so that several elements are taken at a time
            d, best = row[f], least[f]
            known = np.int32(-1) if d == best else nearest[f]
            nearest[f] = np.int32(i) if d < best else known
            least[f] = d if d < best else best
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
    climbed: IntArray,
) -> int:
    """Label what rising paths through elements nearest to one centre reach from a start.

    `climbed` are the elements, the start first; returned is how many they are.
    """
    labels[start] = center
    climbed[0] = start
    count, done = 1, 0
    while done < count:
        f = climbed[done]
        done += 1
        for e in range(indptr[f], indptr[f + 1]):
            g = indices[e]
            if labels[g] < 0 and nearest[g] == center and distance[g] > distance[f]:
                labels[g] = center
                climbed[count] = g
                count += 1
    return count


@kernel
def _is_at_edge(f: int, indptr: Int32Array, indices: Int32Array, labels: Int32Array) -> bool:
    """Whether a neighbour of an element has no label."""
    found = False
    for e in range(indptr[f], indptr[f + 1]):
        found = found or labels[indices[e]] < 0
    return found


@kernel
def voronoi_labels(
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    labels: Int32Array,
    table: FloatArray,
    known: FloatArray,
) -> None:
    """Nearest weighted centre of each point, written into `labels`; ties to the lower centre."""
    distance = table[: centers.shape[0]]
    _fill(points, centers, weights, distance, known)
    for f in range(points.shape[0]):
        labels[f] = _nearest(distance, f)


@kernel
def _enclose(
    distance: FloatArray,
    nearest: Int32Array,
    region: IntArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
) -> None:
    """See who can get to what has no label, once all centres have been opened.

    A region is connected, and all around it has labels, which alone can get into it. A single one
    takes the region at once. Where there are more, `nearest` becomes the nearest of these.
    """
    n, size = distance.shape
    seen, comes = np.zeros(size, np.bool_), np.empty(n, np.bool_)
    who = np.empty(n, np.int64)
    for start in range(size):
        if labels[start] >= 0 or seen[start]:
            continue
        comes[:] = False
        seen[start] = True
        region[0] = start
        count, done = 1, 0
        while done < count:
            f = region[done]
            done += 1
            for e in range(indptr[f], indptr[f + 1]):
                g = indices[e]
                if labels[g] >= 0:
                    comes[labels[g]] = True
                elif not seen[g]:
                    seen[g] = True
                    region[count] = g
                    count += 1
        n_who = 0
        for i in range(n):
            if comes[i]:
                who[n_who] = i
                n_who += 1
        if n_who == 1:
            for k in range(count):
                labels[region[k]] = who[0]
        elif n_who > 1:
            for k in range(count):
                f = region[k]
                best, least, tie = who[0], distance[who[0], f], False
                for c in range(1, n_who):
                    d = distance[who[c], f]
                    tie = d == least or (tie and d > least)
                    if d < least:
                        best, least = who[c], d
                nearest[f] = -1 if tie else best


@kernel
def _flood(
    distance: FloatArray,
    nearest: Int32Array,
    climbed: IntArray,
    queued: BoolArray,
    key: FloatArray,
    code: IntArray,
    count: int,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
) -> None:
    """Let all that has a label flood what has none, and open the `count` entries queued before."""
    size = distance.shape[1]
    last_center, enclosed = -1.0, False
    for k in range(count):
        last_center = max(last_center, key[k])
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
        if not enclosed and key[0] > last_center:  # a centre not opened by now has no part
            enclosed = True
            _enclose(distance, nearest, climbed, indptr, indices, labels)
        i, f = divmod(int(code[0]), size)
        # The first neighbour queued takes the place of the entry that leaves: one walk down
        # the heap instead of two.
        vacant = True
        if labels[f] < 0:
            labels[f] = i
        if labels[f] == i:
            for e in range(indptr[f], indptr[f + 1]):
                start = indices[e]
                if labels[start] >= 0 or queued[i, start]:
                    continue
                found = 1
                climbed[0] = start
                climbs = nearest[start] == i and distance[i, start] > distance[i, f]
                if climbs:
                    found = _climb(start, i, distance[i], nearest, indptr, indices, labels, climbed)
                for k in range(found):
                    g = climbed[k]
                    if queued[i, g] or (climbs and not _is_at_edge(g, indptr, indices, labels)):
                        continue
                    queued[i, g] = True
                    if vacant:
                        sift(key, code, count, distance[i, g], i * size + g)
                        vacant = False
                    else:
                        count = push(key, code, count, distance[i, g], i * size + g)
        if vacant:
            count -= 1
            sift(key, code, count, key[count], code[count])


@kernel
def _floods(
    distance: FloatArray,
    known: FloatArray,
    key: FloatArray,
    code: IntArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
) -> Int32Array:
    """Algorithm 1 from a table of distances; -1 for an element that no flood reaches.

    Returned is the nearest centre of each element, -1 where two are equally near.
    """
    n, size = distance.shape
    nearest = _strictly_nearest(distance)
    queued = np.zeros((n, size), np.bool_)
    count = 0
    labels[:] = -1
    climbed = np.empty(size, np.int64)
    for i in range(n):
        f = int(known[i, 4])
        if nearest[f] == i:
            _climb(f, i, distance[i], nearest, indptr, indices, labels, climbed)
        else:
            queued[i, f] = True
            count = push(key, code, count, distance[i, f], i * size + f)
    _flood(distance, nearest, climbed, queued, key, code, count, indptr, indices, labels)
    return nearest


@kernel
def flood_labels(
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
    table: FloatArray,
    known: FloatArray,
    key: FloatArray,
    code: IntArray,
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
    table, known, key, code : (>= n, F), (>= n, 5), (>= nF,), (>= nF,)
        From :func:`workspace`; used for these points only.
    """
    distance = table[: centers.shape[0]]
    _fill(points, centers, weights, distance, known)
    _floods(distance, known, key, code, indptr, indices, labels)
    for f in range(points.shape[0]):
        if labels[f] < 0:
            labels[f] = _nearest(distance, f)


@kernel
def _lie_apart(
    parts: Int32Array,
    component: IntArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
) -> BoolArray:
    """(c,) whether what a centre has reached lies apart from a piece of an earlier centre.

    A piece is what centres of one part have reached together. It lies apart where another one of
    that part, on the same component, contains the cell of a centre that comes before all of its.
    """
    n, size = len(parts), len(labels)
    first = np.arange(n)  # the first centre of the piece, where it has been joined so far
    on = np.full(n, -1, np.int64)
    several = np.zeros(n, np.bool_)
    for i in range(1, n):
        if parts[i] == parts[i - 1]:
            several[i - 1], several[i] = True, True
    for f in range(size):
        i = labels[f]
        if i < 0 or not several[i]:
            continue
        on[i] = component[f]
        for e in range(indptr[f], indptr[f + 1]):
            j = labels[indices[e]]
            if j >= 0 and parts[j] == parts[i] and first[j] != first[i]:
                low, high = min(first[i], first[j]), max(first[i], first[j])
                for k in range(n):
                    if first[k] == high:
                        first[k] = low
    apart = np.zeros(n, np.bool_)
    for j in range(n):
        for i in range(j):
            same = on[i] >= 0 and on[i] == on[j] and parts[i] == parts[j]
            if same and first[i] != first[j] and first[i] == i and not apart[i]:
                apart[j] = True
    return apart


@kernel
def flood_parts(
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    parts: Int32Array,
    component: IntArray,
    indptr: Int32Array,
    indices: Int32Array,
    labels: Int32Array,
    table: FloatArray,
    known: FloatArray,
    key: FloatArray,
    code: IntArray,
) -> None:
    """Connected partition into parts of one or several centres, written into `labels`.

    Parameters
    ----------
    points : (F, 3) float
    centers : (c, 3) float
        In the same coordinates.
    weights : (c,) float, positive
    parts : (c,) int32
        The part of each centre, rising.
    component : (F,) int
        Which connected component of the graph each element is on.
    indptr, indices : (F + 1,), (E,) int32
        Adjacency in CSR form.
    labels : (F,) int32, written
        The part that each element belongs to.
    table, known, key, code : (>= c, F), (>= c, 5), (>= cF,), (>= cF,)
        From :func:`workspace`; used for these points only.
    """
    c, size = centers.shape[0], points.shape[0]
    distance = table[:c]
    _fill(points, centers, weights, distance, known)
    nearest = _floods(distance, known, key, code, indptr, indices, labels)
    apart = _lie_apart(parts, component, indptr, indices, labels)
    if apart.any():
        for f in range(size):
            if labels[f] >= 0 and apart[labels[f]]:
                labels[f] = -1
        climbed, queued = np.empty(size, np.int64), np.zeros((c, size), np.bool_)
        _flood(distance, nearest, climbed, queued, key, code, 0, indptr, indices, labels)
    for f in range(size):
        labels[f] = parts[labels[f] if labels[f] >= 0 else _nearest(distance, f)]
