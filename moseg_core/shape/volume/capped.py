"""The volume of an open surface, by a cap over each loop of its boundary.

A part that was cut out of a surface encloses no volume by itself; it is closed first, by a cap
over each loop of its boundary. A cap is a fan of triangles from the loop's edges to the loop's
centroid, the mean of its points by length, which does not depend on how the edges are divided.
Over a plane loop the fan is the flat lid, whatever the loop's outline: triangles that overlap have
opposite signs. So what is cut off along planes has exactly the volume of the solid cut along them.

The volume is the sum of the signed tetrahedra over the faces and the caps. It takes no more than
the boundary's edges: those that the faces run through more often one way than the other. Two
loops that touch in one vertex are told apart; they are different *blocks* of the graph of these
edges, which no single vertex separates.

Parts that are segmented in their turn have this volume (:mod:`moseg_core.shape.volume.derived`),
and so do the objectives that ask how much a part fills. Where faces are not oriented alike, the
caps themselves can still be made (:func:`with_caps`): over loops of edges that an odd number of
faces use.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

import numpy as np

from moseg_core.shape.adjacency import undirected
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.positions import find_positions
from moseg_core.shape.volume.orientation import EdgeUses
from moseg_core.shape.volume.twins import of_triangles, one_of_each
from moseg_core.types import FloatArray, IntArray


def capped_volume(
    vertices: FloatArray, triangles: IntArray, merged: IntArray | None = None
) -> float:
    """Volume of a surface after its boundary loops are capped.

    Parameters
    ----------
    vertices : (V, 3) float, model units
        Near the origin, for accuracy.
    triangles : (T, 3) int
        Should be oriented alike, all outward or all inward; no matter which. Of triangles that
        are not, the volumes cancel; but of those that lie on each other, as for two sides of a
        surface, one of each counts (:mod:`moseg_core.shape.volume.twins`).
    merged : (V,) int, optional
        Number of each vertex's position, as :attr:`PolygonMesh.merged`; those at one position are
        one. By default that is those that are equal.

    Returns
    -------
    float, model units cubed
        Not negative. Pieces add up, and a piece that is turned inside out within another, the
        wall of a cavity, is subtracted.

    Examples
    --------
    >>> tent = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> round(capped_volume(tent, np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3]])), 6)
    0.166667
    """
    if merged is None:
        merged = find_positions(vertices).number
    positions, edges, counts, crowded = _boundary(vertices, triangles, merged)
    if crowded:
        # Only there can faces lie on each other that enclose anything.
        place = _vertex_at(merged)
        mesh = PolygonMesh.from_faces(vertices[place[merged]], triangles, weld=0.0)
        single = one_of_each(mesh, EdgeUses.of(mesh))
        if single is not None and single.kept.any():
            triangles = single.triangles(mesh)
            positions, edges, counts, _ = _boundary(vertices, triangles, merged)
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c)))
    if len(edges):
        start, stop = positions[edges[:, 0]], positions[edges[:, 1]]
        loop = _blocks(edges)
        centroids = _centroids(loop, start, stop, counts)
        # A cap runs through the loop's edges the other way.
        caps = np.einsum("ij,ij->i", centroids[loop], np.cross(stop, start))
        volume += float(counts @ caps)
    return abs(volume) / 6.0


def with_caps(mesh: PolygonMesh) -> PolygonMesh:
    """A surface as triangles, with caps over its boundary; faces need not be oriented alike.

    Parameters
    ----------
    mesh : PolygonMesh

    Returns
    -------
    PolygonMesh
        The triangles of `mesh`, followed by those of the caps, oriented anyhow; joined within
        the same tolerance.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [2, 1, 3], [2, 0, 3]])
    >>> closed = with_caps(tent)
    >>> closed.n_polygons, closed.vertices[-1].round(2).tolist()
    (6, [0.35, 0.35, 0.0])
    """
    ends, group = undirected(mesh.edges[0])
    edges = ends[np.bincount(group) % 2 == 1]
    if len(edges) == 0:
        return mesh
    vertex = np.unique(mesh.merged, return_index=True)[1][edges]
    start, stop = mesh.vertices[vertex[:, 0]], mesh.vertices[vertex[:, 1]]
    loop = _blocks(edges)
    centroids = _centroids(loop, start, stop, np.ones(len(edges), np.int64))
    fans = np.column_stack([vertex, len(mesh.vertices) + loop])
    closed = replace(mesh, vertices=np.concatenate([mesh.vertices, centroids]))
    return of_triangles(closed, np.concatenate([mesh.triangles, fans]))


def _centroids(loop: IntArray, start: FloatArray, stop: FloatArray, counts: IntArray) -> FloatArray:
    """(l, 3) float: the mean by length of each loop's edges, which count so many times."""
    lengths = np.linalg.norm(stop - start, axis=1) * counts
    total = np.bincount(loop, lengths)
    middles = (start + stop) / 2.0
    return np.stack([np.bincount(loop, lengths * middles[:, k]) / total for k in range(3)], axis=1)


def _boundary(
    vertices: FloatArray, triangles: IntArray, merged: IntArray
) -> tuple[FloatArray, IntArray, IntArray, bool]:
    """The directed edges at which a surface is open.

    Returns
    -------
    positions : (p, 3) float
    edges : (e, 2) int
        Positions; of edges that are not balanced, in the direction that prevails.
    counts : (e,) int
        By how many it does.
    crowded : bool
        Whether any edge, balanced or not, has more than two uses.
    """
    corners = merged[triangles]
    ends = np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)])
    size = int(merged.max(initial=-1)) + 1
    # First by number, which leaves little to be compared by position.
    ends, counts, most = _net(ends, np.ones(len(ends), np.int64), size)
    used, compact = np.unique(ends, return_inverse=True)
    # Adding 0.0 turns -0.0 into 0.0, which compare equal but differ in their bytes.
    places = vertices[_vertex_at(merged)[used]] + 0.0
    positions, place = np.unique(places, axis=0, return_inverse=True)
    edges = place.reshape(-1)[compact.reshape(-1, 2)]
    edges, counts, _ = _net(edges, counts, len(positions))
    return positions, edges, counts, most > 2


def _vertex_at(merged: IntArray) -> IntArray:
    """For each position the number of a vertex there."""
    vertex = np.empty(int(merged.max(initial=-1)) + 1, np.int64)
    vertex[merged] = np.arange(len(merged))
    return vertex


def _net(ends: IntArray, counts: IntArray, size: int) -> tuple[IntArray, IntArray, int]:
    """Edges in the direction that prevails, with what remains, and the most uses of any.

    Balanced ones and those of no length are left out of the first two.
    """
    low, high = ends.min(axis=1), ends.max(axis=1)
    signed = np.where(ends[:, 0] == low, counts, -counts) * (low != high)
    code, group = np.unique(low * np.int64(size) + high, return_inverse=True)
    group = group.reshape(-1)
    net = np.bincount(group, signed, minlength=len(code)).astype(np.int64)
    most = int(np.bincount(group, signed != 0).max(initial=0))
    code, net = code[net != 0], net[net != 0]
    edges = np.stack(np.divmod(code, max(size, 1)), axis=1)
    edges[net < 0] = edges[net < 0, ::-1]
    return edges, np.abs(net), most


def _blocks(edges: IntArray) -> IntArray:
    """The block of each edge in an undirected graph, numbered from 0 (Hopcroft and Tarjan)."""
    incident: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for number, (u, v) in enumerate(edges.tolist()):
        incident[u].append((number, v))
        incident[v].append((number, u))
    block = np.full(len(edges), -1)
    found = 0
    depth: dict[int, int] = {}
    low: dict[int, int] = {}
    for root in incident:
        if root in depth:
            continue
        depth[root] = low[root] = 0
        pending: list[int] = []  # edges that have no block yet
        path = [(root, -1, iter(incident[root]))]
        while path:
            here, entry, rest = path[-1]
            for number, there in rest:
                if number == entry:
                    continue
                if there not in depth:
                    pending.append(number)
                    depth[there] = low[there] = len(path)
                    path.append((there, number, iter(incident[there])))
                    break
                if depth[there] < depth[here]:
                    pending.append(number)
                    low[here] = min(low[here], depth[there])
            else:
                path.pop()
                if not path:
                    break
                parent = path[-1][0]
                low[parent] = min(low[parent], low[here])
                if low[here] >= depth[parent]:
                    first = pending.index(entry)
                    block[pending[first:]] = found
                    del pending[first:]
                    found += 1
    return block
