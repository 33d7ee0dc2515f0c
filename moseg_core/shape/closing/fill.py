"""What fills a rim: triangles over its vertices, of the least area together.

Rims follow the edges of a mesh and lie in no plane. Of all ways to cut a loop of n points into
n - 2 triangles, the one of the least total area is found by dynamic programming (Barequet and
Sharir 1995, "Filling gaps in the boundary of a polyhedron", doi:10.1016/0167-8396(94)00011-G):
what is best between two points of the loop is one triangle and the best on either side of it. A
loop in a plane is cut without overlaps, as these would add area, whatever its outline. What is
equal then is decided by the lengths of edges; triangles without area are avoided.

A new edge where the surface has one already, or another cap, would have four faces. Such edges are
barred. Where a loop cannot be filled without one, it is filled from a new point in its middle, and
very long loops, for which the time grows with the cube, are clipped ear by ear
(:mod:`moseg_core.shape.triangulate`).

A cap with holes is one loop: a bridge leads from a hole to the next loop and back.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.triangulate import clip_ears
from moseg_core.types import BoolArray, FloatArray, IntArray

#: Points of a loop up to which the least area is looked for; that takes about a second.
LONGEST = 500

#: What squared lengths count beside areas: no more than to decide between areas that are equal.
_LENGTHS = 1e-5

#: Triangles with less area, in units of their longest edge squared, count as if they had as much
#: area as a square over that edge.
_SLIVER = 1e-6


def bridged(
    vertices: FloatArray, rings: Sequence[IntArray], barred: set[tuple[int, int]]
) -> IntArray:
    """One loop out of several: a ring and the holes in it, joined by bridges.

    Parameters
    ----------
    vertices : (V, 3) float
    rings : sequence of (k,) int
        Vertices; holes run the other way around than the first.
    barred : set of (int, int)
        Pairs of vertices, the lower one first, that no bridge may join; bridges are added.

    Returns
    -------
    (m,) int
        Ends of bridges occur twice.

    Examples
    --------
    >>> frame = np.array([[0.0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0],
    ...                   [1, 1, 0], [1, 2, 0], [2, 2, 0], [2, 1, 0]])
    >>> bridged(frame, [np.arange(4), np.arange(4, 8)], set()).tolist()
    [0, 4, 5, 6, 7, 4, 0, 1, 2, 3]
    """
    loop, rest = rings[0], list(rings[1:])
    while rest:
        best = (np.inf, 0, 0, 0)
        for number, hole in enumerate(rest):
            apart = np.linalg.norm(vertices[loop][:, None] - vertices[hole], axis=2)
            for i, j in _barred_places(loop, hole, barred):
                apart[i, j] = np.inf
            i, j = divmod(int(apart.argmin()), len(hole))
            best = min(best, (float(apart[i, j]), number, i, j))
        _, number, i, j = best
        hole = rest.pop(number)
        barred.add(_pair(int(loop[i]), int(hole[j])))
        loop = np.concatenate([loop[: i + 1], hole[j:], hole[: j + 1], loop[i:]])
    return loop


def fill(vertices: FloatArray, loop: IntArray, barred: set[tuple[int, int]]) -> IntArray | None:
    """Cut a loop into triangles over its vertices.

    Parameters
    ----------
    vertices : (V, 3) float
    loop : (k,) int
        Vertices; in the direction of the triangles.
    barred : set of (int, int)
        Pairs of vertices, the lower one first, that no new edge may join.

    Returns
    -------
    (k - 2, 3) int or None
        None where it cannot be done without such an edge.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> fill(square, np.arange(4), {(0, 2)}).tolist()
    [[0, 1, 3], [1, 2, 3]]
    >>> fill(square, np.arange(4), {(0, 2), (1, 3)}) is None
    True
    """
    points = vertices[loop]
    points = points - points.mean(axis=0)
    size = np.abs(points).max()
    if size > 0:
        points = points / size
    count = len(loop)
    if count > LONGEST:
        triangles = loop[clip_ears(points)]
        return None if _any_barred(loop, triangles, barred) else triangles
    closed = np.zeros((count, count), np.bool_)
    for i, j in _barred_places(loop, loop, barred):
        closed[i, j] = closed[j, i] = True
    closed |= loop[:, None] == loop  # ends of a bridge, twice
    closed[0, -1] = False
    apex = np.zeros((count, count), np.int64)
    cost = np.zeros((count, count))
    least_area(points, closed, cost, apex)
    if not np.isfinite(cost[0, -1]):
        return None
    found, pending = [], [(0, count - 1)]
    while pending:
        i, k = pending.pop()
        if k - i > 1:
            j = int(apex[i, k])
            found.append((i, j, k))
            pending += [(j, k), (i, j)]
    triangles = loop[np.array(found)]
    # Next to a bridge an edge may come twice all the same.
    return None if len(loop) > len(set(loop.tolist())) and _twice(triangles) else triangles


def edges_of(triangles: IntArray) -> set[tuple[int, int]]:
    """The edges of some triangles, each with the lower vertex first.

    Examples
    --------
    >>> sorted(edges_of(np.array([[2, 0, 1]])))
    [(0, 1), (0, 2), (1, 2)]
    """
    ends = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    return set(map(tuple, ends.tolist()))


def _twice(triangles: IntArray) -> bool:
    """Whether any edge has more than two triangles."""
    ends = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    return bool(np.unique(ends, axis=0, return_counts=True)[1].max() > 2)


def _any_barred(loop: IntArray, triangles: IntArray, barred: set[tuple[int, int]]) -> bool:
    """Whether any triangle has an edge that is barred, or that another one has twice."""
    rim = {_pair(a, b) for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True)}
    return bool((edges_of(triangles) - rim) & barred) or _twice(triangles)


def _pair(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)


def _barred_places(
    first: IntArray, second: IntArray, barred: set[tuple[int, int]]
) -> list[tuple[int, int]]:
    """Places in two loops whose vertices may not be joined."""
    here: dict[int, list[int]] = {}
    there: dict[int, list[int]] = {}
    for places, loop in ((here, first), (there, second)):
        for place, vertex in enumerate(loop.tolist()):
            places.setdefault(vertex, []).append(place)
    found = []
    for low, high in barred:
        for a, b in ((low, high), (high, low)):
            if a in here and b in there:
                found += [(i, j) for i in here[a] for j in there[b]]
    return found


@kernel
def least_area(points: FloatArray, closed: BoolArray, cost: FloatArray, apex: IntArray) -> None:
    """The least cost to fill each stretch of a loop, and the triangle that does it.

    Parameters
    ----------
    points : (n, 3) float
    closed : (n, n) bool
        Pairs of points that no edge may join.
    cost : (n, n) float, written
        ``cost[i, k]`` is that of the stretch from `i` to `k`, and the same at ``[k, i]``; infinite
        where it cannot be filled. 0 before.
    apex : (n, n) int, written
        The third corner of the triangle over ``(i, k)``.
    """
    count = points.shape[0]
    for gap in range(2, count):
        for i in range(count - gap):
            k = i + gap
            best = np.inf
            if not closed[i, k]:
                ux = points[k, 0] - points[i, 0]
                uy = points[k, 1] - points[i, 1]
                uz = points[k, 2] - points[i, 2]
                base = ux * ux + uy * uy + uz * uz
                for j in range(i + 1, k):
                    # Both along rows, of which the lower half mirrors the upper.
                    both = cost[i, j] + cost[k, j]
                    if both >= best:
                        continue
                    vx = points[j, 0] - points[i, 0]
                    vy = points[j, 1] - points[i, 1]
                    vz = points[j, 2] - points[i, 2]
                    wx, wy, wz = ux - vx, uy - vy, uz - vz
                    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
                    left = vx * vx + vy * vy + vz * vz
                    right = wx * wx + wy * wy + wz * wz
                    area = 0.5 * np.sqrt(nx * nx + ny * ny + nz * nz)
                    longest = max(base, left, right)
                    total = both + area + _LENGTHS * (base + left + right)
                    if area <= _SLIVER * longest:
                        total += longest
                    if total < best:
                        best = total
                        apex[i, k] = j
            cost[i, k] = best
            cost[k, i] = best
