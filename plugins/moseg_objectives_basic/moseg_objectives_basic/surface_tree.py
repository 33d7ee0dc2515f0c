"""Distances to a surface: a tree of boxes over its triangles, and the least of several images.

The triangles are put in the order of Morton codes (G. M. Morton, 1966): the numbers of the cell
that a triangle's middle is in, along x, y and z, their bits interlaced. What lies close together
is then close in the order, and where the first bit in which codes differ changes, space is halved.
Runs of triangles are halved there again and again (T. Karras, "Maximizing parallelism in the
construction of BVHs, octrees, and k-d trees", 2012, doi:10.2312/EGGH/HPG12/033-037). Such a tree
takes a fifth of the time that libigl's needs, so that none has to be kept from part to part, and
answers in half of it.

Distances are those of :mod:`moseg_objectives_basic.triangle_distance`. A triangle is left out only
where a box around it, or a disc, is further away than a triangle that was looked at; the nearest of
the last point is looked at first. On a fine mesh and from afar many boxes are about as near as the
nearest triangle, but few discs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core import kernel
from moseg_objectives_basic.triangle_distance import square, to_triangle

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]
Int32Array = npt.NDArray[np.int32]

#: Up to so many triangles are not halved any more.
_FEW = 8

#: Cells along each axis; the bits of three such numbers fit into an integer.
_CELLS = 2**21

#: Levels of a tree at most: as many as a code has bits, and one more. So many boxes wait at most.
_DEEPEST = 64

#: How far a triangle may be out of its disc by rounding, in radii of it.
_SLACK = 1e-9

#: So many points one after the other are a run, of which the first is looked at first.
_RUN = 16


@dataclass(frozen=True, eq=False)
class SurfaceTree:
    """A tree of boxes over triangles. Make one with :meth:`of`.

    Parameters
    ----------
    corners : (t, 3, 3) float, model units
        Of the triangles, in Morton order.
    discs : (t, 7) float
        Middle, unit normal and radius of a disc in which each triangle lies, in model units; the
        normal is 0 where it is a ball.
    nodes : (n, 3) int32
        Of each box the first triangle, the one after the last, and the number of the box of the
        first half; that of the second half is the next one. 0 where it is not halved.
    boxes : (n, 6) float, model units
        Least coordinates, then greatest.
    """

    corners: FloatArray
    discs: FloatArray
    nodes: Int32Array
    boxes: FloatArray

    @classmethod
    def of(cls, vertices: FloatArray, triangles: IntArray) -> SurfaceTree:
        """The tree over some triangles.

        Parameters
        ----------
        vertices : (v, 3) float, model units
        triangles : (t, 3) int
            They may lack area.

        Examples
        --------
        >>> corner = np.array([[0., 0, 0], [4, 0, 0], [0, 4, 0]])
        >>> tree = SurfaceTree.of(corner, np.array([[0, 1, 2]]))
        >>> tree.squared_distances(np.array([[1., 1, 3], [3, 3, 0]])).round(12).tolist()
        [9.0, 2.0]
        """
        corners = np.take(vertices, triangles, axis=0)
        codes = _morton_codes(corners)
        return cls(*_grow(corners, codes, np.argsort(codes)))

    def squared_distances(self, points: FloatArray) -> FloatArray:
        """(k,) float: squared distance of each point to the surface, model units squared.

        Infinite where there are no triangles.
        """
        squared = np.empty(len(points))
        self._add(points, np.ones(len(points)), _runs(points), (0, _RUN), 0.0, np.inf, squared)
        return squared

    def least_distances(self, images: Iterable[FloatArray], weights: FloatArray) -> FloatArray:
        """Squared distances to the surface of that of several images that comes closest to it.

        Parameters
        ----------
        images : iterable of (k, 3) float, model units
            The same points, moved in different ways. Those one after the other should be close
            together, so that one tells of the next.
        weights : (k,) float
            Not negative.

        Returns
        -------
        (k,) float, model units squared
            Of the image that has the least weighted sum of them.

        Examples
        --------
        >>> corner = np.array([[0., 0, 0], [4, 0, 0], [0, 4, 0]])
        >>> tree = SurfaceTree.of(corner, np.array([[0, 1, 2]]))
        >>> images = np.array([[[1., 1, 3]], [[3, 3, 0]]])
        >>> tree.least_distances(images, np.ones(1)).round(12).tolist()
        [2.0]
        """
        # One point of every run says which image is promising, and which runs are far away. The
        # others' sums are given up once they are past the least, with room for rounding, and
        # what is far away comes first. This leaves out most distances, and none that matter.
        begun = []
        for image in images:
            squared = np.empty(len(image))
            total = self._add(image, weights, _runs(image), (0, 1), 0.0, np.inf, squared)
            begun.append((total, image, squared))
        least, nearest = np.inf, np.empty(0)
        for total, image, squared in sorted(begun, key=lambda one: one[0]):
            runs = np.argsort(-(weights[::_RUN] * squared[::_RUN]), kind="stable")
            limit = least * (1.0 + 1e-6)
            if self._add(image, weights, runs, (1, _RUN), total, limit, squared) <= limit:
                total = float((weights * squared).sum())
                if total < least or not len(nearest):
                    least, nearest = total, squared
        return nearest

    def _add(
        self,
        points: FloatArray,
        weights: FloatArray,
        runs: IntArray,
        of_run: tuple[int, int],
        total: float,
        limit: float,
        squared: FloatArray,
    ) -> float:
        """Add weighted squared distances, written down as well, until the sum is past a limit.

        Of some runs in their order, in each from one of its points to before another.
        """
        tree = self.corners, self.discs, self.nodes, self.boxes
        points = np.ascontiguousarray(points)
        return _add_distances(*tree, points, weights, runs, *of_run, total, limit, squared)


def _runs(points: FloatArray) -> IntArray:
    """(r,) int: the numbers of all runs."""
    return np.arange(-(-len(points) // _RUN))


@kernel
def _morton_codes(corners: FloatArray) -> IntArray:
    """(t,) int: the interlaced numbers of the cell in a cube that each triangle's middle is in."""
    middles = np.empty((len(corners), 3))
    least, size = np.full(3, np.inf), 0.0
    for t in range(len(corners)):
        for k in range(3):
            middles[t, k] = corners[t, 0, k] + corners[t, 1, k] + corners[t, 2, k]
            least[k] = min(least[k], middles[t, k])
    for t in range(len(corners)):
        for k in range(3):
            size = max(size, middles[t, k] - least[k])
    per_length = (_CELLS - 1) / size if size > 0.0 else 0.0
    codes = np.zeros(len(corners), np.int64)
    for t in range(len(corners)):
        for k in range(3):
            # Twice as far apart each time, until two places are between one bit and the next.
            x = np.int64((middles[t, k] - least[k]) * per_length)
            x = (x | x << 32) & 0x1F00000000FFFF
            x = (x | x << 16) & 0x1F0000FF0000FF
            x = (x | x << 8) & 0x100F00F00F00F00F
            x = (x | x << 4) & 0x10C30C30C30C30C3
            x = (x | x << 2) & 0x1249249249249249
            codes[t] |= x << k
    return codes


@kernel
def _write_disc(corners: FloatArray, t: int, discs: FloatArray) -> None:
    """A disc in which a triangle lies; around a needle, whose plane is not known well, a ball."""
    for k in range(3):
        discs[t, k] = (corners[t, 0, k] + corners[t, 1, k] + corners[t, 2, k]) / 3.0
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        discs[t, 3 + k] = (corners[t, 1, i] - corners[t, 0, i]) * (
            corners[t, 2, j] - corners[t, 0, j]
        ) - (corners[t, 1, j] - corners[t, 0, j]) * (corners[t, 2, i] - corners[t, 0, i])
    length = np.sqrt(square(discs[t, 3], discs[t, 4], discs[t, 5]))
    reach, off = 0.0, 0.0
    for c in range(3):
        x, y, z = (
            corners[t, c, 0] - discs[t, 0],
            corners[t, c, 1] - discs[t, 1],
            corners[t, c, 2] - discs[t, 2],
        )
        reach = max(reach, square(x, y, z))
        off = max(off, abs(x * discs[t, 3] + y * discs[t, 4] + z * discs[t, 5]))
    discs[t, 6] = np.sqrt(reach) * (1.0 + _SLACK)
    for k in range(3, 6):
        discs[t, k] = discs[t, k] / length if off < _SLACK / 10.0 * discs[t, 6] * length else 0.0


@kernel
def _grow(
    corners: FloatArray, codes: IntArray, order: IntArray
) -> tuple[FloatArray, FloatArray, Int32Array, FloatArray]:
    """Triangles and their discs in order, nodes and boxes; see :class:`SurfaceTree`."""
    n = len(order)
    ordered, discs = np.empty((n, 3, 3)), np.zeros((n, 7))
    for t in range(n):
        for c in range(3):
            for k in range(3):
                ordered[t, c, k] = corners[order[t], c, k]
        _write_disc(ordered, t, discs)
    # Halves are numbered after all that came before: the boxes of both are side by side.
    nodes, n_nodes = np.zeros((max(2 * n, 1), 3), np.int32), 1
    nodes[0, 1], node = n, 0
    while node < n_nodes:
        first, last = int(nodes[node, 0]), int(nodes[node, 1])
        if last - first > _FEW and codes[order[first]] != codes[order[last - 1]]:
            differing, bit = codes[order[first]] ^ codes[order[last - 1]], 1
            while differing > 1:
                differing, bit = differing >> 1, bit << 1
            without, having = first, last - 1
            while having - without > 1:
                middle = (without + having) // 2
                if codes[order[middle]] & bit:
                    having = middle
                else:
                    without = middle
            nodes[node, 2] = n_nodes
            nodes[n_nodes, 0], nodes[n_nodes, 1] = first, having
            nodes[n_nodes + 1, 0], nodes[n_nodes + 1, 1] = having, last
            n_nodes += 2
        node += 1
    boxes = np.empty((n_nodes, 6))
    for node in range(n_nodes - 1, -1, -1):
        half = nodes[node, 2]
        for k in range(3):
            boxes[node, k], boxes[node, k + 3] = np.inf, -np.inf
        if half:
            for k in range(3):
                boxes[node, k] = min(boxes[half, k], boxes[half + 1, k])
                boxes[node, k + 3] = max(boxes[half, k + 3], boxes[half + 1, k + 3])
        else:
            for t in range(nodes[node, 0], nodes[node, 1]):
                for c in range(3):
                    for k in range(3):
                        boxes[node, k] = min(boxes[node, k], ordered[t, c, k])
                        boxes[node, k + 3] = max(boxes[node, k + 3], ordered[t, c, k])
    return ordered, discs, nodes[:n_nodes], boxes


@kernel
def _add_distances(
    corners: FloatArray,
    discs: FloatArray,
    nodes: Int32Array,
    boxes: FloatArray,
    points: FloatArray,
    weights: FloatArray,
    runs: IntArray,
    first: int,
    last: int,
    total: float,
    limit: float,
    squared: FloatArray,
) -> float:
    """See :meth:`SurfaceTree._add`."""
    waiting, away = np.empty(_DEEPEST, np.int64), np.empty(_DEEPEST)
    nearest = 0
    for run in runs:
        for p in range(run * _RUN + first, min(run * _RUN + last, len(points))):
            x, y, z = points[p, 0], points[p, 1], points[p, 2]
            least = np.inf
            if len(corners):
                least = to_triangle(x, y, z, corners, nearest)
            waiting[0], away[0], top = 0, 0.0, 0
            while top >= 0:
                node = waiting[top]
                top -= 1
                if away[top + 1] > least:
                    continue
                while nodes[node, 2]:  # down to the nearer half, the other one later
                    near = int(nodes[node, 2])
                    far = near + 1
                    to_near, to_far = _to_box(x, y, z, boxes, near), _to_box(x, y, z, boxes, far)
                    if to_far < to_near:
                        near, far, to_near, to_far = far, near, to_far, to_near
                    if to_far <= least:
                        top += 1
                        waiting[top], away[top] = far, to_far
                    node = near
                    if to_near > least:
                        break
                else:
                    for t in range(nodes[node, 0], nodes[node, 1]):
                        # No point of a disc is nearer than the one right below, or on its edge.
                        i, j, k = x - discs[t, 0], y - discs[t, 1], z - discs[t, 2]
                        radius, apart = discs[t, 6], square(i, j, k)
                        up = abs(i * discs[t, 3] + j * discs[t, 4] + k * discs[t, 5])
                        up = max(0.0, up - _SLACK * (up + radius))
                        if up * up > least:
                            continue
                        if apart - up * up <= (radius + np.sqrt(least - up * up)) ** 2:
                            found = to_triangle(x, y, z, corners, t)
                            if found < least:
                                least, nearest = found, t
            squared[p] = least
            total += weights[p] * least
        if total > limit:
            break
    return total


@kernel
def _to_box(x: float, y: float, z: float, boxes: FloatArray, node: int) -> float:
    """Squared distance to a box, 0 within it."""
    return square(
        max(boxes[node, 0] - x, x - boxes[node, 3], 0.0),
        max(boxes[node, 1] - y, y - boxes[node, 4], 0.0),
        max(boxes[node, 2] - z, z - boxes[node, 5], 0.0),
    )
