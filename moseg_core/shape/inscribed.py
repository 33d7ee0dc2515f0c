"""Lower bounds of the volumes of parts' convex hulls, from bodies inscribed in them.

To compute the hulls of a candidate's parts takes longer than all else that a search asks of most
candidates. But of most it is enough to know that their hulls are too large, and a body within the
hull says so: one whose corners are the vertices of the part that are farthest in some hundred
directions. Farthest vertices of a part follow from those of its elements, and of blocks of elements
that are in it as a whole. So they are known of all parts of a labelling for little more than it
takes to read some hundred rows of a table, and no part has to be made.

*The body.* First the farthest vertices are stretched to be spread alike in all directions, so that
directions all over the sphere do justice to a long part too. These, ``d_j``, are the corners of a
polyhedron of triangles; ``s_j`` is the farthest vertex along ``d_j``, as seen from a point ``o``
within the hull ``K``. The triangles ``(s_a, s_b, s_c)`` make a closed surface in ``K``, whose
volume is the sum over the tetrahedra that they make with ``o``, with their signs. Take a ray from
``o`` that meets the surface at distances ``r_i`` where it goes out and ``q_i`` where it comes in.
What the surface encloses along the ray is ``sum r_i^3 - sum q_i^3``, over 3. If the surface goes
once around ``o``, there is one ``r_i`` more than there are ``q_i``; and no ``r_i`` is beyond ``R``,
where the ray leaves ``K``. So it is at most ``R^3 + sum (R^3 - q_i^3)``. Over all rays: the volume
of the surface is at most that of ``K`` and, for each tetrahedron ``T`` with a negative sign, what
``K`` has beyond ``T`` in the cone of ``T``. With ``w = d_a + d_b + d_c`` all of ``K`` is in the
half-space ``x . w <= H = s_a . d_a + s_b . d_b + s_c . d_c``, which cuts off of the cone
``|T| H^3 / ((s_a . w) (s_b . w) (s_c . w))``. Less by this for each such tetrahedron, the volume is
a lower bound of that of ``K``. How often the surface goes around ``o`` is counted along one ray;
where it is not once, or some ``s . w`` is not positive, the bound is 0.

On parts of real meshes that is one or two percent below the volume of the hull. Measures, values
and costs that are reported never come from here: :attr:`moseg_core.components.objectives.Traits.
at_least` says what bounds are for.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from moseg_core.shape.compiled import kernel
from moseg_core.types import BoolArray, FloatArray, Int32Array, IntArray, frozen

Heights: TypeAlias = npt.NDArray[np.float32]

_DIRECTIONS = 480
#: Elements in a block, blocks in one of the next level, and so on.
_BLOCK = 8
#: The most elements that a table is made for, of some 2 kB each.
_MOST_ELEMENTS = 20_000

#: A bound is lower by these shares of itself and of the cube of the part's reach: by more than all
#: that rounding, and heights of single precision, here and by whoever computes the hull, come to.
_LESS, _LEAST = 1e-5, 1e-8

#: Points whose spread across is less than this share of their reach, both squared, are flat.
_FLAT = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class FarthestVertices:
    """How far elements, and blocks of elements near each other, reach in all directions.

    Parameters
    ----------
    order : (K,) int
        The elements, those of a block one after the other.
    parents : (N,) int
        Of each row, which is an element in that order, a block, a block of blocks and so on, the
        row of its block; -1 of the last one.
    heights : (N, m) float32
        How far along each direction, from the middle of the shape.
    farthest : (N - K, m) int32
        Of blocks the vertex that is there.
    corners : (k,) int
        Vertices of the elements with the same hull as all of them, those of one after those of
        another.
    starts : (K + 1,) int
        Where each element's begin.
    vertices : (V, 3) float, model units
        About the middle of the shape.
    """

    order: IntArray
    parents: IntArray
    heights: Heights
    farthest: Int32Array
    corners: IntArray
    starts: IntArray
    vertices: FloatArray

    @classmethod
    def of(
        cls, points: FloatArray, vertices: FloatArray, corners: IntArray, starts: IntArray
    ) -> FarthestVertices | None:
        """Of a shape's elements; None of more than a table is made for.

        Parameters
        ----------
        points : (K, 3) float, model units
            Where the elements are.
        vertices, corners, starts
            As of the table.
        """
        from scipy.spatial import cKDTree

        count = len(points)
        if count > _MOST_ELEMENTS:
            return None
        # Neighbours in the order of a tree's leaves are neighbours in space.
        order = cKDTree(points).indices.astype(np.int64)
        parents, first, size = [], 0, count
        while size > 1:
            parents.append(first + size + np.arange(size) // _BLOCK)
            first, size = first + size, -(-size // _BLOCK)
        above = np.concatenate([*parents, [-1]])
        directions = _sphere()[0]
        heights = np.full((len(above), len(directions)), -np.inf, np.float32)
        farthest = np.zeros((len(above) - count, len(directions)), np.int32)
        made = cls(
            order=frozen(order),
            parents=frozen(above),
            heights=heights,
            farthest=farthest,
            corners=corners,
            starts=starts,
            vertices=frozen(vertices),
        )
        _write_farthest(*made._table, np.ascontiguousarray(directions.T))
        frozen(heights), frozen(farthest)
        return made

    @property
    def _table(
        self,
    ) -> tuple[IntArray, IntArray, Heights, Int32Array, IntArray, IntArray, FloatArray]:
        """All of it, for kernels."""
        mine = self.order, self.parents, self.heights, self.farthest
        return (*mine, self.corners, self.starts, self.vertices)

    def least_volumes(self, labels: Int32Array, wanted: BoolArray, volumes: FloatArray) -> None:
        """Write lower bounds of the volumes of the hulls of parts.

        Parameters
        ----------
        labels : (B, K) int32
        wanted : (B, n) bool
            Of which parts.
        volumes : (B, n) float, model units cubed, written
            0 where nothing better is known.

        Examples
        --------
        >>> import moseg_core as moseg
        >>> from scipy.spatial import ConvexHull
        >>> hammer = moseg.load(moseg.sample_path("hammer"))
        >>> labels, volumes = np.zeros((1, hammer.n_elements), np.int32), np.zeros((1, 1))
        >>> hammer.farthest_vertices.least_volumes(labels, np.ones((1, 1), bool), volumes)
        >>> bool(0.9 < volumes[0, 0] / ConvexHull(hammer.geometry.vertices).volume < 1.0)
        True
        """
        _write_least_volumes(*self._table, labels, wanted, *_sphere(), volumes)


@lru_cache
def _sphere() -> tuple[FloatArray, IntArray]:
    """(m, 3) unit vectors evenly over the sphere, on a spiral, and (2m - 4, 3) triangles of them.

    Triangles are counter-clockwise from outside. See Swinbank and Purser, "Fibonacci grids", 2006,
    doi:10.1256/qj.05.227.
    """
    from scipy.spatial import ConvexHull

    z = 1.0 - (2.0 * np.arange(_DIRECTIONS) + 1.0) / _DIRECTIONS
    angle = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(_DIRECTIONS)
    across = np.sqrt(1.0 - z**2)
    directions = np.stack([across * np.cos(angle), across * np.sin(angle), z], axis=1)
    triangles = ConvexHull(directions).simplices.astype(np.int64)
    a, b, c = (directions[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(a, b), c) < 0.0
    triangles[inward] = triangles[inward][:, ::-1]
    return frozen(directions), frozen(triangles)


@kernel
def _write_farthest(
    order: IntArray,
    parents: IntArray,
    heights: Heights,
    farthest: Int32Array,
    corners: IntArray,
    starts: IntArray,
    vertices: FloatArray,
    along: FloatArray,
) -> None:
    """Write heights, and farthest vertices of blocks; see FarthestVertices."""
    m, count = along.shape[1], len(order)
    which = np.empty(m, np.int32)
    for row in range(len(parents)):
        if row < count:
            for k in range(starts[order[row]], starts[order[row] + 1]):
                v = corners[k]
                for j in range(m):
                    height = _height(vertices, v, along[0, j], along[1, j], along[2, j])
                    if height > heights[row, j]:
                        heights[row, j], which[j] = height, v
        else:
            which[:] = farthest[row - count]
        block = parents[row]
        if block >= 0:
            for j in range(m):
                if heights[row, j] > heights[block, j]:
                    heights[block, j], farthest[block - count, j] = heights[row, j], which[j]


@kernel
def _height(vertices: FloatArray, v: int, x: float, y: float, z: float) -> np.float32:
    """How far a vertex is along a direction."""
    return np.float32(vertices[v, 0] * x + vertices[v, 1] * y + vertices[v, 2] * z)


@kernel
def _write_least_volumes(
    order: IntArray,
    parents: IntArray,
    heights: Heights,
    farthest: Int32Array,
    corners: IntArray,
    starts: IntArray,
    vertices: FloatArray,
    labels: Int32Array,
    wanted: BoolArray,
    directions: FloatArray,
    triangles: IntArray,
    volumes: FloatArray,
) -> None:
    """See :meth:`FarthestVertices.least_volumes`."""
    n, size, m = wanted.shape[1], len(parents), len(directions)
    count = len(order)
    owner = np.empty(size, np.int64)
    best, which = np.empty((n, m), np.float32), np.empty((n, m), np.int32)
    seen, points = np.full(len(vertices), -1), np.empty((m, 3))
    for b in range(len(labels)):
        if not wanted[b].any():
            continue
        # The part that a row is in as a whole: -1 for none, -2 where nothing is known yet.
        owner[:] = -2
        for row in range(count):
            owner[row] = labels[b, order[row]]
        for row in range(size - 1):
            block = parents[row]
            if owner[block] == -2:
                owner[block] = owner[row]
            elif owner[block] != owner[row]:
                owner[block] = -1
        best[:], which[:] = -np.inf, -1
        for row in range(size):
            part = owner[row]
            if part < 0 or not wanted[b, part]:
                continue
            if parents[row] >= 0 and owner[parents[row]] >= 0:
                continue
            mine, number, height, here = best[part], which[part], heights[row], np.int32(row)
            for j in range(m):
                higher = height[j] > mine[j]
                mine[j] = height[j] if higher else mine[j]
                number[j] = here if higher else number[j]
        for part in range(n):
            if not wanted[b, part]:
                continue
            k = 0
            for j in range(m):
                row, v = which[part, j], np.int64(-1)
                if row >= count:
                    v = np.int64(farthest[row - count, j])
                elif row >= 0:
                    x, y, z = directions[j, 0], directions[j, 1], directions[j, 2]
                    for c in range(starts[order[row]], starts[order[row] + 1]):
                        if _height(vertices, corners[c], x, y, z) == best[part, j]:
                            v = corners[c]
                if v >= 0 and seen[v] != b * n + part:
                    seen[v] = b * n + part
                    points[k] = vertices[v]
                    k += 1
            volumes[b, part] = _inscribed(points[:k], directions, triangles)


@kernel
def _inscribed(corners: FloatArray, directions: FloatArray, triangles: IntArray) -> float:
    """The lower bound of the volume of the hull of some points, each given once."""
    k, m = len(corners), len(directions)
    if k < 4:
        return 0.0
    middle, reach = np.zeros(3), 0.0
    for p in range(k):
        middle += corners[p] / k
    spread = np.zeros((3, 3))
    for p in range(k):
        x = corners[p] - middle
        reach = max(reach, _dot(x, x))
        for i in range(3):
            for j in range(i + 1):
                spread[i, j] += x[i] * x[j] / k
    # Its Cholesky factor: points of spread 1 in all directions are stretched by it to these.
    for i in range(3):
        for j in range(i + 1):
            rest = spread[i, j]
            for q in range(j):
                rest -= spread[i, q] * spread[j, q]
            if i > j:
                spread[i, j] = rest / spread[j, j]
            elif rest > _FLAT * reach:
                spread[i, i] = np.sqrt(rest)
            else:
                return 0.0
    places = np.empty((k, 3))
    best, which = np.full(m, -np.inf, np.float32), np.zeros(m, np.int32)
    d, e, f = directions[:, 0], directions[:, 1], directions[:, 2]
    d, e, f = d.astype(np.float32), e.astype(np.float32), f.astype(np.float32)
    for p in range(k):
        places[p, 0] = (corners[p, 0] - middle[0]) / spread[0, 0]
        places[p, 1] = (corners[p, 1] - middle[1] - spread[1, 0] * places[p, 0]) / spread[1, 1]
        places[p, 2] = (
            corners[p, 2] - middle[2] - spread[2, 0] * places[p, 0] - spread[2, 1] * places[p, 1]
        ) / spread[2, 2]
        x, y, z = np.float32(places[p, 0]), np.float32(places[p, 1]), np.float32(places[p, 2])
        here = np.int32(p)
        for j in range(m):
            height = x * d[j] + y * e[j] + z * f[j]
            higher = height > best[j]
            best[j] = height if higher else best[j]
            which[j] = here if higher else which[j]
    stretched = spread[0, 0] * spread[1, 1] * spread[2, 2]
    volume = stretched * _enclosed(places, which, directions, triangles)
    least: float = (1.0 - _LESS) * volume - _LEAST * reach**1.5
    return max(0.0, least)


@kernel
def _enclosed(
    points: FloatArray, which: Int32Array, directions: FloatArray, triangles: IntArray
) -> float:
    """What a surface encloses whose corners are those of points that are farthest, or less."""
    volume, times_around = 0.0, 0
    for t in range(len(triangles)):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        if which[i] == which[j] or which[j] == which[k] or which[k] == which[i]:
            continue
        a, b, c = points[which[i]], points[which[j]], points[which[k]]
        # Twice the areas that are seen along the third axis, which is the ray.
        ab, bc, ca = _seen(a, b), _seen(b, c), _seen(c, a)
        six = a[2] * bc + b[2] * ca + c[2] * ab
        volume += six / 6.0
        if ab > 0.0 and bc > 0.0 and ca > 0.0:
            times_around += 1 if six > 0.0 else 0
        elif ab < 0.0 and bc < 0.0 and ca < 0.0:
            times_around -= 1 if six < 0.0 else 0
        elif (ab >= 0.0 and bc >= 0.0 and ca >= 0.0) or (ab <= 0.0 and bc <= 0.0 and ca <= 0.0):
            return 0.0  # on an edge: it cannot be said
        if six < 0.0:
            d, e, f = directions[i], directions[j], directions[k]
            at_a = _dot(a, d) + _dot(a, e) + _dot(a, f)
            at_b = _dot(b, d) + _dot(b, e) + _dot(b, f)
            at_c = _dot(c, d) + _dot(c, e) + _dot(c, f)
            if at_a <= 0.0 or at_b <= 0.0 or at_c <= 0.0:
                return 0.0
            most = _dot(a, d) + _dot(b, e) + _dot(c, f)
            volume += six / 6.0 * (most**3 / (at_a * at_b * at_c) - 1.0)
    return volume if times_around == 1 else 0.0


@kernel
def _dot(first: FloatArray, second: FloatArray) -> float:
    product: float = first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
    return product


@kernel
def _seen(first: FloatArray, second: FloatArray) -> float:
    """Twice the area of a triangle with the origin, as seen along the third axis."""
    area: float = first[0] * second[1] - first[1] * second[0]
    return area
