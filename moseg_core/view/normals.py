"""Normals for shading: smooth within a part, broken at its boundary and at sharp creases."""

from __future__ import annotations

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray, IntArray

# Faces that meet at a larger angle meet in an edge; others are shaded as one smooth surface.
_CREASE = np.cos(np.radians(40.0))


def corner_normals(mesh: Geometry, labels: IntArray) -> FloatArray:
    """Compute normals for shading, smooth within a part except across creases.

    The normal of a corner is the mean, weighted by angle, of the faces around its vertex that can
    be reached from its own over edges between two faces of one part, wound alike, that meet at
    less than 40 degrees.

    Parameters
    ----------
    mesh : Geometry
    labels : (F,) int
        The part of each element.

    Returns
    -------
    (T, 3, 3) float
        A unit vector for each corner of each triangle of the mesh.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                                 [[0, 1, 2, 3]])
    >>> corner_normals(square, np.array([0]))[0].tolist()
    [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
    """
    corners = mesh.vertices[mesh.triangles]
    sides = _unit(np.roll(corners, -1, axis=1) - corners)
    face = _unit(np.cross(sides[:, 0], sides[:, 1]))
    cosine = -np.einsum("tki,tki->tk", sides, np.roll(sides, 1, axis=1))
    angles = np.arccos(np.clip(cosine, -1.0, 1.0))

    joined = _joined_corners(mesh, labels, face)
    count = corners.shape[0] * 3
    graph = sparse.coo_array(
        (np.ones(len(joined), np.int8), (joined[:, 0], joined[:, 1])), shape=(count, count)
    )
    groups, group = csgraph.connected_components(graph, directed=False)
    weighted = (angles[:, :, None] * face[:, None, :]).reshape(-1, 3)
    total = np.empty((groups, 3))
    for axis in range(3):
        total[:, axis] = np.bincount(group, weighted[:, axis], groups)
    normals = _unit(total)[group].reshape(-1, 3, 3)
    # Faces without area, and faces that cancel, have no normal: any is as good.
    normals[~normals.any(axis=2)] = [0.0, 0.0, 1.0]
    return normals


def _unit(vectors: FloatArray) -> FloatArray:
    """Vectors of length 1 along the last axis; those of no length stay zero."""
    # The largest component first, so that squares of tiny or huge ones stay in range.
    largest = np.abs(vectors).max(axis=-1, keepdims=True)
    scaled = vectors / np.where(largest > 0.0, largest, 1.0)
    length = np.sqrt((scaled * scaled).sum(axis=-1, keepdims=True))
    unit: FloatArray = scaled / np.where(length > 0.0, length, 1.0)
    return unit


def _joined_corners(mesh: Geometry, labels: IntArray, face: FloatArray) -> IntArray:
    """(E, 2) corners, numbered through all triangles, that share a vertex and a normal."""
    number = np.arange(3 * len(mesh.triangles)).reshape(-1, 3)
    position = mesh.merged[mesh.triangles]
    # Half-edge i runs from corner i to corner after[i] of the same triangle.
    after = np.roll(number, -1, axis=1).reshape(-1)
    start, end = position.reshape(-1), np.roll(position, -1, axis=1).reshape(-1)
    low, high = np.minimum(start, end), np.maximum(start, end)
    key = low * (int(position.max()) + 1) + high
    order = np.argsort(key, kind="stable")
    _, first, uses = np.unique(key[order], return_index=True, return_counts=True)
    one, other = order[first[uses == 2]], order[first[uses == 2] + 1]

    part = labels[mesh.triangle_polygon]
    bend = np.einsum("ei,ei->e", face[one // 3], face[other // 3])
    flat = (bend > _CREASE) | ~face[one // 3].any(axis=1) | ~face[other // 3].any(axis=1)
    smooth = flat & (start[one] == end[other]) & (start[one] != end[one])
    smooth &= part[one // 3] == part[other // 3]
    one, other = one[smooth], other[smooth]
    return np.concatenate(
        [np.stack([one, after[other]], axis=1), np.stack([after[one], other], axis=1)]
    )
