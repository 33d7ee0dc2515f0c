"""Boundaries below mesh resolution: straddling faces are cut along the bisector (Sec. 4, Fig. 2).

A labelling gives whole faces to parts, so that boundaries follow mesh edges in a zigzag. The
partition of space behind it knows better: its boundaries are the weighted bisectors of the
centres (:mod:`moseg_core.clipping.bisector`), or wherever two parts are equally far
(:mod:`moseg_core.clipping.boundaries`). :func:`clip_boundaries` cuts the faces there:

1. Every vertex, by position, takes the label of a part near to it, and an edge between different
   parts is cut at their bisector, once for all faces that share it, so that nothing cracks
   (:mod:`moseg_core.clipping.net`).
2. Each face is divided between its corners along its cuts (:mod:`moseg_core.clipping.pieces`).
   Texture coordinates and normals of new corners are between those of the face
   (:mod:`moseg_core.clipping.looks`).

Where the flooding of Algorithm 1 decided, and not the bisector, a boundary stays on mesh edges.
A part of which nothing would be left keeps all its faces.

The partition may live elsewhere, as in an embedding (Sec. 9): cuts are found among the embedded
vertices (`places`) and made at the same fraction of the original edges.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from moseg_core.clipping.bisector import Bisectors
from moseg_core.clipping.boundaries import Boundaries
from moseg_core.clipping.looks import looks_of_pieces
from moseg_core.clipping.net import Net
from moseg_core.clipping.pieces import divide
from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import FloatArray, IntArray, frozen

if TYPE_CHECKING:
    from moseg_core.shape.shape import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class Clipped:
    """A labelled mesh whose boundaries are bisectors.

    Parameters
    ----------
    mesh : PolygonMesh
        The input's vertices, followed by new ones on edges and in faces; the pieces of each face
        in the order of the faces. A face that is not cut is the polygon that it was.
    labels : (K,) int
        The part of each piece.
    source : (K,) int
        The input face that each piece was cut from; ascending.
    """

    mesh: PolygonMesh
    labels: IntArray
    source: IntArray

    def __post_init__(self) -> None:
        frozen(self.labels)
        frozen(self.source)


def check_clippable(shape: Shape) -> PolygonMesh:
    """The mesh of a shape, or an error where there are no faces to cut.

    Raises
    ------
    ShapeError
        The shape is a point cloud or a voxel grid.
    """
    if not isinstance(shape.geometry, PolygonMesh):
        raise ShapeError(
            f"'{shape.name}' is a {shape.geometry.kind}; boundaries can be clipped on a mesh only"
        )
    return shape.geometry


def clip_boundaries(
    mesh: PolygonMesh,
    labels: npt.ArrayLike,
    points: FloatArray,
    centers: FloatArray,
    weights: FloatArray,
    *,
    places: FloatArray | None = None,
) -> Clipped:
    """Cut the faces that straddle a boundary along the weighted bisector of the two centres.

    Parameters
    ----------
    mesh : PolygonMesh
    labels : (F,) array_like of int
        The part of each polygon, 0 to n - 1.
    points : (F, 3) float
        Where each polygon was classified: its centroid.
    centers : (n, 3) float
    weights : (n,) float, positive
    places : (V, 3) float, optional
        The vertices in the space of `points` and `centers`; those of the mesh by default.

    Returns
    -------
    Clipped
        Each piece lies in its face and is wound like it; edges are cut for all their faces alike,
        so that a closed mesh stays closed; every label that occurred still does.

    Raises
    ------
    ShapeError
        Not one label and point per polygon, or place per vertex.
    UsageError
        A label without a centre, not one weight per centre, or one that is not positive.

    Examples
    --------
    >>> strip = PolygonMesh.from_faces([[0, 0, 0], [2, 0, 0], [0, 1, 0], [2, 1, 0]],
    ...                                [[0, 1, 2], [1, 3, 2]])
    >>> points = np.array([[2 / 3, 1 / 3, 0], [4 / 3, 2 / 3, 0]])
    >>> ends = np.array([[0.0, 0.5, 0], [2, 0.5, 0]])
    >>> clipped = clip_boundaries(strip, [0, 1], points, ends, np.ones(2))
    >>> clipped.mesh.vertices[4:].tolist()  # the boundary is x = 1
    [[1.0, 0.0, 0.0], [1.0, 0.5, 0.0], [1.0, 1.0, 0.0]]
    >>> clipped.labels.tolist(), clipped.source.tolist()
    ([1, 0, 0, 0, 1, 1], [0, 0, 0, 1, 1, 1])
    """
    if weights.shape != (len(centers),) or not (weights > 0.0).all():
        raise UsageError(f"clipping needs a positive weight for each of {len(centers)} centres")
    boundaries = Bisectors(centers, weights)
    return clip_along(mesh, labels, points, boundaries, n_parts=len(centers), places=places)


def clip_along(
    mesh: PolygonMesh,
    labels: npt.ArrayLike,
    points: FloatArray,
    boundaries: Boundaries,
    *,
    n_parts: int,
    places: FloatArray | None = None,
) -> Clipped:
    """The same along the boundaries of any partition of space.

    Parameters
    ----------
    mesh, labels, points, places
        As for :func:`clip_boundaries`.
    boundaries : Boundaries
        In the space of `points` and `places`.
    n_parts : int

    Raises
    ------
    ShapeError
        Not one label and point per polygon, or place per vertex.
    UsageError
        A label of no part.
    """
    label, places = _checked(mesh, labels, points, n_parts, places)
    net = Net.of(mesh, label, points, places, boundaries)
    kept = np.zeros(n_parts, np.bool_)
    while True:
        pieces = divide(net, net.cuts(kept))
        lost = np.setdiff1d(label, pieces.labels)
        if not len(lost):
            looks = looks_of_pieces(mesh, pieces.mesh, pieces.source)
            pieced = replace(pieces.mesh, appearance=looks)
            return Clipped(mesh=pieced, labels=pieces.labels, source=pieces.source)
        kept[lost] = True


def _checked(
    mesh: PolygonMesh,
    labels: npt.ArrayLike,
    points: FloatArray,
    n_parts: int,
    places: FloatArray | None,
) -> tuple[IntArray, FloatArray]:
    """Labels and places as arrays that fit the mesh."""
    label = np.asarray(labels)
    places = mesh.vertices if places is None else places
    if label.shape != (mesh.n_polygons,) or not np.issubdtype(label.dtype, np.integer):
        raise ShapeError(f"clipping needs an integer label for each of {mesh.n_polygons} polygons")
    if points.shape != (mesh.n_polygons, 3) or places.shape != mesh.vertices.shape:
        raise ShapeError(
            f"clipping needs a point for each of {mesh.n_polygons} polygons and a place for each"
            f" of {len(mesh.vertices)} vertices, not {len(points)} and {len(places)}"
        )
    if label.min() < 0 or label.max() >= n_parts:
        raise UsageError(
            f"labels must be 0 to {n_parts - 1}, one for each part of the partition, and are"
            f" {label.min()} to {label.max()}"
        )
    return label.astype(np.int64), places
