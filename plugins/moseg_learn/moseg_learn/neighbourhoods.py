"""Neighbourhoods: what lies within reach of each place, along the surface.

What the elements around an element are like tells a finger from an arm where both are as thick
(:mod:`moseg_learn.surroundings`). Distances along the surface between all pairs of elements would
be too many, so they go between some thousand groups of elements (:func:`moseg_core.coarsen`), by
the shortest path from middle to middle of neighbouring groups and of their neighbours: along a
grid of squares alone, a diagonal would be 1.41 times too long (Dijkstra 1959,
doi:10.1007/BF01386390).

A group counts with the share of it that is within the radius, as if it were a disc: so the area in
reach grows steadily with the radius, though groups are few. What is found of the groups is carried
over to the elements as a mean over the groups around each, the nearer the more.

All that is kept with the shape, in :attr:`moseg_core.Shape.made_from`: every radius, and every
quantity, shares the groups and the distances.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core import Shape, coarsen

FloatArray = npt.NDArray[np.float64]

MOST = 1500
"""Between how many groups distances are found at most, or about so."""

REACH = 0.3
"""Up to which distance paths are followed at once, in diagonals; further where that is asked."""


@dataclass(frozen=True, eq=False)
class Neighbourhoods:
    """Groups of the elements of a shape, and the distances between them.

    Parameters
    ----------
    shape : Shape
        As the user gave it; of which is known which elements touch.
    groups : Shape
        Whose elements are the groups; the shape itself where it has no more than :data:`MOST`.
    """

    shape: Shape
    groups: Shape

    @classmethod
    def of(cls, shape: Shape) -> Neighbourhoods:
        """Those of a shape, made once and kept with it.

        Examples
        --------
        >>> import moseg_core as moseg
        >>> horse = moseg.load(moseg.sample_path("horse"))
        >>> around = Neighbourhoods.of(horse)
        >>> around is Neighbourhoods.of(horse), around.groups.n_elements <= 1500
        (True, True)
        """
        key = ("learn neighbourhoods",)
        if key not in shape.made_from:
            groups = shape if shape.n_elements <= MOST else coarsen(shape, MOST)
            shape.made_from[key] = cls(shape, groups)
        kept: Neighbourhoods = shape.made_from[key]
        return kept

    @cached_property
    def areas(self) -> FloatArray:
        """(K,) float: areas of the groups, model units squared; never 0."""
        areas: FloatArray = np.maximum(self.groups.areas, 1e-9 * self.groups.areas.mean())
        return areas

    def within(self, radius: float) -> FloatArray:
        """How much of each group is in reach of each, as a share of it.

        Parameters
        ----------
        radius : float
            Along the surface, in diagonals.

        Returns
        -------
        (K, K) float
            Row by row: 1 where a group lies within the radius, 0 beyond, and between them for
            those on the rim. More than 0.5 for the group itself.
        """
        diagonal = self.shape.box_diagonal
        half = np.sqrt(self.areas / np.pi)
        reach = self._distances(max(radius, REACH) * diagonal + half.max())
        share: FloatArray = np.clip(0.5 + (radius * diagonal - reach) / (2.0 * half), 0.0, 1.0)
        return share

    def on_elements(self, values: FloatArray) -> FloatArray:
        """Values of the groups, carried over to the elements.

        Parameters
        ----------
        values : (K, ...) float

        Returns
        -------
        (F, ...) float
            For each element the mean over its group and the groups beside it, by the inverse of
            the squared distance to their middles.
        """
        if self.groups is self.shape:
            return values
        carried: FloatArray = self._carry @ values
        return carried

    def of_elements(self, values: FloatArray) -> FloatArray:
        """(K, ...) float: means by area over the members of each group, of (F, ...) values."""
        if self.groups is self.shape:
            return values
        members, count = self.groups.members, self.groups.n_elements
        assert members is not None  # a coarse shape
        areas = np.maximum(self.shape.areas, 1e-9 * self.shape.areas.mean())
        belongs = sparse.csr_array((areas, (members, np.arange(len(members)))), (count, len(areas)))
        total = np.bincount(members, areas, count)
        means: FloatArray = (belongs @ values) / total.reshape(-1, *(1,) * (values.ndim - 1))
        return means

    def _distances(self, limit: float) -> FloatArray:
        """(K, K) float: distances along the surface, model units; infinite beyond the limit."""
        key = ("learn distances", limit)
        if key not in self.shape.made_from:
            self.shape.made_from[key] = csgraph.dijkstra(self._steps(), limit=limit)
        kept: FloatArray = self.shape.made_from[key]
        return kept

    def _steps(self) -> sparse.csr_array:
        """(K, K) sparse: straight distances to neighbours and to theirs, model units."""
        groups = self.groups
        assert groups.adjacency is not None  # required of the shape
        touching = groups.adjacency.matrix.astype(np.int32)
        near = (touching + touching @ touching).tocoo()
        apart = near.row != near.col
        rows, columns = near.row[apart], near.col[apart]
        lengths = np.linalg.norm(groups.points[rows] - groups.points[columns], axis=1)
        # A length of 0 would be no link at all.
        lengths = np.maximum(lengths, 1e-12 * groups.frame.scale)
        return sparse.csr_array((lengths, (rows, columns)), shape=near.shape)

    @cached_property
    def _carry(self) -> sparse.csr_array:
        """(F, K) sparse: weights of the groups around each element, 1 together."""
        groups, shape = self.groups, self.shape
        assert groups.members is not None  # a coarse shape
        assert groups.adjacency is not None  # required of the shape
        beside = groups.adjacency.matrix.astype(np.float64) + sparse.eye_array(groups.n_elements)
        chosen = beside.tocsr()[groups.members].tocoo()
        away = shape.points[chosen.row] - groups.points[chosen.col]
        squared = (away**2).sum(axis=1)
        weights = 1.0 / np.maximum(squared, 1e-12 * shape.frame.scale**2)
        weights /= np.bincount(chosen.row, weights, shape.n_elements)[chosen.row]
        return sparse.csr_array((weights, (chosen.row, chosen.col)), shape=chosen.shape)
