"""Which part each vertex belongs to, and where edges between parts are cut.

A vertex takes the nearest centre among the labels of the faces around it; labels then spread
along edges to vertices that are nearer to them still. An edge whose ends got different labels is
cut where it crosses the bisector of the two, which it does exactly once if each end is nearer to
its own centre than to the other end's.

That is not always so, because connected segments are flooded (Algorithm 1): a part may own faces
that are nearer to another centre, which the other's flood did not reach first. Where such a face
lies beyond the bisector with all its corners, these are *closed* to the other label: they do not
take it, whatever the distance. Nor is an edge cut whose ends are not each nearer to their own.
There, boundaries stay where the flood drew them, on mesh edges.

Everything is about positions and the edges between them, not about vertices and faces. So copies
of a vertex, and all faces at an edge, however many, see one label and one cut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.clipping.boundaries import Boundaries
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import BoolArray, FloatArray, IntArray

#: A face is nearer to another centre if its squared distance is less by more than rounding.
_CLEARLY = 1.0 - 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Cuts:
    """Labels of positions and cuts of edges.

    Parameters
    ----------
    label : (P,) int
        The part of each position; -1 where all boundaries stay on the mesh.
    cut : (E,) bool
        Edges that are cut.
    where : (E,) float
        How far along, from 0 at the lower end to 1 at the upper; 0 for the others.
    """

    label: IntArray
    cut: BoolArray
    where: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Net:
    """The triangles of a labelled mesh over positions, with the edges that they share.

    Parameters
    ----------
    mesh : PolygonMesh
    label : (F,) int
        The part of each polygon.
    boundaries : Boundaries
    places : (P, 3) float
        Where each position lies in the space of the partition.
    vertex : (P,) int
        The first vertex at each position.
    corner : (T, 3) int
        Positions of the triangles' corners.
    ends : (E, 2) int
        Positions of the edges' ends, the lower number first.
    edge : (T, 3) int
        The edge from each corner to the next.
    near : (P, n) float
        How far the positions are from the parts, by what `boundaries` compares.
    near_face : (F, n) float
        How far the polygons are.
    """

    mesh: PolygonMesh
    label: IntArray
    boundaries: Boundaries
    places: FloatArray
    vertex: IntArray
    corner: IntArray
    ends: IntArray
    edge: IntArray
    near: FloatArray
    near_face: FloatArray

    @classmethod
    def of(
        cls,
        mesh: PolygonMesh,
        label: IntArray,
        points: FloatArray,
        places: FloatArray,
        boundaries: Boundaries,
    ) -> Net:
        """From polygons with their labels and points, and vertices with their places."""
        _, vertex = np.unique(mesh.merged, return_index=True)
        corner = mesh.merged[mesh.triangles]
        following = np.roll(corner, -1, axis=1)
        count = len(vertex)
        key = np.minimum(corner, following) * count + np.maximum(corner, following)
        found, edge = np.unique(key, return_inverse=True)
        return cls(
            mesh=mesh,
            label=label,
            boundaries=boundaries,
            places=places[vertex],
            vertex=vertex,
            corner=corner,
            ends=np.stack([found // count, found % count], axis=1),
            edge=edge.reshape(-1, 3),
            near=boundaries.distances(places[vertex]),
            near_face=boundaries.distances(points),
        )

    def cuts(self, kept: BoolArray) -> Cuts:
        """Label the positions and cut the edges between parts.

        Parameters
        ----------
        kept : (n,) bool
            Labels whose faces are not to be touched.
        """
        label = self._vertex_labels(kept)
        low, high = self.ends.T
        own, other = label[low], label[high]
        # How much nearer to the lower end's centre: negative there, positive at the upper end.
        at_low = self.near[low, own] - self.near[low, other]
        at_high = self.near[high, own] - self.near[high, other]
        cut = (own >= 0) & (other >= 0) & (at_low <= 0.0) & (at_high >= 0.0) & (at_low < at_high)
        where = np.zeros(len(cut))
        where[cut] = self.boundaries.crossing(
            self.places[low[cut]], self.places[high[cut]], own[cut], other[cut]
        )
        return Cuts(label=label, cut=cut, where=where)

    def _vertex_labels(self, kept: BoolArray) -> IntArray:
        own = self.label[self.mesh.triangle_polygon]
        around = np.zeros(self.near.shape, np.bool_)
        around[self.corner, own[:, None]] = True
        closed = self._closed(own)
        closed |= (around & kept).any(axis=1, keepdims=True)

        near = np.where(closed, np.inf, self.near)
        label: IntArray = np.where(around, near, np.inf).argmin(axis=1)
        label[~(around & ~closed).any(axis=1)] = -1
        self._spread(label, near)
        return label

    def _closed(self, own: IntArray) -> BoolArray:
        """(P, n) bool: labels that a face at a position is nearer to, and lies wholly beyond."""
        at = self.near_face[self.mesh.triangle_polygon]
        rows = np.arange(len(own))
        triangle, other = np.nonzero(at < at[rows, own][:, None] * _CLEARLY)
        for k in range(3):
            corner = self.corner[triangle, k]
            nearer = self.near[corner, other] < self.near[corner, own[triangle]]
            triangle, other = triangle[nearer], other[nearer]
        closed = np.zeros(self.near.shape, np.bool_)
        for k in range(3):
            closed[self.corner[triangle, k], other] = True
        return closed

    def _spread(self, label: IntArray, near: FloatArray) -> None:
        """Let labels go on along edges to what is nearer to them, in place.

        A vertex may lie across the bisector from all faces around it, whose centroids do not: a
        bulge of the boundary between them. Distances fall with every change, so this ends.
        """
        ways = np.concatenate([self.ends, self.ends[:, ::-1]])
        decided = np.flatnonzero(label >= 0)
        ways = ways[np.isin(ways[:, 0], decided) & np.isin(ways[:, 1], decided)]
        while True:
            to, new = ways[:, 1], label[ways[:, 0]]
            better = near[to, new] < near[to, label[to]]
            to, new = to[better], new[better]
            if not len(to):
                return
            order = np.lexsort((new, near[to, new], to))
            to, first = np.unique(to[order], return_index=True)
            label[to] = new[order][first]
