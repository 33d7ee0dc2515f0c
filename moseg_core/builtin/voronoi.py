"""Multiplicatively weighted Voronoi partitions as a parameterization (Sec. 4).

A segmentation of n parts is a vector of m = 4n numbers, position and weight of each centre,
``(x_1, y_1, z_1, w_1, ..., x_n, y_n, z_n, w_n)``. An element at ``p`` belongs to the centre with
the least ``||p - c|| / w``. Where the adjacency is known the segments are kept connected by
flooding from the centres (Algorithm 1, :mod:`moseg_core.builtin.flood`).

Vectors are in unit coordinates (bounding-box diagonal 1), so that one pattern size serves
positions and weights alike. Source: Okabe et al., Spatial Tessellations, 2nd ed., 2000,
Sec. 3.1.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from moseg_core.builtin.flood import flood_labels, voronoi_labels
from moseg_core.components.protocols import Centers
from moseg_core.search.workers import available_workers
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, Int32Array, IntArray

#: Below so many labels to find, threads take longer to start than they save.
_WORTH_THREADS = 300_000


class Voronoi:
    """Weighted Voronoi partitions of a shape into `n_parts` parts.

    Parameters
    ----------
    shape : Shape
    n_parts : int
    connected : bool
        Whether segments are kept connected; has no effect on a shape without adjacency.

    Examples
    --------
    >>> import numpy as np
    >>> shape = Shape.from_mesh([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]],
    ...                         [[0, 5, 4, 3], [5, 1, 2, 4]])
    >>> voronoi = Voronoi(shape, 2)
    >>> at = Centers(positions=np.array([[4., 0, 0], [0, 0, 0]]), weights=np.ones(2))
    >>> voronoi.labels(voronoi.encode(at)[None]).tolist()
    [[1, 0]]
    """

    weighted_bisectors = True

    def __init__(self, shape: Shape, n_parts: int, *, connected: bool = True) -> None:
        self._shape = shape
        self._n_parts = n_parts
        self.connected = connected and shape.adjacency is not None

    @property
    def n_parts(self) -> int:
        """Number of parts, n."""
        return self._n_parts

    @property
    def lower(self) -> FloatArray:
        """(4n,) float: positions are free, weights are positive."""
        smallest = np.finfo(np.float64).tiny
        return np.tile([-np.inf, -np.inf, -np.inf, smallest], self._n_parts)

    @property
    def upper(self) -> FloatArray:
        """(4n,) float: unbounded."""
        return np.full(4 * self._n_parts, np.inf)

    @property
    def scale(self) -> FloatArray:
        """(4n,) float: 1 for positions, in bounding-box diagonals, and for weights alike."""
        return np.ones(4 * self._n_parts)

    def labels(self, vectors: FloatArray) -> Int32Array:
        """(B, F) int32: the partitions that (B, 4n) vectors describe."""
        rows = np.ascontiguousarray(vectors, dtype=np.float64).reshape(-1, self._n_parts, 4)
        labels = np.empty((len(rows), self._shape.n_elements), np.int32)
        points = np.ascontiguousarray(self._shape.unit_points)
        adjacency = self._shape.adjacency if self.connected else None

        def partition(b: int) -> None:
            centers, weights = np.ascontiguousarray(rows[b, :, :3]), rows[b, :, 3].copy()
            if adjacency is None:
                voronoi_labels(points, centers, weights, labels[b])
            else:
                flood_labels(
                    points, centers, weights, adjacency.indptr, adjacency.indices, labels[b]
                )

        workers = min(len(rows), available_workers())
        if workers < 2 or labels.size < _WORTH_THREADS:
            for b in range(len(rows)):
                partition(b)
        else:  # the kernels release the GIL, and each row is written by one thread
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(partition, range(len(rows))))
        return labels

    def encode(self, centers: Centers) -> FloatArray:
        """(4n,) float: the vector of centres in model units."""
        unit = self._shape.frame.to_unit(centers.positions)
        return np.column_stack([unit, centers.weights]).reshape(-1)

    def decode(self, vector: FloatArray) -> Centers:
        """The centres of a vector, in model units."""
        rows = vector.reshape(-1, 4)
        return Centers(positions=self._shape.frame.to_model(rows[:, :3]), weights=rows[:, 3].copy())

    def distances(self, vector: FloatArray, points: FloatArray) -> FloatArray:
        """(P, n) float: weighted distance of points (model units) to every centre."""
        rows = vector.reshape(-1, 4)
        apart = self._shape.frame.to_unit(points)[:, None] - rows[None, :, :3]
        distance: FloatArray = np.sqrt((apart**2).sum(axis=2)) / rows[:, 3]
        return distance

    def coordinates(self, part: int) -> IntArray:
        """(4,) int: the places of a centre's position and weight in the vector."""
        return np.arange(4 * part, 4 * part + 4)

    def permute(self, vector: FloatArray, order: IntArray) -> FloatArray:
        """(4n,) float: the vector with its centres in another order."""
        permuted: FloatArray = vector.reshape(-1, 4)[order].reshape(-1)
        return permuted
