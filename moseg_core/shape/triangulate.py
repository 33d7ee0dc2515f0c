"""Cutting polygons into triangles without losing track of which is whose.

Triangles pass through. A quad is cut along the diagonal whose two halves agree in direction, so
that a concave or bent one does not fold over itself. Larger polygons are clipped ear by ear in
the plane of their Newell normal.
"""

from __future__ import annotations

import numpy as np

from moseg_core.types import FloatArray, IntArray


def triangulate_polygons(
    vertices: FloatArray, corners: IntArray, offsets: IntArray
) -> tuple[IntArray, IntArray]:
    """Triangulate every polygon of a mesh.

    Parameters
    ----------
    vertices : (V, 3) float
    corners : (C,) int
    offsets : (F + 1,) int
        As in :class:`moseg_core.shape.mesh.PolygonMesh`.

    Returns
    -------
    triangles : (T, 3) int
        k - 2 triangles for a polygon of k corners, with its orientation.
    polygon : (T,) int
        The polygon of each triangle, ascending.

    Examples
    --------
    >>> import numpy as np
    >>> square = np.array([[0., 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> triangles, polygon = triangulate_polygons(square, np.arange(4), np.array([0, 4]))
    >>> triangles.tolist(), polygon.tolist()
    ([[0, 1, 2], [0, 2, 3]], [0, 0])
    """
    sizes = np.diff(offsets)
    if (sizes == 3).all():
        return corners.reshape(-1, 3), np.arange(len(sizes))
    first = np.concatenate([[0], np.cumsum(sizes - 2)])
    triangles = np.empty((int(first[-1]), 3), np.int64)
    polygon = np.repeat(np.arange(len(sizes)), sizes - 2)

    three = np.flatnonzero(sizes == 3)
    triangles[first[three]] = corners[offsets[three][:, None] + np.arange(3)]

    four = np.flatnonzero(sizes == 4)
    if len(four):
        quads = corners[offsets[four][:, None] + np.arange(4)]
        halves = _split_quads(vertices, quads)
        triangles[first[four]], triangles[first[four] + 1] = halves[:, 0], halves[:, 1]

    for f in np.flatnonzero(sizes > 4):
        ring = corners[offsets[f] : offsets[f + 1]]
        triangles[first[f] : first[f + 1]] = ring[clip_ears(vertices[ring])]
    return triangles, polygon


def _split_quads(vertices: FloatArray, quads: IntArray) -> IntArray:
    """(Q, 2, 3) triangles, each quad cut along the better of its two diagonals."""
    by_first = quads[:, [[0, 1, 2], [0, 2, 3]]]
    by_second = quads[:, [[1, 2, 3], [1, 3, 0]]]
    agreement = []
    for halves in (by_first, by_second):
        p = vertices[halves]
        normals = np.cross(p[:, :, 1] - p[:, :, 0], p[:, :, 2] - p[:, :, 0])
        agreement.append(np.einsum("qi,qi->q", normals[:, 0], normals[:, 1]))
    use_second = (agreement[0] <= 0) & (agreement[1] > agreement[0])
    return np.where(use_second[:, None, None], by_second, by_first)


def clip_ears(points: FloatArray) -> IntArray:
    """(k - 2, 3) local corner indices of a simple polygon, by ear clipping.

    Where no ear is left (the polygon crosses itself) the sharpest remaining corner is cut, so
    that the number of triangles is always k - 2.
    """
    points = points - points[0]  # far from the origin the sums below would drown in rounding
    following = np.roll(points, -1, axis=0)
    normal = np.cross(points, following).sum(axis=0)
    drop = int(np.argmax(np.abs(normal)))
    plane = np.delete(points, drop, axis=1)
    # The projection keeps the polygon counter-clockwise when seen along the dropped axis.
    if (normal[drop] < 0) != (drop == 1):
        plane = plane[:, ::-1]
    ring = list(range(len(points)))
    before, after = np.roll(plane, 1, axis=0), np.roll(plane, -1, axis=0)
    u, v = plane - before, after - plane
    if (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] > 0).all() and _winds_once(plane):
        return np.array([[0, k, k + 1] for k in range(1, len(ring) - 1)], np.int64)
    triangles: list[list[int]] = []
    left = np.array(ring)
    while len(left) > 3:
        a, b, c = plane[np.roll(left, 1)], plane[left], plane[np.roll(left, -1)]
        turns = _turns(a, b, c)
        ear = next(
            (i for i in np.flatnonzero(turns > 0) if not _holds_corner(plane[left], int(i))),
            int(np.argmax(turns)),
        )
        triangles.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        left = np.delete(left, ear)
    triangles.append(left.tolist())
    return np.array(triangles, np.int64)


def _winds_once(plane: FloatArray) -> bool:
    """Whether a polygon that only turns left is convex, and not a star that goes round twice."""
    steps = np.roll(plane, -1, axis=0) - plane
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    turns = np.mod(np.roll(angles, -1) - angles, 2 * np.pi)
    return bool(turns.sum() < 3 * np.pi)


def _turns(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Twice the signed areas of triangles in the plane, corner by corner."""
    u, v = b - a, c - a
    turns: FloatArray = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return turns


def _holds_corner(ring: FloatArray, i: int) -> bool:
    """Whether another corner of a ring lies in or on the triangle at its corner `i`."""
    a, b, c = ring[i - 1], ring[i], ring[(i + 1) % len(ring)]
    inside = (_turns(a, b, ring) >= 0) & (_turns(b, c, ring) >= 0) & (_turns(c, a, ring) >= 0)
    for corner in (a, b, c):  # the triangle's own corners, and others in the same places
        inside &= (ring != corner).any(axis=1)
    return bool(inside.any())
