"""Integrals over a part's surface and distances to it: the paper's ``surfdist`` (Sec. 10).

``surfdist(S1, S2)`` is the integral over ``S1`` of the squared distance to the surface ``S2``,
over the area of ``S1`` and the square of its box diagonal. The integral is a sum over samples:
the centroids of the triangles, each triangle larger than a twentieth of the part's box diagonal
being cut into equal smaller ones first, so that a coarse mesh is integrated as finely as a dense
one. What a centroid misses of a square within its piece is at most 1/4800 of the squared diagonal
(three sides of a twentieth, squared, over 36), and mostly far less.

Distances are to the surface, not to its vertices (:mod:`moseg_objectives_basic.surface_tree`). To a
needle less than about a millionth as wide as it is long they may come out too large, never too
small; beside a wider triangle this does not show.

Points of a cloud are samples as they are, with their areas. Of cells that fill a solid the exposed
faces count; a part that has none of them is sampled in its cells' middles.

On a part of a coarse shape both are thinned out (:mod:`moseg_objectives_basic.thinned`), but for
solids, of whose elements most have no surface.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from moseg_core import Part
from moseg_objectives_basic.surface_tree import SurfaceTree
from moseg_objectives_basic.thinned import thinned

FloatArray = npt.NDArray[np.float64]

_FINENESS = 20

#: A triangle this many times as long as it is wide is a needle.
_SLIM = 8.0


def surface_samples(part: Part) -> tuple[FloatArray, FloatArray]:
    """Points on a part's surface with weights, for integrals over it.

    Parameters
    ----------
    part : Part

    Returns
    -------
    points : (k, 3) float, model units
    weights : (k,) float, model units squared
        They add up to the part's area; of a solid's part to that of its exposed faces.
    """
    few = None if part.shape.solid else thinned(part)
    found = few.samples(part) if few else None
    if found is not None:
        return found
    if not len(part.triangles):
        return part.points, part.areas
    corners = _without_needles(part.vertices[part.triangles], part.box_diagonal / _FINENESS)
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    # A side as long as the box's diagonal is common; its number must not hang on rounding.
    cuts = np.ceil(edges * _FINENESS / part.box_diagonal - 1e-9).astype(int).clip(min=1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1) / 2.0
    points, weights = [], []
    for n in np.unique(cuts):
        chosen = cuts == n
        barycentric = _sub_centroids(int(n))
        points.append((barycentric @ corners[chosen]).reshape(-1, 3))
        weights.append(np.repeat(areas[chosen] / n**2, n**2))
    return np.concatenate(points), np.concatenate(weights)


def _without_needles(corners: FloatArray, length: float) -> FloatArray:
    """(k, 3, 3) triangles, those much longer than `length` and wide cut across until they are not.

    Cutting a triangle into n^2 equal pieces is wasteful where it is hundreds of times as long as
    it is wide, as on the side of a cylinder from a CAD program.
    """
    while True:
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        longest = sides.max(axis=1)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        width = np.linalg.norm(normals, axis=1) / np.maximum(longest, np.finfo(float).tiny)
        needle = longest > np.maximum(length, _SLIM * width)
        if not needle.any():
            return corners
        # The side from corner k - 1 to corner k is the longest: its middle replaces either end.
        k = sides[needle].argmax(axis=1)
        rows = np.arange(len(k))
        halves = corners[needle]
        middle = (halves[rows, k - 1] + halves[rows, k]) / 2.0
        first, second = halves.copy(), halves.copy()
        first[rows, k] = middle
        second[rows, k - 1] = middle
        corners = np.concatenate([corners[~needle], first, second])


def _sub_centroids(n: int) -> FloatArray:
    """(n^2, 3) barycentric coordinates of the centroids of a triangle's n^2 equal pieces."""
    i, j = np.divmod(np.arange(n * n), n)
    upward = i + j < n
    # The pieces that point down are the mirror images of those of a grid one row smaller.
    a = np.where(upward, i + 1 / 3, n - 1 - i + 2 / 3)
    b = np.where(upward, j + 1 / 3, n - 1 - j + 2 / 3)
    return np.stack([n - a - b, a, b], axis=1) / n


def surface_tree(part: Part) -> SurfaceTree:
    """Search tree over a part's triangles.

    Parameters
    ----------
    part : Part

    Returns
    -------
    SurfaceTree
    """
    few = thinned(part)
    found = few.surface(part) if few else None
    if found is None:
        found = part.vertices, part.triangles
    return SurfaceTree.of(*found)


def normalized_mean(part: Part, squared: FloatArray, weights: FloatArray) -> float:
    """The paper's normalisation: mean squared distance over the squared box diagonal."""
    # Not `@`, whose last bits depend on the number of threads.
    return float((weights * squared).sum() / weights.sum() / part.box_diagonal**2)
