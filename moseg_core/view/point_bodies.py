"""What is drawn of a shape: its triangles, or a small body at every point of a cloud.

Pictures and scenes are made of triangles, each of which belongs to an element. Meshes have them,
of voxel grids they are the exposed faces. A point is drawn as an octahedron about as wide as the
piece of surface that it stands for, so that a cloud of even density looks closed.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray, IntArray

_TIPS = np.array(
    [[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], np.float64
)
_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)

#: Half of an octahedron's diagonal, in roots of a point's area.
_WIDTH = 1.0


def drawable(geometry: Geometry) -> Geometry:
    """The same elements with triangles for each of them that can be seen.

    Parameters
    ----------
    geometry : Geometry

    Returns
    -------
    Geometry
        Itself where it is no point cloud.

    Examples
    --------
    >>> cloud = PointCloud.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> drawn = drawable(cloud)
    >>> drawn.n_elements, len(drawn.triangles)
    (3, 24)
    """
    if not isinstance(geometry, PointCloud):
        return geometry
    # A few points with much room around them should not hide the others.
    size = np.sqrt(np.minimum(geometry.areas, 4.0 * np.median(geometry.areas)))
    tips: FloatArray = geometry.vertices[:, None] + _WIDTH * size[:, None, None] * _TIPS
    count = geometry.n_elements
    corners: IntArray = np.arange(6 * count)
    triangles: IntArray = (6 * np.arange(count)[:, None, None] + _FACES).reshape(-1, 3)
    return Geometry(
        vertices=tips.reshape(-1, 3),
        corners=corners,
        offsets=6 * np.arange(count + 1),
        triangles=triangles,
        triangle_polygon=np.repeat(np.arange(count), len(_FACES)),
    )
