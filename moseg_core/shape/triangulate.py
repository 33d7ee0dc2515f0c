"""Cutting polygons into triangles without losing track of which is whose.

Triangles pass through. A quad is cut along the diagonal whose two halves agree in direction, so
that a concave or bent one does not fold over itself. Larger polygons are clipped ear by ear in
the plane of their Newell normal (:mod:`moseg_core.shape.ears`).
"""

from __future__ import annotations

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.shape.ears import cut_polygons
from moseg_core.types import FloatArray, IntArray

# A polygon with holes names the ends of each bridge to one twice, and no more than that. Large
# ones that name vertices far more often are looked for: to cut them would take long.
_LARGE, _LEAST_SHARE = 256, 0.25


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

    Raises
    ------
    ShapeError
        A polygon has hundreds of corners and crosses itself or folds all over.

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

    more = np.flatnonzero(sizes > 4)
    if len(more):
        _cut(vertices, corners, offsets, more, first, triangles)
    return triangles, polygon


def _cut(
    vertices: FloatArray,
    corners: IntArray,
    offsets: IntArray,
    chosen: IntArray,
    starts: IntArray,
    triangles: IntArray,
) -> None:
    """Cut polygons of more than four corners, or refuse one that takes too long."""
    for f in chosen[np.diff(offsets)[chosen] > _LARGE]:
        ring = corners[offsets[f] : offsets[f + 1]]
        named = len(np.unique(ring))
        if named < _LEAST_SHARE * len(ring):
            raise ShapeError(
                f"face {f} has {len(ring)} corners, but names no more than {named} vertices, again"
                " and again; repair it before you export the shape"
            )
    failed = cut_polygons(
        np.ascontiguousarray(vertices), corners, offsets, chosen, starts, triangles
    )
    if failed >= 0:
        raise ShapeError(
            f"face {failed}, of {offsets[failed + 1] - offsets[failed]} corners, crosses itself or"
            " folds too often to be cut into triangles; triangulate it before you export the shape"
        )


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

    Raises
    ------
    ShapeError
        It would take too long (:data:`moseg_core.shape.ears.LOOKS`).
    """
    count = len(points)
    triangles = np.empty((count - 2, 3), np.int64)
    whole = np.array([0, count])
    _cut(points, np.arange(count), whole, np.zeros(1, np.int64), whole, triangles)
    return triangles
