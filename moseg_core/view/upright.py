"""Which way is up on a picture: what the shape knows, or else a guess.

Few files say which way is up (:mod:`moseg_core.shape.up`), but nearly all have their shapes upright
along one of their axes. So the six directions along those are compared, and those along the axes
of the shape itself (:func:`moseg_core.view.camera.standing_axes`) in case it lies askew, by what
speaks for a thing to stand that way (after Fu, Cohen-Or, Dror and Sheffer 2008, "Upright
orientation of man-made objects", doi:10.1145/1360612.1360641):

- it is *stable*: the middle of its surface is above its ground, the convex hull of what is within
  a fiftieth of its size of the lowest point; and the ground is wide, as the feet of a table are;
- it has an upright plane of *symmetry*: most things and creatures have a left and a right;
- it is what programs write: y or z.

The weights were chosen on 88 shapes of 19 kinds, creatures, furniture and tools of several
programs, of which people can say how they stand: 68 stand that way then. The guess is
deterministic, takes some tenths of a second, and is said to be one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import get_args

import numpy as np
from scipy.spatial import ConvexHull, QhullError, cKDTree

from moseg_core.shape.geometry import Geometry
from moseg_core.shape.up import Up, up_direction
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.camera import standardized, standing_axes

#: Places on the surface at which symmetry is looked at.
_SAMPLES = 1000
#: What is so near to the lowest point, as a share of the size, touches the ground.
_GROUND = 0.02
#: Planes whose normal leans less than this, as a sine, are upright.
_UPRIGHT = 0.02
#: What counts how much: to be stable; the root of the ground's share of the shadow; symmetry, by
#: the logarithm of how far a mirror image is off; and the axes that programs write.
_STABLE, _WIDE, _SYMMETRIC = 1.0, 3.0, 2.0
_WRITTEN: dict[Up, float] = {"y": 2.7, "z": 2.3}


@dataclass(frozen=True, eq=False, kw_only=True)
class Standing:
    """Which way is up.

    Parameters
    ----------
    up : (3,) float
        The unit vector.
    axis : {"x", "-x", "y", "-y", "z", "-z"} or None
        The axis of the file that it is, where it is one.
    guessed : bool
        Whether nobody has said so.
    """

    up: FloatArray
    axis: Up | None
    guessed: bool = False

    @property
    def said(self) -> str:
        """The same in words.

        Examples
        --------
        >>> Standing(up=up_direction("-z"), axis="-z", guessed=True).said
        'up: -z, guessed'
        """
        axis = "no axis of the file" if self.axis is None else self.axis
        return f"up: {axis}" + (", guessed" if self.guessed else "")


def find_standing(geometry: Geometry, up: Up | None) -> Standing:
    """Which way is up for a picture of a shape.

    Parameters
    ----------
    geometry : Geometry
        With triangles.
    up : Up or None
        What is known of it.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> tent = PolygonMesh.from_faces(
    ...     [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 3]],
    ...     [[3, 2, 1, 0], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    ... )
    >>> find_standing(tent, None).said, find_standing(tent, "-x").said
    ('up: z, guessed', 'up: -x')
    """
    return standing_of(geometry.vertices[geometry.triangles], up)


def standing_of(corners: FloatArray, up: Up | None) -> Standing:
    """The same of the corners of triangles, (T, 3, 3) float, in any units."""
    if up is not None:
        return Standing(up=up_direction(up), axis=up)
    own = standing_axes(corners)
    names: tuple[Up | None, ...] = (*get_args(Up), *[None] * 6)
    directions = np.concatenate([[up_direction(name) for name in get_args(Up)], own, -own])
    scores = _plausibility(corners, directions)
    scores += [_WRITTEN.get(name, 0.0) if name else 0.0 for name in names]
    best = int(np.argmax(scores))
    return Standing(up=directions[best], axis=names[best], guessed=True)


def mirror_errors(corners: FloatArray, normals: FloatArray) -> FloatArray:
    """How far the mirror image of a surface is from it, for planes through its middle.

    Parameters
    ----------
    corners : (T, 3, 3) float
        The corners of its triangles, in any units.
    normals : (n, 3) float
        Unit normals of the planes.

    Returns
    -------
    (n,) float
        The median over places on the surface, in units of how far these are apart: about 0.7 where
        the surface is its own image.
    """
    places = _surface_places(standardized(corners)[0])
    tree = cKDTree(places)
    apart = float(np.median(np.asarray(tree.query(places, 2)[0])[:, 1]))
    images = places - 2.0 * (normals @ places.T)[:, :, None] * normals[:, None]
    off = np.asarray(tree.query(images)[0])
    errors: FloatArray = np.median(off, axis=1) / max(apart, 1e-12)
    return errors


def _plausibility(corners: FloatArray, directions: FloatArray) -> FloatArray:
    """(n,) float: what speaks for each of some unit directions to be up."""
    errors = mirror_errors(corners, directions)
    level = np.abs(directions @ directions.T) < _UPRIGHT
    off = np.where(level, errors, np.inf).min(axis=1)
    places = _extreme(standardized(corners)[0].reshape(-1, 3))
    scores: FloatArray = -_SYMMETRIC * np.log(np.clip(off, 0.5, 1e3))
    for k, up in enumerate(directions):
        stable, share = _ground(places, up)
        scores[k] += _STABLE * stable + _WIDE * np.sqrt(share)
    return scores


def _ground(places: FloatArray, up: FloatArray) -> tuple[bool, float]:
    """Whether the origin is above the ground, and what share of the shadow the ground is."""
    heights, flat = places @ up, places @ np.linalg.svd(up[None])[2][1:].T
    try:
        ground = ConvexHull(flat[heights < heights.min() + _GROUND])
        shadow = ConvexHull(flat)
    except (QhullError, ValueError):  # a point or a line
        return False, 0.0
    # Of a hull in the plane the volume is the area.
    return bool((ground.equations[:, 2] < 0.0).all()), min(1.0, ground.volume / shadow.volume)


def _extreme(places: FloatArray) -> FloatArray:
    """Those of some places that are corners of their convex hull; all where it is flat."""
    try:
        return places[ConvexHull(places).vertices]
    except (QhullError, ValueError):
        return places


def _surface_places(corners: FloatArray) -> FloatArray:
    """(n, 3) float: places spread evenly over triangles.

    As many to each as its area asks for, in it along an additive sequence of low discrepancy.
    """
    sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    run = np.cumsum(np.linalg.norm(np.cross(*sides), axis=1))
    count = np.arange(_SAMPLES)
    wanted = (count + 0.5) / _SAMPLES * run[-1]
    triangle: IntArray = np.searchsorted(run, wanted).clip(max=len(corners) - 1)
    # Powers of the inverse of 1.3247..., the root of x^3 = x + 1.
    u, v = count * 0.7548776662466927 % 1.0, count * 0.5698402909980532 % 1.0
    beyond = u + v > 1.0
    u, v = np.where(beyond, 1.0 - u, u), np.where(beyond, 1.0 - v, v)
    places: FloatArray = (
        corners[triangle, 0] + u[:, None] * sides[0][triangle] + v[:, None] * sides[1][triangle]
    )
    return places
