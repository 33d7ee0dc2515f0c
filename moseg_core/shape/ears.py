"""Ear clipping (Meisters 1975), in bounded time.

An ear is a corner that turns left and whose triangle, with the corners beside it, holds no other
corner. The first in the order of the ring is cut, again and again. Where none is left (the polygon
crosses itself) the sharpest corner is cut, so that there are always as many triangles as corners
less two.

To look for the ear anew after each cut would take the cube of the number of corners where few are
ears. But a cut changes little: the triangles at the two corners beside it, and those that were
held to be no ears *because of* the corner that is gone. So each corner that is no ear remembers
one that its triangle holds, and is looked at again when that one is cut. What a triangle holds is
looked for along the ring and, of large polygons, in a grid of cells. In all that is some tens of
looks for a corner, some hundreds where polygons are all spikes; one that takes :data:`LOOKS` is
given up.

Corners are taken in the plane of the Newell normal, along the axis in which it is largest.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.heap import push, sift
from moseg_core.types import FloatArray, IntArray

LOOKS = 4000
"""How often other corners are looked at for each corner of a polygon, before it is given up."""

# The grid is asked in polygons of more corners than this, and behind so many along the ring.
_MANY = 512
_ALONG = 32


@kernel
def _turn(plane: FloatArray, i: int, j: int, k: int) -> float:
    """Twice the signed area of the triangle at three corners."""
    turn: float = (plane[j, 0] - plane[i, 0]) * (plane[k, 1] - plane[i, 1]) - (
        plane[j, 1] - plane[i, 1]
    ) * (plane[k, 0] - plane[i, 0])
    return turn


@kernel
def _same(plane: FloatArray, i: int, j: int) -> bool:
    same: bool = plane[i, 0] == plane[j, 0] and plane[i, 1] == plane[j, 1]
    return same


@kernel
def _flat(points: FloatArray) -> FloatArray:
    """(k, 2): a polygon seen from the side from which it runs counter-clockwise."""
    count = points.shape[0]
    normal = np.zeros(3)
    for i in range(count):
        j = i + 1 if i + 1 < count else 0
        for axis in range(3):
            b, c = (axis + 1) % 3, (axis + 2) % 3
            normal[axis] += points[i, b] * points[j, c] - points[i, c] * points[j, b]
    drop = int(np.argmax(np.abs(normal)))
    first, second = (1 if drop == 0 else 0), (1 if drop == 2 else 2)
    if (normal[drop] < 0) != (drop == 1):
        first, second = second, first
    plane = np.empty((count, 2))
    for i in range(count):
        plane[i, 0], plane[i, 1] = points[i, first], points[i, second]
    return plane


@kernel
def _convex(plane: FloatArray) -> bool:
    """Whether a polygon turns left at all corners, and not as a star that goes round twice."""
    count = plane.shape[0]
    total = 0.0
    for i in range(count):
        h = i - 1 if i > 0 else count - 1
        j = i + 1 if i + 1 < count else 0
        a, b = plane[i, 0] - plane[h, 0], plane[i, 1] - plane[h, 1]
        c, d = plane[j, 0] - plane[i, 0], plane[j, 1] - plane[i, 1]
        if not a * d - b * c > 0:
            return False
        total += (math.atan2(d, c) - math.atan2(b, a)) % (2.0 * math.pi)
    return total < 3.0 * math.pi


@kernel
def _holds(plane: FloatArray, a: int, i: int, c: int, p: int) -> bool:
    """Whether a corner lies in or on the triangle of three, and not in the place of one of them."""
    return (
        _turn(plane, a, i, p) >= 0
        and _turn(plane, i, c, p) >= 0
        and _turn(plane, c, a, p) >= 0
        and not (_same(plane, p, a) or _same(plane, p, i) or _same(plane, p, c))
    )


@kernel
def _cells(plane: FloatArray, side: int) -> tuple[FloatArray, IntArray, IntArray, IntArray]:
    """A grid over a polygon, of `side` times `side` cells, numbered row by row.

    Returns
    -------
    frame : (4,) float
        The least coordinates, and how many cells there are to a unit of length.
    starts, sizes : (side**2,) int
        Where the corners of each cell begin, and how many there are.
    items : (k,) int
        Corners, cell by cell.
    """
    frame = np.empty(4)
    for axis in range(2):
        low, high = plane[:, axis].min(), plane[:, axis].max()
        frame[axis] = low
        frame[2 + axis] = side / (high - low) if high > low else 0.0
    if side == 0:
        none = np.empty(0, np.int64)
        return frame, none, none, none
    sizes = np.zeros(side * side, np.int64)
    cell = np.empty(plane.shape[0], np.int64)
    for i in range(plane.shape[0]):
        cell[i] = _row(frame, 0, side, plane[i, 0]) * side + _row(frame, 1, side, plane[i, 1])
        sizes[cell[i]] += 1
    starts = np.cumsum(sizes) - sizes
    sizes[:] = 0
    items = np.empty(plane.shape[0], np.int64)
    for i in range(plane.shape[0]):
        items[starts[cell[i]] + sizes[cell[i]]] = i
        sizes[cell[i]] += 1
    return frame, starts, sizes, items


@kernel
def _row(frame: FloatArray, axis: int, side: int, x: float) -> int:
    """Which row of cells a coordinate is in."""
    return min(max(int((x - frame[axis]) * frame[2 + axis]), 0), side - 1)


@kernel
def _held(
    plane: FloatArray,
    i: int,
    before: IntArray,
    after: IntArray,
    left: int,
    side: int,
    frame: FloatArray,
    starts: IntArray,
    sizes: IntArray,
    items: IntArray,
) -> tuple[int, int]:
    """Another corner in or on the triangle at corner `i`, -1 for none; and how many were looked at.

    Corners in the places of the triangle's own are none.
    """
    a, c = before[i], after[i]
    p = after[c]
    along = left - 3 if side == 0 else min(_ALONG, left - 3)
    for k in range(along):
        if _holds(plane, a, i, c, p):
            return p, k + 1
        p = after[p]
    looks = along
    if side > 0:
        low0 = _row(frame, 0, side, min(plane[a, 0], plane[i, 0], plane[c, 0]))
        high0 = _row(frame, 0, side, max(plane[a, 0], plane[i, 0], plane[c, 0]))
        low1 = _row(frame, 1, side, min(plane[a, 1], plane[i, 1], plane[c, 1]))
        high1 = _row(frame, 1, side, max(plane[a, 1], plane[i, 1], plane[c, 1]))
        if (high0 - low0 + 1) * (high1 - low1 + 1) < left:
            for row in range(low0, high0 + 1):
                for cell in range(row * side + low1, row * side + high1 + 1):
                    looks += 1 + sizes[cell]
                    for k in range(starts[cell], starts[cell] + sizes[cell]):
                        p = items[k]
                        if p != a and p != i and p != c and _holds(plane, a, i, c, p):
                            return p, looks
            return -1, looks
    for k in range(along, left - 3):
        if _holds(plane, a, i, c, p):
            return p, k + 1
        p = after[p]
    return -1, left


@kernel
def _let_go(i: int, holder: IntArray, first: IntArray, behind: IntArray, ahead: IntArray) -> None:
    """Take corner `i` out of the list of those that wait for another to be cut."""
    held = holder[i]
    if held < 0:
        return
    if ahead[i] >= 0:
        behind[ahead[i]] = behind[i]
    else:
        first[held] = behind[i]
    if behind[i] >= 0:
        ahead[behind[i]] = ahead[i]
    holder[i] = -1


@kernel
def _cut(plane: FloatArray, triangles: IntArray) -> bool:
    """The triangles of one polygon that is not convex; whether they were found in time.

    Parameters
    ----------
    plane : (k, 2) float
    triangles : (k - 2, 3) int, written
        Numbers of corners.
    """
    count = plane.shape[0]
    before, after = np.arange(count) - 1, np.arange(count) + 1
    before[0], after[count - 1] = count - 1, 0
    there = np.ones(count, np.bool_)
    ear = np.zeros(count, np.bool_)
    turn = np.empty(count)
    # Which corner each waits for, and lists of those that wait for the same one.
    holder, first = np.full(count, -1), np.full(count, -1)
    behind, ahead = np.full(count, -1), np.full(count, -1)
    asked = np.empty(count + 2, np.int64)
    for i in range(count):
        turn[i] = _turn(plane, before[i], i, after[i])
        asked[i] = i
    n_asked = count
    side = int(math.sqrt(count)) if count > _MANY else 0
    frame, starts, sizes, items = _cells(plane, side)
    head, lowest, looks = 0, 0, 0
    # A heap of the corners by how sharp they are; made when it is first asked for.
    n_sharp = -1
    sharp, sharpest = np.empty(3 * count), np.empty(3 * count, np.int64)
    for t in range(count - 3):
        left = count - t
        for k in range(n_asked):
            i = asked[k]
            if not there[i]:
                continue
            _let_go(i, holder, first, behind, ahead)
            ear[i] = False
            if not turn[i] > 0:
                continue
            if looks > LOOKS * count:
                return False
            held, looked = _held(plane, i, before, after, left, side, frame, starts, sizes, items)
            looks += looked
            if held < 0:
                ear[i] = True
                lowest = min(lowest, i)
                continue
            holder[i], behind[i], ahead[i] = held, first[held], -1
            if first[held] >= 0:
                ahead[first[held]] = i
            first[held] = i
        while lowest < count and not ear[lowest]:
            lowest += 1
        i = lowest
        if i == count:  # no ear: the sharpest corner, of equal ones the first
            if n_sharp < 0:
                n_sharp = 0
                for k in range(count):
                    if there[k]:
                        n_sharp = push(sharp, sharpest, n_sharp, -turn[k], k)
            i = sharpest[0]
            while not there[i] or turn[i] != -sharp[0]:  # cut, or of another angle since
                n_sharp -= 1
                sift(sharp, sharpest, n_sharp, sharp[n_sharp], sharpest[n_sharp])
                i = sharpest[0]
        a, c = before[i], after[i]
        triangles[t, 0], triangles[t, 1], triangles[t, 2] = a, i, c
        _let_go(i, holder, first, behind, ahead)
        there[i], ear[i] = False, False
        if side > 0:
            cell = _row(frame, 0, side, plane[i, 0]) * side + _row(frame, 1, side, plane[i, 1])
            k = starts[cell]
            while items[k] != i:
                k += 1
            sizes[cell] -= 1
            items[k] = items[starts[cell] + sizes[cell]]
        after[a], before[c] = c, a
        if i == head:
            head = c
        turn[a], turn[c] = _turn(plane, before[a], a, c), _turn(plane, a, c, after[c])
        if n_sharp >= 0:
            n_sharp = push(sharp, sharpest, n_sharp, -turn[a], a)
            n_sharp = push(sharp, sharpest, n_sharp, -turn[c], c)
        asked[0], asked[1] = a, c
        n_asked = 2
        k = first[i]
        while k >= 0:
            if k != a and k != c:
                asked[n_asked] = k
                n_asked += 1
            k = behind[k]
    triangles[count - 3, 0] = head
    triangles[count - 3, 1] = after[head]
    triangles[count - 3, 2] = before[head]
    return True


@kernel
def cut_polygons(
    vertices: FloatArray,
    corners: IntArray,
    offsets: IntArray,
    chosen: IntArray,
    starts: IntArray,
    triangles: IntArray,
) -> int:
    """Cut some polygons of a mesh into triangles.

    Parameters
    ----------
    vertices : (V, 3) float
    corners : (C,) int
    offsets : (F + 1,) int
        As in :class:`moseg_core.shape.mesh.PolygonMesh`.
    chosen : (k,) int
        The polygons to cut, of four corners or more.
    starts : (F + 1,) int
        Where the triangles of each polygon begin.
    triangles : (T, 3) int, written
        Vertex indices.

    Returns
    -------
    int
        The first polygon that was given up; -1 where none was.
    """
    for f in chosen:
        begin, count = offsets[f], offsets[f + 1] - offsets[f]
        points = np.empty((count, 3))
        for i in range(count):
            for axis in range(3):
                # Far from the origin the sums over a polygon would drown in rounding.
                points[i, axis] = (
                    vertices[corners[begin + i], axis] - vertices[corners[begin], axis]
                )
        plane = _flat(points)
        own = triangles[starts[f] : starts[f] + count - 2]
        if _convex(plane):
            for t in range(count - 2):
                own[t, 0], own[t, 1], own[t, 2] = 0, t + 1, t + 2
        elif not _cut(plane, own):
            return int(f)
        for t in range(count - 2):
            for k in range(3):
                own[t, k] = corners[begin + own[t, k]]
    return -1
