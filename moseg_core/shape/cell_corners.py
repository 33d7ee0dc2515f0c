"""Corners of the cells of a grid, found without a table of eight numbers for each cell.

Of a grid with millions of cells such a table is most of what there is to keep, and nearly all that
is asked of it follows from the grid: which lattice points are corners of some cells, and which of
them can be corners of a convex hull. A lattice point between two others of the same cells, along an
axis of the grid or a diagonal, lies on the segment between them, and so is no corner of their hull.
Of a block of cells that leaves its own eight corners.

:class:`moseg_core.shape.voxels.VoxelGrid` makes its vertices and answers for its cells with these;
:mod:`moseg_core.shape.hull_corners` makes hulls from what is left.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.types import BoolArray, Int32Array, IntArray

#: Corner number k of a cell is at the bits of k.
_CORNERS = np.array([[k >> 2 & 1, k >> 1 & 1, k & 1] for k in range(8)])

#: Along an axis, and along a diagonal of a side or of a cell; each in one of its two senses.
_WAYS = tuple((i - 1, j - 1, k - 1) for i, j, k in np.ndindex(3, 3, 3) if (i, j, k) > (1, 1, 1))

_AT_ONCE = 1 << 18
NOTHING = -1
"""Stands where a cell is no element."""


def used_points(cells: BoolArray) -> BoolArray:
    """(nx + 1, ny + 1, nz + 1) bool: the lattice points that are corners of some cells.

    Parameters
    ----------
    cells : (nx, ny, nz) bool

    Examples
    --------
    >>> int(used_points(np.ones((1, 1, 2), bool)).sum())
    12
    """
    used = np.zeros([size + 1 for size in cells.shape], np.bool_)
    for corner in _CORNERS:
        window = tuple(slice(k, k + size) for k, size in zip(corner, cells.shape, strict=True))
        used[window] |= cells
    return used


def corner_numbers(cells: BoolArray) -> Iterator[IntArray]:
    """The eight corners of each cell in C order, by their numbers among the lattice points in use.

    Parameters
    ----------
    cells : (nx, ny, nz) bool

    Yields
    ------
    (k, 8) int
        Those of some hundred thousand cells, one stretch after the other.

    Examples
    --------
    >>> np.concatenate([*corner_numbers(np.ones((1, 1, 2), bool))])[1].tolist()
    [1, 2, 4, 5, 7, 8, 10, 11]
    """
    used = used_points(cells)
    number = np.cumsum(used.reshape(-1)) - 1
    weights = np.array([used.shape[1] * used.shape[2], used.shape[2], 1])
    places = np.flatnonzero(cells)
    for first in range(0, len(places), _AT_ONCE):
        some = np.unravel_index(places[first : first + _AT_ONCE], cells.shape)
        yield number[(np.stack(some, axis=1) @ weights)[:, None] + _CORNERS @ weights]


def outer_points(groups: Int32Array) -> tuple[IntArray, IntArray]:
    """Lattice points of groups of cells, without those between two others next to them.

    Parameters
    ----------
    groups : (nx, ny, nz) int32
        The group of each cell: from 0, :data:`NOTHING` where it is no element, less where it is
        one of no group.

    Returns
    -------
    group, number : (k,) int
        Pairs; a point's number is that among the corners of all elements, in C order. Points
        ascend.

    Examples
    --------
    Of two cells in a row, as one group and as two:

    >>> [outer_points(np.array([[row]], np.int32))[1].tolist() for row in ([0, 0], [0, 1])]
    [[0, 2, 3, 5, 6, 8, 9, 11], [0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8, 9, 10, 10, 11]]
    """
    padded = np.full([size + 4 for size in groups.shape], NOTHING, np.int32)
    padded[2:-2, 2:-2, 2:-2] = groups
    nothing = np.empty(0, np.int64)
    count = _find_outer(padded, nothing, nothing)
    group, number = np.empty((2, count), np.int64)
    _find_outer(padded, group, number)
    return group, number


@kernel
def _touches(padded: Int32Array, x: int, y: int, z: int, group: int) -> bool:
    """Whether a cell around a lattice point is of a group."""
    for i in range(2):
        for j in range(2):
            for k in range(2):
                if padded[x + i, y + j, z + k] == group:
                    return True
    return False


@kernel
def _find_outer(padded: Int32Array, group: IntArray, number: IntArray) -> int:
    """Count the pairs, and write them where there is room.

    The grid has two empty cells on each side: of each lattice point, and of its neighbours, the
    eight cells around it begin at its own index.
    """
    found, count = -1, 0
    around = np.empty(8, np.int32)
    for x in range(1, padded.shape[0] - 2):
        for y in range(1, padded.shape[1] - 2):
            for z in range(1, padded.shape[2] - 2):
                in_use, alike = False, True
                for c in range(8):
                    around[c] = padded[x + (c >> 2), y + (c >> 1 & 1), z + (c & 1)]
                    in_use = in_use or around[c] != NOTHING
                    alike = alike and around[c] == around[0]
                if not in_use:
                    continue
                found += 1
                if alike:
                    continue
                for c in range(8):
                    g = around[c]
                    known = g < 0
                    for earlier in range(c):
                        known = known or around[earlier] == g
                    for i, j, k in _WAYS:
                        if known:
                            break
                        known = _touches(padded, x - i, y - j, z - k, g) and _touches(
                            padded, x + i, y + j, z + k, g
                        )
                    if known:
                        continue
                    if count < len(group):
                        group[count], number[count] = g, found
                    count += 1
    return count
