"""A part as a shape of its own, to be segmented in its turn.

Its elements are those of the part, in the same order, so that a label found for element ``i`` of
the part belongs to element ``elements[i]`` of the whole. Neighbours are neighbours still, also
where the user said what counts as one. Everything else is measured anew: its unit coordinates are
those of its own bounding box, and its volume is what it encloses once its cuts are capped or,
where its faces are not known to be oriented alike, an estimate in the way in which that of the
whole was made (:mod:`moseg_core.shape.volume.derived`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.shape.adjacency import Adjacency
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry, ranges
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.volume.derived import part_volume
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import IntArray


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
        Of k elements, with the neighbours that they have within the whole. A part of a mesh has
        no volume where it is flat, or where its faces are not known to be oriented alike and
        that of the whole was not estimated either, or given as a number. A part of a point cloud
        has one only where that of the whole was estimated by winding numbers.

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
    part = _alone(geometry, elements, shape.name, called)
    volume = part_volume(
        part.geometry,
        part.enclosed,
        whole=geometry,
        whole_volume=shape.enclosed,
        center=part.frame.center,
        diagonal=part.frame.scale,
    )
    return replace(
        part,
        adjacency=_within(shape.adjacency, elements),
        adjacency_source=shape.adjacency_source,
        enclosed=volume,
        notes=(),  # the whole has said it
        up=shape.up,
    )


def _alone(geometry: Geometry, elements: IntArray, whole: str, name: str) -> Shape:
    """Some elements, as if the user had given them alone."""
    if isinstance(geometry, PointCloud):
        return Shape.from_points(
            geometry.vertices[elements],
            areas=geometry.areas[elements],
            normals=None if geometry.normals is None else geometry.normals[elements],
            name=name,
        )
    if isinstance(geometry, VoxelGrid) and geometry.solid:
        kept = np.zeros_like(geometry.occupied)
        kept[tuple(geometry.cells[elements].T)] = True
        return Shape.from_voxels(kept, pitch=geometry.steps, origin=geometry.origin, name=name)
    if not isinstance(geometry, PolygonMesh):
        raise ShapeError(
            f"parts of '{whole}' cannot be divided further: it is the surface of a"
            f" {geometry.kind}; read it as a solid"
        )
    return Shape.from_polygon_mesh(restricted(geometry, elements), name=name)


def _within(adjacency: Adjacency | None, elements: IntArray) -> Adjacency | None:
    """The neighbours within the part; the user may have said what counts as one."""
    if adjacency is None:
        return None
    place = np.full(adjacency.n_elements, -1, np.int64)
    place[elements] = np.arange(len(elements))
    pairs = place[adjacency.pairs]
    return Adjacency.from_pairs(pairs[(pairs >= 0).all(axis=1)], len(elements))


def restricted(mesh: PolygonMesh, elements: IntArray) -> PolygonMesh:
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
        tolerance=mesh.tolerance,
    )
