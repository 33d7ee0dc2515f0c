"""From where to look at a shape of which nothing is known but its surface.

Files do not say which way is up, and two copies of a shape that are turned against each other
should give the same picture. So the view follows from the shape alone:

1. The axes are the principal axes of the surface, area-weighted and exact over each triangle.
   The longest lies across the picture, the second upright, and the viewer looks along the third,
   along which there is least to hide behind.
2. Up is where the shape would stand level: of the sides of its convex hull that face roughly
   along the second axis, the widest is the ground (the feet of a horse span more than its head
   and rump). The axes are then turned until that side is level. Where there is no such side to
   speak of, the long thin end is up.
3. The third moments decide what remains, which end is on the right and which side is in front:
   what sticks out is turned towards the viewer.
4. Both cameras are then turned by a fixed yaw and pitch, a three-quarter view that shows three
   faces of a box. The second camera is opposite to the first, so that the two together show all
   of a convex shape.

Projection is orthographic, so that equal lengths look equal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from moseg_core.shape.geometry import Geometry
from moseg_core.types import FloatArray

_YAW, _PITCH = np.radians(30.0), np.radians(20.0)

# A side of the convex hull is all of it that faces within _LEVEL of one direction, and may be
# the ground within _LEAN of the second axis if it is _FOOTING of the shadow that the hull casts.
_LEVEL, _LEAN = np.cos(np.radians(10.0)), np.cos(np.radians(40.0))
_FOOTING = 0.2

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
    mesh: Geometry, *, width: int, height: int, margin: float = 0.05
) -> tuple[Camera, Camera]:
    """Choose a three-quarter view of a mesh, and the view from the opposite side.

    Parameters
    ----------
    mesh : Geometry
    width, height : int, pixels
        Size of each of the two pictures.
    margin : float
        Part of the width and of the height that stays free on each side.

    Returns
    -------
    main, opposite : Camera
        Of the same scale: the largest at which the shape fits.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> square = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                                 [[0, 1, 2, 3]])
    >>> main, opposite = choose_cameras(square, width=200, height=100)
    >>> bool((main.rotation[2] == -opposite.rotation[2]).all())
    True
    """
    corners = mesh.vertices[mesh.triangles]
    rotation = _three_quarter() @ standing_axes(corners)
    # Towards the viewer is away from the other; up stays up, so that right becomes left.
    rotations = rotation, rotation * np.array([[-1.0], [1.0], [-1.0]])
    origin = corners[0, 0]
    seen = (corners.reshape(-1, 3) - origin) @ rotation.T
    extent = np.ptp(seen, axis=0)
    center = origin + (seen.min(axis=0) + extent / 2.0) @ rotation
    room = (1.0 - 2.0 * margin) * np.array([width, height])
    with np.errstate(divide="ignore"):
        scale = float((room / extent[:2]).min())
    if not np.isfinite(scale):
        scale = 1.0
    main, opposite = (
        Camera(rotation=rotation, center=center, scale=scale, width=width, height=height)
        for rotation in rotations
    )
    return main, opposite


def standing_axes(corners: FloatArray) -> FloatArray:
    """Find what is across, up and in front of a shape, before it is turned for the view.

    Parameters
    ----------
    corners : (T, 3, 3) float
        The corners of its triangles, in any units.

    Returns
    -------
    (3, 3) float
        Rows are the unit directions to the right, up and towards the viewer; right-handed. They
        turn with the shape, except where its principal axes are not unique.
    """
    local, weights = _standardized(corners)
    total = local.sum(axis=1)
    second = np.einsum("t,tki,tkj->ij", weights, local, local)
    second += np.einsum("t,ti,tj->ij", weights, total, total)
    variance, directions = np.linalg.eigh(second / 12.0)
    axes = directions.T[::-1].copy()
    # A left-handed triple would show the shape in a mirror.
    axes[2] = np.cross(axes[0], axes[1])
    spread = np.sqrt(np.maximum(variance[::-1], 1e-24))
    skew = (weights @ (total / 3.0 @ axes.T) ** 3) / spread**3

    up = _ground(local.reshape(-1, 3) @ axes.T)
    if up is None:
        up = np.array([0.0, 1.0 if skew[1] >= 0.0 else -1.0, 0.0])
    # Of the two ends of the first axis and the two sides along the third, the more lopsided pair
    # chooses; the other follows, for the axes are right-handed.
    if abs(skew[0]) >= abs(skew[2]):
        across = np.array([1.0 if skew[0] >= 0.0 else -1.0, 0.0, 0.0])
    else:
        across = np.cross(up, [0.0, 0.0, 1.0 if skew[2] >= 0.0 else -1.0])
    across -= up * (across @ up)
    across /= np.linalg.norm(across)
    standing: FloatArray = np.stack([across, up, np.cross(across, up)]) @ axes
    return standing


def _standardized(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
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


def _three_quarter() -> FloatArray:
    """(3, 3) the turn from the standing axes to the main view: yaw, then pitch."""
    c, s = np.cos(_YAW), np.sin(_YAW)
    yaw = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    c, s = np.cos(_PITCH), np.sin(_PITCH)
    pitch = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    turn: FloatArray = pitch @ yaw
    return turn
