"""Corners of the convex hulls of super-elements, from which the hull of any part follows.

The convex hull of a union is the convex hull of the union of the hulls' corners. So the hull of a
part of a coarse shape needs no vertices but the hull corners of its super-elements, which are found
once for the shape: a vertex inside of the hull of its super-element is a corner of no part's hull.
The same holds for blocks of super-elements that are in the part as a whole, for blocks of blocks,
and so forth. Hull volumes and bounding boxes of coarse parts
(:attr:`moseg_core.components.part.Part.extreme_vertices`) are then those of all vertices, up to
rounding, at the price of a fraction of them.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.row_threads import over_rows
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen

#: Groups in a block.
_BLOCK = 8
#: About how long it takes to find a hull.
_SECONDS = 2e-4


@dataclass(frozen=True, eq=False, kw_only=True)
class HullCorners:
    """The corners of the convex hull of each group of elements.

    Parameters
    ----------
    vertices : (k,) int
        Numbers of vertices, those of one group after those of another; one that several groups
        touch comes several times.
    starts : (K + 1,) int
        Where each group's begin.
    distinct : (m,) int
        The vertices of all groups, ascending, each once.
    blocks : (K,) int
        Which block of groups near each other each group belongs to.
    of_blocks : HullCorners or None
        The same for the blocks, as groups; None where there is only one.
    """

    vertices: IntArray
    starts: IntArray
    distinct: IntArray
    blocks: IntArray
    of_blocks: HullCorners | None

    def of(self, groups: IntArray) -> IntArray:
        """(m,) int: the vertices of some groups, ascending, each once."""
        marked: BoolArray = np.zeros(len(self.distinct), np.bool_)
        level: HullCorners | None = self
        while level is not None:
            whole = np.zeros(0 if level.of_blocks is None else len(level._sizes), np.bool_)
            _mark(groups, level._places, level.starts, level.blocks, level._sizes, marked, whole)
            groups, level = np.flatnonzero(whole), level.of_blocks
        return self.distinct[marked]

    @cached_property
    def _places(self) -> IntArray:
        """(k,) int: where each of the vertices is among the distinct ones."""
        return np.searchsorted(self.distinct, self.vertices)

    @cached_property
    def _sizes(self) -> IntArray:
        """How many groups are in each block."""
        sizes: IntArray = np.bincount(self.blocks)
        return sizes


@kernel
def _mark(
    groups: IntArray,
    places: IntArray,
    starts: IntArray,
    blocks: IntArray,
    sizes: IntArray,
    marked: BoolArray,
    whole: BoolArray,
) -> None:
    """Mark which blocks are there as a whole, and the vertices of groups that are in none of them.

    `whole` is empty where no more is known of blocks than of their groups.
    """
    missing = sizes.copy()
    if len(whole):
        for g in groups:
            missing[blocks[g]] -= 1
        for block in range(len(whole)):
            whole[block] = missing[block] == 0
    for g in groups:
        if missing[blocks[g]]:
            for k in range(starts[g], starts[g + 1]):
                marked[places[k]] = True


def find_hull_corners(geometry: Geometry, members: IntArray, points: FloatArray) -> HullCorners:
    """The corners of the convex hull of each group of elements, and of blocks of such groups.

    Parameters
    ----------
    geometry : Geometry
    members : (F,) int
        The group of each element, 0 to K - 1, each at least once.
    points : (K, 3) float, model units
        Where each group is.

    Returns
    -------
    HullCorners
        All vertices of a group that lies in a plane, which has no hull to speak of.

    Examples
    --------
    A cube of eight corners and one vertex in the middle of a side, as one group:

    >>> import moseg_core as moseg
    >>> v = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)] + [[0, 0.5, 0.5]]
    >>> f = [[0, 1, 8], [1, 3, 8], [3, 2, 8], [2, 0, 8], [4, 6, 7, 5], [0, 4, 5, 1],
    ...      [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> shape = moseg.Shape.from_mesh(v, f)
    >>> find_hull_corners(shape.geometry, np.zeros(9, int), np.zeros((1, 3))).vertices.tolist()
    [0, 1, 2, 3, 4, 5, 6, 7]
    """
    return _hull_corners(geometry, *geometry.outer_corners(members), points)


def _hull_corners(
    geometry: Geometry,
    owner: IntArray,
    vertices: IntArray,
    points: FloatArray,
    distinct: IntArray | None = None,
) -> HullCorners:
    """The same from pairs of a group and a vertex, and so on for blocks, blocks of those, ..."""
    from scipy.spatial import cKDTree

    vertices, starts = _corners(geometry, owner, vertices)
    if distinct is None:
        used = np.zeros(len(geometry.vertices), np.bool_)
        used[vertices] = True
        distinct = frozen(np.flatnonzero(used))
    blocks = np.empty(len(points), np.int64)
    # Neighbours in the order of a tree's leaves are neighbours in space.
    blocks[cKDTree(points).indices] = np.arange(len(points)) // _BLOCK
    of_blocks = None
    if len(points) > _BLOCK:
        number = np.bincount(blocks)
        middle = np.stack([np.bincount(blocks, c) / number for c in points.T], axis=1)
        owner = np.repeat(blocks, np.diff(starts))
        of_blocks = _hull_corners(geometry, owner, vertices, middle, distinct)
    return HullCorners(
        vertices=vertices,
        starts=starts,
        distinct=distinct,
        blocks=frozen(blocks),
        of_blocks=of_blocks,
    )


def _corners(geometry: Geometry, owner: IntArray, vertices: IntArray) -> tuple[IntArray, IntArray]:
    """Corners of the hull of each owner's vertices, one owner after the other; where each begins.

    Parameters
    ----------
    geometry : Geometry
    owner, vertices : (k,) int
        Pairs in any order, maybe several times.
    """
    from scipy.spatial import ConvexHull, QhullError

    pairs = np.sort(owner * len(geometry.vertices) + vertices)
    pairs = pairs[np.diff(pairs, prepend=-1) > 0]  # np.unique takes twenty times as long
    owners, numbers = np.divmod(pairs, len(geometry.vertices))
    bounds = np.searchsorted(owners, np.arange(int(owners[-1]) + 2))
    kept = [numbers] * (len(bounds) - 1)

    def find(first: int, end: int) -> None:
        for k in range(first, end):
            mine = numbers[bounds[k] : bounds[k + 1]]
            if len(mine) > 4:
                corners = geometry.vertices[mine]
                with suppress(QhullError):  # a flat group keeps all
                    mine = np.sort(mine[ConvexHull(corners - corners.mean(axis=0)).vertices])
            kept[k] = mine

    over_rows(find, len(kept), seconds=_SECONDS * len(kept))
    starts = np.concatenate([[0], np.cumsum([len(mine) for mine in kept])])
    return frozen(np.concatenate(kept).astype(np.int64)), frozen(starts)
