"""How the pieces of cut polygons look: texture coordinates and normals between those of corners.

A piece lies in the polygon that it was cut from, and has its material. A corner that the polygon
has too keeps what it has there; a new one lies in a triangle of the polygon, and has the mean of
what the triangle's corners have, by its barycentric coordinates. So a texture lies on the pieces as
it lay on the polygon (:mod:`moseg_core.shape.appearance`).
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.appearance import Appearance, CornerValues
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import FloatArray, IntArray


def looks_of_pieces(mesh: PolygonMesh, pieces: PolygonMesh, source: IntArray) -> Appearance | None:
    """The appearance of pieces of the polygons of a mesh.

    Parameters
    ----------
    mesh : PolygonMesh
    pieces : PolygonMesh
        Whose first vertices are those of `mesh`.
    source : (K,) int
        The polygon of `mesh` that each piece lies in.

    Returns
    -------
    Appearance or None
        None where the mesh has none.

    Examples
    --------
    >>> from dataclasses import replace
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [2, 0, 0], [0, 2, 0]], [[0, 1, 2]])
    >>> texture = CornerValues(values=np.array([[0.0, 0], [1, 0], [0, 1]]), corners=np.arange(3))
    >>> tile = replace(tile, appearance=Appearance(texture=texture))
    >>> halves = PolygonMesh.from_faces([[0, 0, 0], [2, 0, 0], [0, 2, 0], [1, 1, 0]],
    ...                                 [[0, 1, 3], [0, 3, 2]])
    >>> found = looks_of_pieces(tile, halves, np.array([0, 0])).texture
    >>> found.values[found.corners[:3]].tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5]]
    """
    looks = mesh.appearance
    if looks is None:
        return None
    own, triangle, weights = _places(mesh, pieces, source)
    materials = looks.polygon_materials
    return Appearance(
        texture=_between(looks.texture, own, triangle, weights),
        normals=_between(looks.normals, own, triangle, weights),
        materials=looks.materials,
        polygon_materials=None if materials is None else materials[source],
    )


def _places(
    mesh: PolygonMesh, pieces: PolygonMesh, source: IntArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Where the corners of pieces lie in the polygons that these were cut from.

    Returns
    -------
    own : (C,) int
        The corner of `mesh` that a corner is, -1 for a new one.
    triangle : (n, 3) int
        For each new one the corners of the triangle that it lies in.
    weights : (n, 3) float
        Its barycentric coordinates there.
    """
    polygon = np.repeat(source, np.diff(pieces.offsets))
    owner = np.repeat(np.arange(mesh.n_polygons), np.diff(mesh.offsets))
    known = owner * len(pieces.vertices) + mesh.corners
    order = np.argsort(known, kind="stable")
    wanted = polygon * len(pieces.vertices) + pieces.corners
    found = order[np.searchsorted(known[order], wanted).clip(max=len(known) - 1)]
    own = np.where(known[found] == wanted, found, -1)

    new = np.flatnonzero(own < 0)
    points = pieces.vertices[pieces.corners[new]]
    first = np.searchsorted(mesh.triangle_polygon, polygon[new])
    last = np.searchsorted(mesh.triangle_polygon, polygon[new], side="right") - 1
    corners = mesh.triangle_corners
    best, weights = first, _barycentric(mesh.vertices[mesh.triangles[first]], points)
    for step in range(1, int((last - first).max(initial=0)) + 1):
        other = np.minimum(first + step, last)
        tried = _barycentric(mesh.vertices[mesh.triangles[other]], points)
        inside = tried.min(axis=1) > weights.min(axis=1)
        best = np.where(inside, other, best)
        weights = np.where(inside[:, None], tried, weights)
    # Rounding, and polygons that are not plane, put a point a little beside its triangle.
    weights = np.clip(weights, 0.0, None)
    return own, corners[best], weights / weights.sum(axis=1, keepdims=True)


def _barycentric(triangles: FloatArray, points: FloatArray) -> FloatArray:
    """(n, 3) float: coordinates of points in triangles; far outside of those without area."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    square = np.einsum("ij,ij->i", normal, normal)
    real = square > 0.0
    scale = np.where(real, square, 1.0)
    second = np.einsum("ij,ij->i", np.cross(points - a, c - a), normal) / scale
    third = np.einsum("ij,ij->i", np.cross(b - a, points - a), normal) / scale
    found = np.stack([1.0 - second - third, second, third], axis=1)
    return np.where(real[:, None], found, [1.0, -1e300, -1e300])


def _between(
    given: CornerValues | None, own: IntArray, triangle: IntArray, weights: FloatArray
) -> CornerValues | None:
    """What corners of pieces have, from what corners of polygons have."""
    if given is None:
        return None
    row = np.where(own >= 0, given.corners[own], -1)
    if len(triangle) == 0:
        return CornerValues(values=given.values, corners=row)
    of_triangle = given.corners[triangle]
    means = np.einsum("ik,ikd->id", weights, given.values[of_triangle])
    # Equal places in the texture are one, also in two pieces.
    values, number = np.unique(means, axis=0, return_inverse=True)
    whole = (of_triangle >= 0).all(axis=1)
    row[own < 0] = np.where(whole, len(given.values) + number.reshape(-1), -1)
    return CornerValues(values=np.concatenate([given.values, values]), corners=row)
