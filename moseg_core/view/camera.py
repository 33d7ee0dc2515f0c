"""How a shape lies in front of a viewer: what is across, up and in front; and the cameras.

Which way is up is known, or guessed by :mod:`moseg_core.view.upright`; the longest horizontal axis
of the surface then lies across the picture, and the viewer looks along the other. Where there is no
up to go by, everything follows from the shape alone, so that two copies that are turned against
each other give the same picture (:func:`standing_axes`):

1. The axes are the principal axes of the surface, area-weighted and exact over each triangle.
   The longest lies across the picture, the second upright, and the viewer looks along the third,
   along which there is least to hide behind.
2. Up is where the shape would stand level: of the sides of its convex hull that face roughly
   along the second axis, the widest is the ground (the feet of a horse span more than its head
   and rump). The axes are then turned until that side is level. Where there is no such side to
   speak of, the long thin end is up.
3. The third moments decide what remains, which end is on the right and which side is in front:
   what sticks out is turned towards the viewer.

From where it is looked at then, :mod:`moseg_core.view.views` says. Projection is orthographic, so
that equal lengths look equal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray

# Views in more columns are taken where they are no smaller than this share of the largest.
_CLOSE = 0.8

# A side of the convex hull is all of it that faces within _LEVEL of one direction, and may be
# the ground within _LEAN of the second axis if it is _FOOTING of the shadow that the hull casts.
_LEVEL, _LEAN = np.cos(np.radians(10.0)), np.cos(np.radians(40.0))
_FOOTING = 0.2

# Level axes are taken for equally long where their variances differ by less than this share.
_ROUND = 0.02

# Hull faces, largest first, that are tried as the middle of a side.
_TRIED = 100


@dataclass(frozen=True, eq=False, kw_only=True)
class Camera:
    """An orthographic camera.

    Parameters
    ----------
    rotation : (3, 3) float
        Rows are the unit directions to the right, up and towards the viewer.
    center : (3,) float, model units
        The point seen in the middle of the picture.
    scale : float, pixels per model unit
    width, height : int, pixels
    """

    rotation: FloatArray
    center: FloatArray
    scale: float
    width: int
    height: int

    def project(self, points: FloatArray) -> FloatArray:
        """Where points are seen.

        Parameters
        ----------
        points : (..., 3) float, model units

        Returns
        -------
        (..., 3) float, pixels
            x to the right and y down from the upper left corner, and the depth, which grows
            towards the viewer and is zero in the plane of ``center``.

        Examples
        --------
        >>> import numpy as np
        >>> camera = Camera(
        ...     rotation=np.eye(3), center=np.zeros(3), scale=10.0, width=100, height=60
        ... )
        >>> camera.project(np.array([1.0, 2.0, 3.0])).tolist()
        [60.0, 10.0, 30.0]
        """
        seen = (points - self.center) @ self.rotation.T * self.scale
        return seen * [1.0, -1.0, 1.0] + [self.width / 2.0, self.height / 2.0, 0.0]


def choose_cameras(
    mesh: Geometry,
    rotations: Sequence[FloatArray],
    *,
    width: int,
    height: int,
    margin: float = 0.05,
) -> tuple[Camera, ...]:
    """Cameras that look from given sides, each at the middle of what it sees.

    Parameters
    ----------
    mesh : Geometry
    rotations : sequence of (3, 3) float
        Rows are right, up and towards the viewer.
    width, height : int, pixels
        Size of each picture.
    margin : float
        Part of the width and of the height that stays free on each side.

    Returns
    -------
    tuple of Camera
        Of the same scale: the largest at which the shape fits in each.

    Examples
    --------
    >>> import numpy as np
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                                 [[0, 1, 2, 3]])
    >>> camera, = choose_cameras(square, [np.eye(3)], width=200, height=100)
    >>> float(camera.scale), camera.center.tolist()
    (90.0, [0.5, 0.5, 0.0])
    """
    places = mesh.vertices[np.unique(mesh.triangles)]
    origin = places[0]
    low, extent = zip(*(_extent(places - origin, rotation) for rotation in rotations), strict=True)
    room = (1.0 - 2.0 * margin) * np.array([width, height])
    with np.errstate(divide="ignore"):
        scale = float((room / np.max(extent, axis=0)[:2]).min())
    if not np.isfinite(scale):
        scale = 1.0
    return tuple(
        Camera(
            rotation=rotation,
            center=origin + (least + size / 2.0) @ rotation,
            scale=scale,
            width=width,
            height=height,
        )
        for rotation, least, size in zip(rotations, low, extent, strict=True)
    )


def best_columns(
    mesh: Geometry, rotations: Sequence[FloatArray], *, width: int, height: int
) -> int:
    """In how many columns views of a shape are largest in a room; the most, where it is close.

    Parameters
    ----------
    mesh : Geometry
    rotations : sequence of (3, 3) float
    width, height : int, pixels
    """
    places = mesh.vertices[np.unique(mesh.triangles)]
    extents = [_extent(places - places[0], rotation)[1][:2] for rotation in rotations]
    wide, high = np.maximum(np.max(extents, axis=0), 1e-300)
    count = len(rotations)

    def scale(columns: int) -> float:
        rows = -(-count // columns)
        return float(min(width / columns / wide, height / rows / high))

    full = {-(-count // rows) for rows in range(1, count + 1)}  # the last row about as full
    best = max(map(scale, full))
    return max(columns for columns in full if scale(columns) >= _CLOSE * best)


def _extent(places: FloatArray, rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The least of places as a camera sees them, and how far they reach."""
    seen = places @ rotation.T
    low: FloatArray = seen.min(axis=0)
    return low, np.ptp(seen, axis=0)


def standing_axes(corners: FloatArray, up: FloatArray | None = None) -> FloatArray:
    """Find what is across, up and in front of a shape, before it is turned for the view.

    Parameters
    ----------
    corners : (T, 3, 3) float
        The corners of its triangles, in any units.
    up : (3,) float, optional
        The unit direction that is up, where it is known.

    Returns
    -------
    (3, 3) float
        Rows are the unit directions to the right, up and towards the viewer; right-handed. They
        turn with the shape, except where its principal axes are not unique.
    """
    local, weights = standardized(corners)
    total = local.sum(axis=1)
    second = np.einsum("t,tki,tkj->ij", weights, local, local)
    second += np.einsum("t,ti,tj->ij", weights, total, total)
    axes, spread = _principal(second / 12.0, up)
    skew = (weights @ (total / 3.0 @ axes.T) ** 3) / spread**3
    if up is not None:
        upright: FloatArray | None = np.array([0.0, 1.0, 0.0])
    else:
        upright = _ground(local.reshape(-1, 3) @ axes.T)
    if upright is None:
        upright = np.array([0.0, 1.0 if skew[1] >= 0.0 else -1.0, 0.0])
    # Of the two ends of the first axis and the two sides along the third, the more lopsided pair
    # chooses; the other follows, for the axes are right-handed.
    if abs(skew[0]) >= abs(skew[2]):
        across = np.array([1.0 if skew[0] >= 0.0 else -1.0, 0.0, 0.0])
    else:
        across = np.cross(upright, [0.0, 0.0, 1.0 if skew[2] >= 0.0 else -1.0])
    across -= upright * (across @ upright)
    across /= np.linalg.norm(across)
    standing: FloatArray = np.stack([across, upright, np.cross(across, upright)]) @ axes
    return standing


def _principal(second: FloatArray, up: FloatArray | None) -> tuple[FloatArray, FloatArray]:
    """Axes of the surface as rows, right-handed, and the spread along them.

    The longest, the second and the shortest; or the longest that is level, the one that is up, and
    the other level one.
    """
    if up is None:
        variance, directions = np.linalg.eigh(second)
        axes, variance = directions.T[::-1].copy(), variance[::-1]
    else:
        level = np.linalg.svd(up[None])[2][1:]
        variance, directions = np.linalg.eigh(level @ second @ level.T)
        longest, shortest = directions.T[::-1] @ level
        if variance[1] - variance[0] <= _ROUND * variance[1]:  # about as long any way
            longest = np.eye(3)[int(np.argmin(np.abs(up)))]
            longest = longest - up * (longest @ up)
            longest /= np.linalg.norm(longest)
        axes = np.stack([longest, up, shortest])
        variance = np.array([variance[1], up @ second @ up, variance[0]])
    # A left-handed triple would show the shape in a mirror.
    axes[2] = np.cross(axes[0], axes[1])
    return axes, np.sqrt(np.maximum(variance, 1e-24))


def standardized(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Corners about the centroid of the surface, in a box of size 1, and areas that sum to 1."""
    flat = corners.reshape(-1, 3)
    low = flat.min(axis=0)
    size = float((flat.max(axis=0) - low).max())
    local = (corners - low) / (size if size > 0.0 else 1.0)
    areas = np.linalg.norm(np.cross(local[:, 1] - local[:, 0], local[:, 2] - local[:, 0]), axis=1)
    if areas.sum() == 0.0:
        areas = np.ones(len(local))
    weights = areas / areas.sum()
    return local - weights @ local.mean(axis=1), weights


def _ground(points: FloatArray) -> FloatArray | None:
    """(3,) unit vector that is up when points, in principal axes, stand; None if they do not."""
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None  # flat, or thinner than rounding: there is nothing to stand on
    normals = hull.equations[:, :3]
    simplices = points[hull.simplices]
    areas = (
        np.linalg.norm(
            np.cross(simplices[:, 1] - simplices[:, 0], simplices[:, 2] - simplices[:, 0]), axis=1
        )
        / 2.0
    )
    shadow = float(areas @ np.abs(normals[:, 1])) / 2.0
    middles = np.flatnonzero(np.abs(normals[:, 1]) > _LEAN)
    middles = middles[np.argsort(-areas[middles], kind="stable")][:_TRIED]
    sides = (normals[middles] @ normals.T > _LEVEL) * areas
    widths = sides.sum(axis=1)
    if len(widths) == 0 or widths.max() < _FOOTING * shadow:
        return None
    down = sides[np.argmax(widths)] @ normals
    up: FloatArray = -down / np.linalg.norm(down)
    return up
