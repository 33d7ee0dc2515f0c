"""Which vertices are at one position: equal ones, and those nearer than a tolerance.

Corners of a mesh are joined by position (:mod:`moseg_core.shape.mesh`). Programs write a
coordinate as 0 in one triangle and as 1e-17 in the next, or round it twice, so that equality
alone tears a surface. Here vertices are at one position when they are equal, or when they are at
most `tolerance` from one that stands for the position.

Nearness is not transitive: along a chain of vertices, each near to the next, a whole edge would
shrink to one position. So vertices are gone through in order, and each either joins the nearest
of those that stand for a position so far, or stands for a new one. Positions are then further
than the tolerance apart, no vertex is further than that from its own, and equal input gives
equal output. Memory and time grow with the number of vertices, whatever lies where: the ones that
stand for positions are kept in a grid of cells, of which each holds a bounded number.

Numbers of positions ascend with x, then y, then z, as ``numpy.unique`` gives them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.shape.compiled import kernel
from moseg_core.types import FloatArray, IntArray

WELD = 1e-8
"""How near vertices are joined unless the user says otherwise: a share of the diagonal."""

# Cells further than this from the origin have no number in 64 bits. With a tolerance of 1e-8 that
# is where coordinates have lost the digits to tell near from far.
_FARTHEST_CELL = 1e18
# A cell's side in tolerances. Larger ones hold more positions, smaller ones are straddled more.
_CELL = 8.0


@dataclass(frozen=True, eq=False)
class Positions:
    """Which vertices are at one position.

    Parameters
    ----------
    number : (V,) int
        For each vertex the number of its position: from 0, without gaps, in the order of the
        positions' coordinates.
    n_near : int
        How many different places were joined with another because they are near.
    """

    number: IntArray
    n_near: int


def find_positions(points: FloatArray, tolerance: float = 0.0) -> Positions:
    """For each vertex the number of its position.

    Parameters
    ----------
    points : (V, 3) float, model units
        Finite.
    tolerance : float, model units
        How far a vertex may be from the one that stands for its position; 0 joins equal ones.

    Examples
    --------
    >>> line = np.array([[2.0, 0, 0], [0, 0, 0], [1e-9, 0, 0], [-0.0, 0, 0]])
    >>> find_positions(line).number.tolist(), find_positions(line, 1e-8).number.tolist()
    ([2, 0, 1, 0], [1, 0, 0, 0])
    """
    points = points + 0.0  # turns -0.0 into 0.0, which compare equal but differ in their bits
    first, group = _distinct_rows(
        np.ascontiguousarray(points).view(np.uint64), _buckets(len(points))
    )
    places, n_near = points[first], 0
    if tolerance > 0.0:
        stand_in = _stand_ins(places, tolerance, _CELL * tolerance, _buckets(len(places)))
        apart = np.flatnonzero(stand_in == np.arange(len(places)))
        n_near = len(places) - len(apart)
        if n_near:
            group, places = np.searchsorted(apart, stand_in)[group], places[apart]
    order = np.lexsort(places.T[::-1])
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return Positions(rank[group], n_near)


def _buckets(count: int) -> npt.NDArray[np.int64]:
    """Empty buckets of a hash table, a power of two and at least twice as many as items."""
    return np.full(1 << (2 * max(count, 1) - 1).bit_length(), -1, np.int64)


@kernel
def _mixed(a: Any, b: Any, c: Any) -> Any:
    """A hash of three integers of 64 bits: multiplications by odd numbers, high bits folded in."""
    mixed = a * np.uint64(0x9E3779B97F4A7C15)
    mixed = (mixed ^ (mixed >> np.uint64(29)) ^ b) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(32)) ^ c) * np.uint64(0x94D049BB133111EB)
    return mixed ^ (mixed >> np.uint64(31))


@kernel
def _distinct_rows(bits: Any, head: Any) -> Any:
    """Of rows that differ the first of each, ascending; and for each row its place among them.

    A hash table with chains; rows of one bucket are compared themselves.
    """
    mask = np.uint64(len(head) - 1)
    following = np.empty(len(bits), np.int64)
    first = np.empty(len(bits), np.int64)
    group = np.empty(len(bits), np.int64)
    count = 0
    for row in range(len(bits)):
        a, b, c = bits[row, 0], bits[row, 1], bits[row, 2]
        bucket = np.int64(_mixed(a, b, c) & mask)
        found = head[bucket]
        while found >= 0:
            other = first[found]
            if bits[other, 0] == a and bits[other, 1] == b and bits[other, 2] == c:
                break
            found = following[found]
        if found < 0:
            found = count
            first[found] = row
            following[found] = head[bucket]
            head[bucket] = found
            count += 1
        group[row] = found
    return first[:count].copy(), group


@kernel
def _stand_ins(places: Any, tolerance: Any, side: Any, head: Any) -> Any:
    """For each place the one that stands for its position; for some the place itself.

    Looked into are all cells that the ball around a place reaches.
    """
    mask = np.uint64(len(head) - 1)
    following = np.full(len(places), -1, np.int64)
    stand_in = np.empty(len(places), np.int64)
    for row in range(len(places)):
        x, y, z = places[row, 0], places[row, 1], places[row, 2]
        if max(abs(x), abs(y), abs(z)) >= _FARTHEST_CELL * side:
            stand_in[row] = row
            continue
        nearest, found = tolerance, -1
        for i in range(math.floor((x - tolerance) / side), math.floor((x + tolerance) / side) + 1):
            for j in range(
                math.floor((y - tolerance) / side), math.floor((y + tolerance) / side) + 1
            ):
                for k in range(
                    math.floor((z - tolerance) / side), math.floor((z + tolerance) / side) + 1
                ):
                    bucket = np.int64(_mixed(np.uint64(i), np.uint64(j), np.uint64(k)) & mask)
                    other = head[bucket]
                    while other >= 0:
                        u, v, w = places[other, 0] - x, places[other, 1] - y, places[other, 2] - z
                        distance = math.sqrt(u * u + v * v + w * w)
                        if distance < nearest or (
                            distance == nearest and (found < 0 or other < found)
                        ):
                            nearest, found = distance, other
                        other = following[other]
        if found < 0:
            i = math.floor(x / side)
            j = math.floor(y / side)
            k = math.floor(z / side)
            bucket = np.int64(_mixed(np.uint64(i), np.uint64(j), np.uint64(k)) & mask)
            following[row] = head[bucket]
            head[bucket] = row
            found = row
        stand_in[row] = found
    return stand_in
