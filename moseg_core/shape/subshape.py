"""A part as a shape of its own, to be segmented in its turn.

Its elements are those of the part, in the same order, so that a label found for element ``i`` of
the part belongs to element ``elements[i]`` of the whole. Neighbours are neighbours still, also
where the user said what counts as one. Everything else is measured anew: its unit coordinates are
those of its own bounding box, and its volume is the one that it encloses once the cuts are capped
(:mod:`moseg_core.shape.volume.capped`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.shape.adjacency import Adjacency, ranges
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.volume.capped import capped_volume
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import IntArray

#: Below this share of the cubed diagonal a volume is rounding, as for whole shapes.
_FLAT = 1e-9


def subshape(shape: Shape, elements: IntArray, *, name: str | None = None) -> Shape:
    """Some elements of a shape, as a shape.

    Parameters
    ----------
    shape : Shape
        As the user gave it.
    elements : (k,) int
        Which ones, ascending.
    name : str, optional
        What to call it in messages.

    Returns
    -------
    Shape
        Of k elements. A part of a mesh has no volume where it is flat, where the faces are not
        oriented alike, or where the cuts leave nothing to enclose; a part of a point cloud has
        none, and the neighbours that it has within the whole.

    Raises
    ------
    ShapeError
        No elements, or none with an area; a kind of geometry that cannot be divided.

    Examples
    --------
    >>> box = Shape.from_mesh([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    ...                       [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1],
    ...                        [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    >>> bowl = subshape(box, np.array([0, 1, 2, 3, 4]), name="bowl")
    >>> bowl.n_elements, round(bowl.volume, 6)
    (5, 1.0)
    """
    called = shape.name if name is None else name
    geometry = shape.geometry
    if len(elements) == 0:
        raise ShapeError(f"'{called}' has no elements")
    if isinstance(geometry, PointCloud):
        return _of_points(shape, geometry, elements, called)
    if isinstance(geometry, VoxelGrid) and geometry.solid:
        kept = np.zeros_like(geometry.occupied)
        kept[tuple(geometry.cells[elements].T)] = True
        part = Shape.from_voxels(kept, pitch=geometry.pitch, origin=geometry.origin, name=called)
        return replace(part, adjacency=_within(shape.adjacency, elements))
    if not isinstance(geometry, PolygonMesh):
        raise ShapeError(
            f"parts of '{shape.name}' cannot be divided further: it is the surface of a"
            f" {geometry.kind}; read it as a solid"
        )
    mesh = _restricted(geometry, elements)
    part = Shape.from_polygon_mesh(mesh, name=called)
    volume, reason = part.volume, part.volume_reason
    # The orientation of a whole that encloses a volume is known to be right, and so the part's.
    if volume is None and (shape.volume is not None or _oriented(mesh)):
        volume = capped_volume(mesh.vertices - part.frame.center, mesh.triangles)
        reason = ""
        if volume <= _FLAT * part.frame.scale**3:
            volume, reason = None, "it is flat, also with its cuts capped"
    adjacency = _within(shape.adjacency, elements)
    return replace(part, adjacency=adjacency, volume=volume, volume_reason=reason, notes=())


def _within(adjacency: Adjacency | None, elements: IntArray) -> Adjacency | None:
    """The neighbours within the part; the user may have said what counts as one."""
    if adjacency is None:
        return None
    place = np.full(adjacency.n_elements, -1, np.int64)
    place[elements] = np.arange(len(elements))
    pairs = place[adjacency.pairs]
    return Adjacency.from_pairs(pairs[(pairs >= 0).all(axis=1)], len(elements))


def _of_points(shape: Shape, cloud: PointCloud, elements: IntArray, name: str) -> Shape:
    """Some points of a cloud, with the areas and neighbours that they have in the whole."""
    part = Shape.from_points(
        cloud.vertices[elements],
        areas=cloud.areas[elements],
        normals=None if cloud.normals is None else cloud.normals[elements],
        name=name,
    )
    return replace(part, adjacency=_within(shape.adjacency, elements))


def _restricted(mesh: PolygonMesh, elements: IntArray) -> PolygonMesh:
    """Some polygons of a mesh with the vertices that they use, cut into the same triangles."""
    sizes = np.diff(mesh.offsets)[elements]
    corners = mesh.corners[ranges(mesh.offsets, elements)]
    used, corners = np.unique(corners, return_inverse=True)
    starts = np.searchsorted(mesh.triangle_polygon, np.arange(mesh.n_polygons + 1))
    pieces = ranges(starts, elements)
    return PolygonMesh(
        vertices=mesh.vertices[used],
        corners=corners.reshape(-1).astype(np.int64),
        offsets=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        triangles=np.searchsorted(used, mesh.triangles[pieces]),
        triangle_polygon=np.repeat(np.arange(len(elements)), np.diff(starts)[elements]),
    )


def _oriented(mesh: PolygonMesh) -> bool:
    """Whether no two polygons run through their common edge the same way."""
    ends, _ = mesh.edges
    code = ends[:, 0] * np.int64(len(mesh.vertices)) + ends[:, 1]
    return len(np.unique(code)) == len(code)
