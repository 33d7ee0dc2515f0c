"""Elements without an area, and places that are lost beside one that is far away.

Whether an element has an area is measured against its own size, not against that of the whole: a
shape may consist of pieces that are far apart. What limits that is the number of digits: places
are kept about the middle of the shape, and of an element that is smaller than their rounding
nothing is left. Where that is so of most elements, one vertex is mostly wrong by many powers of
ten, and it is named.
"""

from __future__ import annotations

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.voxels import VoxelGrid
from moseg_core.types import BoolArray, FloatArray, IntArray

_FLAT = 1e-14
"""Of the square of an element's size: areas up to this are none."""
_ROUNDING = float(np.finfo(np.float64).eps)


def without_area(geometry: Geometry, areas: FloatArray, scale: float) -> BoolArray:
    """Which elements have no area.

    Parameters
    ----------
    geometry : Geometry
    areas : (F,) float
        As measured about the middle of the bounding box; of a solid volumes.
    scale : float
        Diagonal of the bounding box.

    Raises
    ------
    ShapeError
        Most elements have one, but not beside a vertex that is so far away that their places
        cannot be told apart; names it.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> two = PolygonMesh.from_faces(
    ...     [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1e9, 0, 0]], [[0, 1, 2], [0, 1, 3]])
    >>> without_area(two, np.array([0.5, 0.0]), 1e9).tolist()
    [False, True]
    """
    if isinstance(geometry, VoxelGrid):
        return np.asarray(areas <= 0.0)
    if isinstance(geometry, PointCloud):
        if 0.0 < np.median(areas[areas > 0.0]) <= (_ROUNDING * scale) ** 2:
            raise _far(geometry.vertices, np.arange(len(areas)), geometry.noun)
        return np.asarray(areas <= _FLAT * areas.max())
    without: BoolArray = areas <= _FLAT * scale**2
    doubtful = np.flatnonzero(without)
    if len(doubtful):
        sizes, own = _sizes(geometry, doubtful)
        none = own <= _FLAT * sizes**2
        lost = ~none & (areas[doubtful] <= _ROUNDING * scale * sizes)
        if 2 * int(lost.sum()) > geometry.n_elements:
            raise _far(geometry.vertices, np.unique(geometry.corners), "vertex")
        without[doubtful] = none | lost
    return without


def _sizes(geometry: Geometry, elements: IntArray) -> tuple[FloatArray, FloatArray]:
    """Of some elements the longest side of the box around each, and the area about itself."""
    owner = geometry.triangle_polygon
    chosen = np.zeros(geometry.n_elements, np.bool_)
    chosen[elements] = True
    picked = np.flatnonzero(chosen[owner])
    corners = geometry.vertices[geometry.triangles[picked]]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    starts = np.searchsorted(owner[picked], elements)
    low = np.minimum.reduceat(corners.min(axis=1), starts)
    high = np.maximum.reduceat(corners.max(axis=1), starts)
    return (high - low).max(axis=1), np.add.reduceat(area, starts) / 2.0


def _far(vertices: FloatArray, used: IntArray, noun: str) -> ShapeError:
    """The error that names the vertex beside which others are lost."""
    places = vertices[used]
    apart = np.linalg.norm(places - np.median(places, axis=0), axis=1)
    vertex = int(used[np.argmax(apart)])
    return ShapeError(
        f"{noun} {vertex}, at {vertices[vertex].tolist()}, is {apart.max():.3g} away from the"
        " others, beside which their places cannot be told apart; repair or remove it"
    )
