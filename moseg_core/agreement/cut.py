"""Cut discrepancy: how far the boundaries of two segmentations lie from each other.

The *cuts* of a segmentation are the vertices of the edges at which faces of different parts meet.
From every point of the one's cuts one measures how far it is to the other's, along the edges of
the mesh, and the other way round. The mean of all these distances, over the mean distance of the
surface from its centroid, is the cut discrepancy: a number without units, 0 where the cuts are
the same. It says where parts end and not which are parts, and it wants to be read with the others:
a segmentation with many cuts has one near every true cut.

Chen, Golovinskiy and Funkhouser 2009, doi:10.1145/1531326.1531379. Their text averages each
direction by itself and puts the two together; their program pools the points of both, and that is
what the numbers that people compare with come from, and what is computed here.

Where a face has no label (-1) nobody has said whether it is cut off: its edges are no cuts, in
either of the two.

Where the discrepancy is undefined the result is None, never a number that would look like a good
or bad one: if exactly one of the two has cuts, or if from a cut point in one connected component
of the surface no cut of the other can be reached. Two segmentations without cuts agree: 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.agreement.overlap import labelled
from moseg_core.types import UNLABELLED, FloatArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeGraph:
    """The edges of a surface of polygons, each with the faces beside it.

    Make one of a mesh with :meth:`joined`.

    Parameters
    ----------
    positions : (P, 3) float, model units
        Of the vertices. Vertices at one position must have one number, or a seam in the file
        would be a gap that no path crosses.
    ends : (C, 2) int
        The edges of all faces, as vertex numbers, in any order and direction; one that several
        faces share stands there once for each.
    face : (C,) int
        The face that each edge belongs to.
    radius : float, model units
        Mean distance of the surface from its centroid (:func:`mean_radius`).
    """

    positions: FloatArray
    ends: IntArray
    face: IntArray
    radius: float

    @classmethod
    def joined(
        cls,
        vertices: FloatArray,
        merged: IntArray,
        ends: IntArray,
        face: IntArray,
        *,
        centroids: FloatArray,
        areas: FloatArray,
    ) -> EdgeGraph:
        """From a mesh of polygons whose vertices at one position are joined.

        Parameters
        ----------
        vertices : (V, 3) float, model units
        merged : (V,) int
            For each vertex the number of its position.
        ends : (C, 2) int
            The edges of all faces, as numbers of positions.
        face : (C,) int
            The face that each edge belongs to.
        centroids : (F, 3) float, model units
        areas : (F,) float, model units squared
            Of the faces.

        Examples
        --------
        >>> from moseg_core.shape.mesh import PolygonMesh
        >>> mesh = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
        ...                               [[0, 1, 2, 3]])
        >>> square = EdgeGraph.joined(mesh.vertices, mesh.merged, *mesh.edges,
        ...                           centroids=np.array([[0.5, 0.5, 0]]), areas=np.array([1.0]))
        >>> len(square.positions), len(square.ends), square.radius
        (4, 4, 0.0)
        """
        positions = np.empty((int(merged.max()) + 1, 3))
        positions[merged] = vertices
        radius = mean_radius(centroids, areas)
        return cls(positions=positions, ends=ends, face=face, radius=radius)

    @cached_property
    def _shared(self) -> tuple[IntArray, IntArray, IntArray]:
        """Distinct edges (E, 2), the faces ordered by their edge, and where each edge's begin."""
        edges, number = np.unique(np.sort(self.ends, axis=1), axis=0, return_inverse=True)
        number = number.reshape(-1)
        order = np.argsort(number, kind="stable")
        starts = np.searchsorted(number[order], np.arange(len(edges)))
        return edges, self.face[order], starts

    @cached_property
    def _lengths(self) -> sparse.csr_array:
        """(P, P) matrix of the lengths of the edges, from either end."""
        edges, _, _ = self._shared
        first, second = edges[:, 0], edges[:, 1]
        lengths = np.linalg.norm(self.positions[first] - self.positions[second], axis=1)
        rows, columns = np.concatenate([first, second]), np.concatenate([second, first])
        size = len(self.positions)
        return sparse.coo_array(
            (np.concatenate([lengths, lengths]), (rows, columns)), shape=(size, size)
        ).tocsr()

    def distances(self, vertices: IntArray) -> FloatArray:
        """Shortest distance along edges from each vertex to any of those given.

        Parameters
        ----------
        vertices : (k,) int
            At least one.

        Returns
        -------
        (P,) float, model units
            Infinite where none of them can be reached.

        Examples
        --------
        >>> import numpy as np
        >>> path = EdgeGraph(positions=np.array([[0., 0, 0], [3, 0, 0], [3, 4, 0], [9, 9, 9]]),
        ...                  ends=np.array([[0, 1], [1, 2]]), face=np.array([0, 0]), radius=1.0)
        >>> path.distances(np.array([0])).tolist()
        [0.0, 3.0, 7.0, inf]
        """
        found: FloatArray = csgraph.dijkstra(self._lengths, indices=vertices, min_only=True)
        return found


def mean_radius(centroids: FloatArray, areas: FloatArray) -> float:
    """Mean Euclidean distance of a surface from its centroid.

    Parameters
    ----------
    centroids : (F, 3) float, model units
        A point for each face, which stands for all of it.
    areas : (F,) float, model units squared
        Not all 0.

    Returns
    -------
    float
        Model units.

    Examples
    --------
    >>> import numpy as np
    >>> mean_radius(np.array([[0., 0, 0], [4, 0, 0]]), np.array([1.0, 1.0]))
    2.0
    """
    center = areas @ centroids / areas.sum()
    return float(areas @ np.linalg.norm(centroids - center, axis=1) / areas.sum())


def cut_vertices(graph: EdgeGraph, labels: IntArray) -> IntArray:
    """The vertices on the edges at which different parts meet.

    Parameters
    ----------
    graph : EdgeGraph
    labels : (F,) int
        Part of each face; -1 for one in none.

    Returns
    -------
    (k,) int
        Ascending. The rim of an open surface is no cut, and that of the labelled faces neither.

    Examples
    --------
    Two triangles of a square meet at its diagonal from 1 to 2.

    >>> import numpy as np
    >>> square = EdgeGraph(positions=np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]),
    ...                    ends=np.array([[0, 1], [1, 2], [2, 0], [1, 3], [3, 2], [2, 1]]),
    ...                    face=np.array([0, 0, 0, 1, 1, 1]), radius=1.0)
    >>> cut_vertices(square, np.array([4, 7])).tolist()
    [1, 2]
    >>> cut_vertices(square, np.array([4, 4])).tolist()
    []
    """
    edges, faces, starts = graph._shared
    if not len(edges):
        return np.empty(0, np.int64)
    beside = np.asarray(labels, np.int64)[faces]
    # Faces without a label take no part in either: least of the one, greatest of the other.
    ends = np.iinfo(np.int64)
    least = np.where(beside == UNLABELLED, ends.max, beside)
    greatest = np.where(beside == UNLABELLED, ends.min, beside)
    cut = np.minimum.reduceat(least, starts) < np.maximum.reduceat(greatest, starts)
    return np.unique(edges[cut])


def cut_discrepancy(graph: EdgeGraph, first: IntArray, second: IntArray) -> float | None:
    """Cut discrepancy of two segmentations.

    Parameters
    ----------
    graph : EdgeGraph
    first, second : (F,) int
        Part of each face, -1 for one in none; the order of the two plays no role.

    Returns
    -------
    float or None
        At least 0, without an upper bound, though seldom above 1; 0 is best. None where it is
        undefined: exactly one of the two has cuts; a cut point from which no cut of the other
        can be reached; different cuts on a surface of no extent.

    Examples
    --------
    A strip of four unit squares, cut after the first and after the third: the cuts are 2 apart,
    and the squares on average 1 from the middle.

    >>> import numpy as np
    >>> positions = np.array([[x, y, 0.0] for x in range(5) for y in (0, 1)])
    >>> ring = np.array([0, 2, 3, 1])
    >>> sides = np.stack([ring, np.roll(ring, -1)], axis=1)
    >>> strip = EdgeGraph(positions=positions,
    ...                   ends=np.concatenate([sides + 2 * k for k in range(4)]),
    ...                   face=np.repeat(np.arange(4), 4), radius=1.0)
    >>> cut_discrepancy(strip, np.array([0, 1, 1, 1]), np.array([0, 0, 0, 1]))
    2.0
    >>> cut_discrepancy(strip, np.array([0, 1, 1, 1]), np.array([0, 0, 0, 0])) is None
    True
    """
    known = labelled(first, second)
    first, second = (np.where(known, labels, UNLABELLED) for labels in (first, second))
    cuts = cut_vertices(graph, first), cut_vertices(graph, second)
    if not len(cuts[0]) and not len(cuts[1]):
        return 0.0
    if not len(cuts[0]) or not len(cuts[1]):
        return None
    apart = np.concatenate([graph.distances(cuts[1])[cuts[0]], graph.distances(cuts[0])[cuts[1]]])
    mean = float(apart.mean())
    if mean == 0.0:
        return 0.0
    return mean / graph.radius if np.isfinite(mean) and graph.radius > 0.0 else None
