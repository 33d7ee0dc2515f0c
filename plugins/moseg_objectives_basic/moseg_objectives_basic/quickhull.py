"""The volume of a convex hull, by Quickhull on a fine grid, where no sign is left to rounding.

C. B. Barber, D. P. Dobkin and H. Huhdanpaa, "The quickhull algorithm for convex hulls", 1996,
doi:10.1145/235815.235821, in three dimensions. A hull starts as a tetrahedron. Each point outside
is kept with one facet that it is in front of. The farthest in front of a facet becomes a corner:
the facets that it is in front of go, and facets from the rim of the hole to the corner come.

Where many points lie in one plane up to rounding, the rule on a mesh that was turned, rounding
decides at random which facets a point is in front of; a hull then folds over itself, is wrong by
much of its volume, and nothing tells. So the points are put on a grid of 2^29 cells along each
axis. Whether one is in front of a facet, the sign of a determinant, is then known exactly: from
floating-point numbers where these leave no doubt, else from whole ones of 64 bits. In a plane is
not in front.

With exact signs all that Quickhull needs holds. The facets that a corner is in front of are a disc,
and the rim is one loop, since no two points of them are in line with the corner. No facet lacks
area, since a corner in line with a side of the rim would be in the plane of the facet that goes
there. And a point that loses its facet but stays outside is in front of one that came: it was in
front of both facets at some side of the rim, and the plane of the one that came is between theirs.

The volume is that between the facets with the points where they were. It is exact unless points
are out of a plane by less than the grid's 2e-9, and then by less than that.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from moseg_core import kernel

Floats = npt.NDArray[np.float64]
Longs = npt.NDArray[np.int64]
Ints = npt.NDArray[np.int32]

#: Bits of a coordinate on the grid. Normals have two coordinates multiplied, in twice as many and
#: one; their upper and lower half times a coordinate, summed over three, stay below 63.
_BITS = 29

_LOW = (1 << 30) - 1

#: Determinants are of up to 2^88, and floating-point numbers wrong by up to 2^40.
_SURE = float(1 << 42)

#: No point, no facet.
_NONE = -1


def quickhull_volume(points: Floats) -> float:
    """Volume of the convex hull of points that fill a unit cube.

    Parameters
    ----------
    points : (n, 3) float
        They span 1 in each coordinate.

    Returns
    -------
    float
        0 for points in a plane of the grid.

    Examples
    --------
    >>> cube = np.array([[x, y, z] for x in (0.0, 1) for y in (0, 1) for z in (0, 1)])
    >>> quickhull_volume(cube)
    1.0
    """
    return _volume(np.ascontiguousarray(points))


@kernel
def _in_front(
    facet: int, p: int, grid: Floats, corners: Ints, normals: Longs, planes: Floats
) -> float:
    """Six times the volume that a point spans with a facet, negative behind it; its sign exact."""
    x, y, z = grid[p, 0], grid[p, 1], grid[p, 2]
    rough: float = (
        planes[facet, 0] * x + planes[facet, 1] * y + planes[facet, 2] * z - planes[facet, 3]
    )
    if abs(rough) > _SURE:
        return rough
    a = corners[facet, 0]
    i, j, k = np.int64(x - grid[a, 0]), np.int64(y - grid[a, 1]), np.int64(z - grid[a, 2])
    u, v, w = normals[facet, 0], normals[facet, 1], normals[facet, 2]
    low = (u & _LOW) * i + (v & _LOW) * j + (w & _LOW) * k
    high = (u >> 30) * i + (v >> 30) * j + (w >> 30) * k + (low >> 30)
    return float(high) * float(_LOW + 1) + float(low & _LOW)


@kernel
def _place(
    facet: int, a: int, b: int, c: int, grid: Floats, corners: Ints, normals: Longs, planes: Floats
) -> None:
    """Write down a facet: its corners, anticlockwise from outside, and its plane.

    The plane is a normal, twice the facet's area long, and the offset that goes with it.
    """
    corners[facet, 0], corners[facet, 1], corners[facet, 2] = a, b, c
    x1, x2 = np.int64(grid[b, 0] - grid[a, 0]), np.int64(grid[c, 0] - grid[a, 0])
    y1, y2 = np.int64(grid[b, 1] - grid[a, 1]), np.int64(grid[c, 1] - grid[a, 1])
    z1, z2 = np.int64(grid[b, 2] - grid[a, 2]), np.int64(grid[c, 2] - grid[a, 2])
    normals[facet, 0] = y1 * z2 - z1 * y2
    normals[facet, 1] = z1 * x2 - x1 * z2
    normals[facet, 2] = x1 * y2 - y1 * x2
    offset = 0.0
    for k in range(3):
        planes[facet, k] = normals[facet, k]
        offset += planes[facet, k] * grid[a, k]
    planes[facet, 3] = offset


@kernel
def _begin(grid: Floats, corners: Ints, beside: Ints, normals: Longs, planes: Floats) -> bool:
    """Write down a tetrahedron; False where the points are in a plane."""
    a, b, c, d = 0, 0, 0, 0
    for p in range(len(grid)):
        a = p if grid[p, 0] < grid[a, 0] else a
        b = p if grid[p, 0] > grid[b, 0] else b
    most = -1.0
    for p in range(len(grid)):  # the greatest triangle with these two
        _place(0, a, b, p, grid, corners, normals, planes)
        square = planes[0, 0] ** 2 + planes[0, 1] ** 2 + planes[0, 2] ** 2
        if square > most:
            c, most = p, square
    _place(0, a, b, c, grid, corners, normals, planes)
    most = -1.0
    for p in range(len(grid)):
        volume = abs(_in_front(0, p, grid, corners, normals, planes))
        if volume > most:
            d, most = p, volume
    if not most > 0.0:
        return False
    if _in_front(0, d, grid, corners, normals, planes) > 0.0:
        b, c = c, b
    for k in range(4):
        _place(k, a, b, c, grid, corners, normals, planes)
        beside[k, 0], beside[k, 1], beside[k, 2] = (k + 1) % 3 + 1, k % 3 + 1, 0
        # The base, then in turn a d b, b d c and c d a, next to those before and after them.
        a, b, c = (a, d, b) if k == 0 else (c, d, corners[0, (k + 1) % 3])
    beside[0, 0], beside[0, 1], beside[0, 2] = 1, 2, 3
    return True


@kernel
def _share_out(
    p: int,
    facets: Ints,
    n_facets: int,
    grid: Floats,
    corners: Ints,
    normals: Longs,
    planes: Floats,
    first: Ints,
    following: Ints,
    farthest: Ints,
    most: Floats,
) -> None:
    """Put all points of a list on those of some facets that they are in front of, if of any."""
    while p != _NONE:
        later = following[p]
        for i in range(n_facets):
            facet = facets[i]
            volume = _in_front(facet, p, grid, corners, normals, planes)
            if volume > 0.0:
                following[p], first[facet] = first[facet], p
                if volume > most[facet]:
                    farthest[facet], most[facet] = p, volume
                break
        p = later


@kernel
def _volume(points: Floats) -> float:
    """Volume of the hull, 0 for points in a plane."""
    n = len(points)
    grid = np.empty((n, 3))  # whole numbers, for which floating-point ones have room
    for k in range(3):
        least = np.inf
        for p in range(n):
            least = min(least, points[p, k])
        for p in range(n):
            grid[p, k] = np.rint((points[p, k] - least) * ((1 << _BITS) - 1))
    room = 4 * n  # there are 2 n - 4 facets at most, and for a while as many that replace them
    corners, beside = np.empty((room, 3), np.int32), np.empty((room, 3), np.int32)
    normals, planes = np.empty((room, 3), np.int64), np.empty((room, 4))
    if n < 4 or not _begin(grid, corners, beside, normals, planes):
        return 0.0
    # The points that are kept with a facet: the first, after each the next, and the farthest.
    first, following = np.empty(room, np.int32), np.empty(n, np.int32)
    farthest, most = np.empty(room, np.int32), np.empty(room)
    new, n_new, n_facets = np.empty(room, np.int32), 4, 4
    for p in range(n):
        following[p] = p + 1 if p + 1 < n else _NONE
    for i in range(4):
        new[i], first[i], most[i] = i, _NONE, 0.0
    _share_out(0, new, n_new, grid, corners, normals, planes, first, following, farthest, most)
    # Facets with points take turns, so that the hull grows on all sides.
    waiting, turn, n_waiting = np.empty(room, np.int32), 0, 0
    waits = np.empty(room, np.bool_)
    unused, n_unused = np.empty(room, np.int32), 0
    hidden, seen_for = np.empty(room, np.int32), np.empty(room, np.int32)
    for i in range(room):
        waits[i], seen_for[i] = False, _NONE
    rim = np.empty((room, 3), np.int32)  # the ends of each side, and the facet beyond it
    begins = np.empty(n, np.int32)  # the new facet whose side on the rim begins at a corner
    while True:
        for i in range(n_new):
            if first[new[i]] != _NONE and not waits[new[i]]:
                waiting[(turn + n_waiting) % room], waits[new[i]] = new[i], True
                n_waiting += 1
        if n_waiting == 0:
            break
        start = waiting[turn]
        turn, n_waiting, waits[start] = (turn + 1) % room, n_waiting - 1, False
        n_new = 0
        if first[start] == _NONE:
            continue
        # The point becomes a corner, and hides the facets that it is in front of. It is then on a
        # list no more, as it is in front of none that come.
        corner = farthest[start]
        hidden[0], seen_for[start], n_hidden, n_rim, i = start, corner, 1, 0, 0
        while i < n_hidden:
            facet = hidden[i]
            i += 1
            for k in range(3):
                other = beside[facet, k]
                if seen_for[other] == corner:
                    continue
                if _in_front(other, corner, grid, corners, normals, planes) > 0.0:
                    hidden[n_hidden], seen_for[other] = other, corner
                    n_hidden += 1
                else:
                    rim[n_rim, 0], rim[n_rim, 1] = corners[facet, k], corners[facet, (k + 1) % 3]
                    rim[n_rim, 2] = other
                    n_rim += 1
        for i in range(n_rim):
            a, b, other = rim[i, 0], rim[i, 1], rim[i, 2]
            if n_unused:
                n_unused -= 1
                facet = unused[n_unused]
            else:
                facet = n_facets
                n_facets += 1
            _place(facet, a, b, corner, grid, corners, normals, planes)
            new[i], begins[a], first[facet], most[facet] = facet, facet, _NONE, 0.0
            beside[facet, 0], seen_for[facet] = other, _NONE
            for k in range(3):
                if corners[other, k] == b:
                    beside[other, k] = facet
        n_new = n_rim
        for i in range(n_rim):
            facet, after = new[i], begins[rim[i, 1]]
            beside[facet, 1], beside[after, 2] = after, facet
        for i in range(n_hidden):
            facet = hidden[i]
            _share_out(
                first[facet],
                new,
                n_new,
                grid,
                corners,
                normals,
                planes,
                first,
                following,
                farthest,
                most,
            )
            first[facet], corners[facet, 0] = _NONE, _NONE
            unused[n_unused] = facet
            n_unused += 1
    total = 0.0
    for facet in range(n_facets):
        if corners[facet, 0] != _NONE:
            total += _spanned(points, corners[facet, 0], corners[facet, 1], corners[facet, 2])
    return total / 6.0


@kernel
def _spanned(points: Floats, a: int, b: int, c: int) -> float:
    """Six times the volume that the first point spans with three others, where it was."""
    x0, y0, z0 = points[0, 0], points[0, 1], points[0, 2]
    x1, y1, z1 = points[a, 0] - x0, points[a, 1] - y0, points[a, 2] - z0
    x2, y2, z2 = points[b, 0] - x0, points[b, 1] - y0, points[b, 2] - z0
    x3, y3, z3 = points[c, 0] - x0, points[c, 1] - y0, points[c, 2] - z0
    volume: float = x1 * (y2 * z3 - z2 * y3) + y1 * (z2 * x3 - x2 * z3) + z1 * (x2 * y3 - y2 * x3)
    return volume
