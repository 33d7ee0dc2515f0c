"""Rays across a shape, and which side of its faces is the outside.

Normals are taken as the file orients its faces, or the other way round, as a look along them says:
where a ray along the normal meets the surface on one side alone, the inside is there. Where it does
on both, in a crotch or around a cavity, the orientation of the file decides, after the majority
has corrected it component by component. So it matters little how faces are oriented, as long as
those of a component are oriented alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import igl
import numpy as np
import numpy.typing as npt

from moseg_core import Shape

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

LIFT = 1e-6
"""How far from the surface rays begin, in diagonals of the bounding box."""

_MAGNIFIED = 1e5
"""How many times as large the surface is made for libigl, which takes a triangle for parallel to a
ray where twice its area, seen along the ray, is less than 1e-6."""

_LOOKS = 5000
"""From how many of the largest elements a look decides for their components."""


@dataclass(frozen=True, eq=False)
class Frames:
    """Where rays begin, in unit coordinates.

    Parameters
    ----------
    origins : (k, 3) float
        The middle of an element's largest triangle: on the surface, whatever the outline.
    normals : (k, 3) float
        Of that triangle, as the file orients it, of length 1; 0 where it has no area.
    sides : (k, 3) float
        Along its longest side, of length 1, so that a frame turns with the shape.
    """

    origins: FloatArray
    normals: FloatArray
    sides: FloatArray

    @classmethod
    def of(cls, shape: Shape, elements: IntArray) -> Frames:
        """On certain elements of a surface."""
        geometry = shape.geometry
        corners = shape.frame.to_unit(geometry.vertices)[geometry.triangles]
        twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(twice, axis=1)
        order = np.lexsort((-size, geometry.triangle_polygon))
        largest = order[np.searchsorted(geometry.triangle_polygon[order], elements)]
        corners, twice, size = corners[largest], twice[largest], size[largest]
        sides = corners - np.roll(corners, 1, axis=1)
        lengths = np.linalg.norm(sides, axis=2)
        longest = sides[np.arange(len(sides)), lengths.argmax(axis=1)]
        return cls(
            origins=corners.mean(axis=1),
            normals=_over(twice, size),
            sides=_over(longest, lengths.max(axis=1)),
        )


class Rays:
    """Rays against a surface.

    Parameters
    ----------
    shape : Shape
        A surface.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> shape = moseg.Shape.from_mesh([[0, 0, 0], [9, 0, 0], [0, 9, 0], [3, 3, 4]], [[0, 1, 2]])
    >>> here = shape.frame.to_unit(np.array([[3.0, 3.0, 4.0], [3, 3, 4]]))
    >>> lengths = Rays(shape).lengths(here, np.array([[0.0, 0, -1], [0, 0, 1]]))
    >>> (lengths * shape.box_diagonal).round(6).tolist()
    [4.0, inf]
    """

    def __init__(self, shape: Shape) -> None:
        self._vertices = _MAGNIFIED * shape.frame.to_unit(shape.geometry.vertices)
        self._triangles = np.ascontiguousarray(shape.geometry.triangles)
        self._unit = shape.frame.scale / shape.box_diagonal
        self._tree = igl.AABB()
        self._tree.init(self._vertices, self._triangles)

    def lengths(self, origins: FloatArray, directions: FloatArray) -> FloatArray:
        """How far rays go until they meet the surface.

        Parameters
        ----------
        origins, directions : (k, 3) float
            In unit coordinates; directions of length 1, or 0 for no ray.

        Returns
        -------
        (k,) float
            In diagonals (:attr:`moseg_core.Shape.box_diagonal`); infinite where nothing is met.
        """
        found = np.full(len(origins), np.inf)
        real = np.flatnonzero(directions.any(axis=1))
        start = _MAGNIFIED * (origins[real] + LIFT * directions[real])
        triangle, length, _ = self._tree.intersect_ray_first(
            self._vertices, self._triangles, start, np.ascontiguousarray(directions[real])
        )
        length = length / _MAGNIFIED + LIFT
        found[real] = np.where(triangle >= 0, length * self._unit, np.inf)
        return found


def outsides(shape: Shape, elements: IntArray, rays: Rays, frames: Frames) -> FloatArray:
    """Where the normal of the file points outward: 1, else -1, for each of some elements.

    Parameters
    ----------
    shape : Shape
    elements : (k,) int
    rays : Rays
    frames : Frames
        On these elements.

    Returns
    -------
    (k,) float
    """
    seen, votes, component = _looked(shape, elements, rays, frames)
    sides: FloatArray = np.where(seen != 0, seen, votes[component[elements]])
    return sides


def outward_normals(shape: Shape) -> FloatArray:
    """(F, 3) float: unit normals of all elements, turned outward component by component."""
    geometry = shape.geometry
    corners = shape.frame.to_unit(geometry.vertices)[geometry.triangles]
    twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((shape.n_elements, 3))
    np.add.at(sums, geometry.triangle_polygon, twice)
    normals = _over(sums, np.linalg.norm(sums, axis=1))
    by_size = np.argsort(-shape.areas, kind="stable")
    component = _components(shape)[1]
    largest = by_size[np.unique(component[by_size], return_index=True)[1]]
    elements = np.union1d(by_size[:_LOOKS], largest)
    _, votes, _ = _looked(shape, elements, Rays(shape), Frames.of(shape, elements))
    outward: FloatArray = normals * votes[component][:, None]
    return outward


def _looked(
    shape: Shape, elements: IntArray, rays: Rays, frames: Frames
) -> tuple[FloatArray, FloatArray, IntArray]:
    """What a look from each element says, or 0; what each component does; the components."""
    ahead, behind = (
        np.isfinite(rays.lengths(frames.origins, way * frames.normals)) for way in (1.0, -1.0)
    )
    seen = behind * 1.0 - ahead
    count, component = _components(shape)
    weighted = seen * shape.areas[elements]
    votes = np.sign(np.bincount(component[elements], weighted, count))
    votes[votes == 0] = np.sign(weighted.sum()) or 1.0
    return seen, votes, component


def _components(shape: Shape) -> tuple[int, IntArray]:
    if shape.adjacency is None:
        return 1, np.zeros(shape.n_elements, np.int64)
    return shape.adjacency.components()


def _over(vectors: FloatArray, lengths: FloatArray) -> FloatArray:
    scaled: FloatArray = vectors / np.maximum(lengths, np.finfo(float).tiny)[:, None]
    return scaled
