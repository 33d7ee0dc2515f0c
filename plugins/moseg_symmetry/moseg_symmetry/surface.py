"""A surface as symmetry sees it: evenly spread points, and how far any point is from it.

Symmetry is judged by where the points of a surface go when it is reflected or turned: how far from
the surface they come to lie (Simari, Kalogerakis and Singh 2006, "Folding meshes", SGP). A
reflection is its own inverse, so that this one direction says as much as both.

Distances are to the triangles, not to samples of them, which would have a noise of half the
distance between samples and hide the difference between good planes. There are two ways to ask:

- :meth:`Surface.nearest` is exact, from libigl's bounding-box tree, and gives the normal there.
- :class:`DistanceGrid` looks up a grid of distances, to about half a cell, millions of points a
  second. It serves to find where to look more closely.

Lengths are in *sizes*: the origin is the surface's centroid, and 1 is the diameter of the ball
around it that holds the surface. Unlike the diagonal of a box this does not change as the shape
turns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import igl
import numpy as np
import numpy.typing as npt
from scipy import ndimage

from moseg_core import Shape, ShapeError

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

# Irrational steps for points within triangles: the R2 sequence of M. Roberts, by powers of the
# plastic number. Any number of consecutive points covers the square evenly.
_R2 = np.array([0.7548776662466927, 0.5698402909980532])


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles around their centroid, 1 across. Make one with :func:`surface_of`.

    Parameters
    ----------
    vertices : (V, 3) float, sizes
    triangles : (T, 3) int
        Without those of no area.
    normals : (T, 3) float
        Of length 1.
    areas : (T,) float
    center : (3,) float, model units
        The centroid, which is the origin here.
    size : float, model units
        Diameter of the ball around the centroid that holds the surface.
    tree : igl.AABB
    """

    vertices: FloatArray
    triangles: IntArray
    normals: FloatArray
    areas: FloatArray
    center: FloatArray
    size: float
    tree: Any

    def samples(self, n: int) -> FloatArray:
        """(n, 3) float: points, each of which stands for an equal share of the area.

        In the order of the triangles, so that they move with the shape. The same each time.
        """
        steps = (np.arange(n) + 0.5) / n
        run = np.cumsum(self.areas)
        chosen = np.searchsorted(run, steps * run[-1]).clip(max=len(run) - 1)
        s, t = ((np.arange(1, n + 1)[:, None] * _R2 + 0.5) % 1.0).T
        over = s + t > 1.0
        s, t = np.where(over, 1.0 - s, s), np.where(over, 1.0 - t, t)
        a, b, c = (self.vertices[self.triangles[chosen, k]] for k in range(3))
        return np.asarray(a + s[:, None] * (b - a) + t[:, None] * (c - a))

    def nearest(self, points: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
        """Distance to the surface, the triangle nearest and the point of it, for (k, 3) points.

        Returns
        -------
        distances : (k,) float
        triangles : (k,) int
        feet : (k, 3) float
        """
        query = np.ascontiguousarray(points)
        squared, triangle, feet = self.tree.squared_distance(self.vertices, self.triangles, query)
        return np.sqrt(np.maximum(squared, 0.0)), triangle.reshape(-1).astype(np.int64), feet

    def distances(self, points: FloatArray) -> FloatArray:
        """(k,) float: distance of each point to the surface."""
        return self.nearest(points)[0]


def surface_of(shape: Shape) -> Surface:
    """The surface of a shape's input elements.

    Raises
    ------
    ShapeError
        The shape has no faces.

    Examples
    --------
    >>> import moseg_core as moseg
    >>> horse = surface_of(moseg.load(moseg.sample_path("horse")))
    >>> round(float(np.linalg.norm(horse.vertices, axis=1).max()), 6)
    0.5
    """
    mesh = shape.input.geometry
    if not len(mesh.triangles):
        raise ShapeError(
            f"'{shape.name}' is a {mesh.kind}, which has no faces of which the symmetry could be"
            f" found; give the plane"
        )
    corners = mesh.vertices[mesh.triangles] - shape.frame.center
    areas = _areas(corners)[1]
    center = (areas[:, None] * corners.mean(axis=1)).sum(axis=0) / areas.sum()
    size = 2.0 * float(np.sqrt(((corners - center) ** 2).sum(axis=2).max()))
    center = center + shape.frame.center
    vertices = (mesh.vertices - center) / size
    normals, areas = _areas(vertices[mesh.triangles])
    kept = areas > 1e-14
    if not kept.any():
        raise ShapeError(f"'{shape.name}' has no faces of which the symmetry could be found")
    triangles = np.ascontiguousarray(mesh.triangles[kept], dtype=np.int64)
    tree = igl.AABB()
    tree.init(vertices, triangles)
    return Surface(vertices, triangles, normals[kept], areas[kept], center, size, tree)


def _areas(corners: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Unit normals (T, 3) and areas (T,) of (T, 3, 3) triangles."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    return normals / np.maximum(length, np.finfo(float).tiny)[:, None], length / 2.0


@dataclass(frozen=True, eq=False)
class DistanceGrid:
    """Distances to a surface on the points of a grid around it. Make one with :meth:`of`.

    Parameters
    ----------
    values : (n, n, n) float32, sizes
    reach : float
        The grid goes from -reach to reach along each axis.
    """

    values: npt.NDArray[np.float32]
    reach: float

    @classmethod
    def of(cls, surface: Surface, *, cells: int = 88, reach: float = 0.66) -> DistanceGrid:
        """Distances from the cells that the surface goes through."""
        far = np.ones((cells, cells, cells), bool)
        # As many points as let few of the cells on the surface go without one.
        at = _cells(surface.samples(40_000), cells, reach)
        far[at[..., 0], at[..., 1], at[..., 2]] = False
        spacing = 2.0 * reach / cells
        values = ndimage.distance_transform_edt(far, sampling=spacing).astype(np.float32)
        return cls(values, reach)

    def distances(self, points: FloatArray) -> npt.NDArray[np.float32]:
        """(..., ) float32: about the distance of each point; beyond the grid, that at its edge."""
        cells = len(self.values)
        at = _cells(points, cells, self.reach)
        flat = (at[..., 0] * cells + at[..., 1]) * cells + at[..., 2]
        return np.asarray(self.values.reshape(-1)[flat])


def _cells(points: FloatArray, cells: int, reach: float) -> npt.NDArray[np.int32]:
    scaled = (points + reach) * (cells / (2.0 * reach))
    return scaled.clip(0, cells - 1).astype(np.int32)
