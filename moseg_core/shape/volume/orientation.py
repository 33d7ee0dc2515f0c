"""How faces use edges, and which of them are turned over.

Two faces that are oriented alike run through their common edge in opposite directions. So along
edges with two faces the side that one face calls its front says which side the next one should.
In a graph that has every face twice, once either way up, faces are linked with those that agree
with them; a component of the graph is a piece of the surface, one way up. Where a face is in one
component both ways up, the piece has one side only, as a Moebius strip.

Edges with three or more faces say nothing: of which two of them are neighbours on one sheet they do
not tell. :mod:`moseg_core.shape.volume.enclosed` asks why a surface encloses no volume,
:mod:`moseg_core.shape.volume.estimated` and :mod:`moseg_core.shape.volume.twins` turn faces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.shape.adjacency import undirected
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class EdgeUses:
    """How the faces of a mesh use its edges.

    Parameters
    ----------
    edge : (C,) int
        Number of the undirected edge of each directed one in :attr:`PolygonMesh.edges`.
    face : (C,) int
        The face that it belongs to.
    forward : (C,) bool
        Whether it runs through the undirected edge from its first end to its second.
    uses : (E,) int
        How often each undirected edge is run through: 1 at the rim of an open surface, 2 within.
    balance : (E,) int
        How much more often forward than backward.
    """

    edge: IntArray
    face: IntArray
    forward: BoolArray
    uses: IntArray
    balance: IntArray

    def __post_init__(self) -> None:
        for array in (self.edge, self.face, self.forward, self.uses, self.balance):
            frozen(array)

    @classmethod
    def of(cls, mesh: PolygonMesh) -> EdgeUses:
        """Count the uses of the edges of a mesh.

        Examples
        --------
        >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
        >>> sorted(EdgeUses.of(tent).uses.tolist())
        [1, 1, 1, 2, 2, 2]
        """
        ends, face = mesh.edges
        edge, group = undirected(ends)
        forward = ends[:, 0] == edge[group, 0]
        return cls.counted(group, face, forward, len(edge))

    @classmethod
    def counted(cls, edge: IntArray, face: IntArray, forward: BoolArray, n_edges: int) -> EdgeUses:
        """Count what was found already."""
        balance = np.bincount(edge, np.where(forward, 1, -1), n_edges).astype(np.int64)
        uses = np.bincount(edge, minlength=n_edges)
        return cls(edge=edge, face=face, forward=forward, uses=uses, balance=balance)

    def of_faces(self, kept: BoolArray, turned: BoolArray) -> EdgeUses:
        """The same of some faces only, some of them turned over; faces keep their numbers."""
        mine = kept[self.face]
        face = self.face[mine]
        forward = self.forward[mine] != turned[face]
        return EdgeUses.counted(self.edge[mine], face, forward, len(self.uses))

    @property
    def pairs(self) -> IntArray:
        """(k, 2) int: places of the two directed edges of each edge with two uses."""
        order = np.argsort(self.edge, kind="stable")
        paired: IntArray = order[self.uses[self.edge[order]] == 2].reshape(-1, 2)
        return paired


def turned_faces(uses: EdgeUses, weights: FloatArray) -> tuple[BoolArray, IntArray]:
    """Which faces to turn over so that neighbours across edges with two faces agree.

    Parameters
    ----------
    uses : EdgeUses
    weights : (F,) float
        How much a face's own orientation counts, such as its area; the lesser part of each piece
        is turned.

    Returns
    -------
    turned : (F,) bool
        None of a piece that has one side only.
    piece : (F,) int
        The piece of each face, joined by edges with two faces; -1 where that has one side only.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [0, 2, 3]])
    >>> turned, piece = turned_faces(EdgeUses.of(tent), np.ones(3))
    >>> turned.tolist(), piece.tolist()
    ([False, False, True], [0, 0, 0])
    """
    size = len(weights)
    first, second = uses.pairs.T
    f, g = uses.face[first], uses.face[second]
    alike = uses.forward[first] != uses.forward[second]
    # Face f as it is has the number f, turned over f + size.
    rows = np.concatenate([f, f + size])
    columns = np.concatenate([np.where(alike, g, g + size), np.where(alike, g + size, g)])
    graph = sparse.coo_array((np.ones(len(rows), np.int8), (rows, columns)), (2 * size, 2 * size))
    count, way = csgraph.connected_components(graph, directed=False)
    upright, over = way[:size], way[size:]
    two_sided = upright != over
    # Of the two ways up of a piece the one in which more of it is as it was.
    kept = np.bincount(upright, weights, count)
    turned = two_sided & (kept[over] > kept[upright])
    ties = two_sided & (kept[over] == kept[upright])
    turned |= ties & (over < upright)
    piece = np.where(two_sided, np.minimum(upright, over), -1)
    return turned, piece
