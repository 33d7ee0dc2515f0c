"""How far one part is from its own convex hull: convex (Sec. 3), and the volume of an open part.

The paper names ``convex`` without a formula. A part that was cut out of a surface encloses no
volume by itself; it is closed first, by a cap over each loop of its boundary. A cap is a fan of
triangles from the loop's edges to the loop's centroid, the mean of its points by length, which
does not depend on how the edges are divided. Over a plane loop the fan is the flat lid, whatever
the loop's outline: triangles that overlap have opposite signs. So a convex part that was cut
along planes is exactly convex.

The volume is the sum of the signed tetrahedra over the faces and the caps. It takes no more than
the boundary's edges: those that the faces run through more often one way than the other. Two
loops that touch in one vertex are told apart; they are different *blocks* of the graph of these
edges, which no single vertex separates.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import numpy.typing as npt

from moseg_core import Part, objective

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]


def closed_volume(part: Part) -> float:
    """Volume of a part after its boundary loops are capped, model units cubed.

    Parameters
    ----------
    part : Part
        Its faces should be oriented alike, all outward or all inward; no matter which. Of faces
        that are not, the volumes cancel.

    Returns
    -------
    float
        Not negative. Pieces add up, and a piece that is turned inside out within another, the
        wall of a cavity, is subtracted.

    Examples
    --------
    >>> from moseg_core import Shape, Segmentation
    >>> tent = Shape.from_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                        [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> part = Segmentation.from_labels(tent, [0, 0, 0], 1).parts[0]
    >>> round(part.measure("basic:closed_volume"), 6)
    0.166667
    """
    corners = part.vertices - part.centroid
    triangles = part.triangles
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    volume = float(np.einsum("ij,ij->", a, np.cross(b, c)))
    positions, edges, counts = _boundary(corners, triangles)
    if len(edges):
        start, stop = positions[edges[:, 0]], positions[edges[:, 1]]
        loop = _blocks(edges)
        lengths = np.linalg.norm(stop - start, axis=1) * counts
        total = np.bincount(loop, lengths)
        middles = (start + stop) / 2.0
        centroids = np.stack(
            [np.bincount(loop, lengths * middles[:, k]) / total for k in range(3)], axis=1
        )
        # A cap runs through the loop's edges the other way.
        caps = np.einsum("ij,ij->i", centroids[loop], np.cross(stop, start))
        volume += float(counts @ caps)
    return abs(volume) / 6.0


def _boundary(vertices: FloatArray, triangles: IntArray) -> tuple[FloatArray, IntArray, IntArray]:
    """(positions, (e, 2) directed edges that are not balanced, by how many each)."""
    ends = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    # First by number, which leaves little to be compared by position.
    ends, counts = _net(ends, np.ones(len(ends), np.int64), len(vertices))
    used, compact = np.unique(ends, return_inverse=True)
    # Adding 0.0 turns -0.0 into 0.0, which compare equal but differ in their bytes.
    positions, merged = np.unique(vertices[used] + 0.0, axis=0, return_inverse=True)
    edges = merged.reshape(-1)[compact.reshape(-1, 2)]
    return positions, *_net(edges, counts, len(positions))


def _net(ends: IntArray, counts: IntArray, size: int) -> tuple[IntArray, IntArray]:
    """Edges in the direction that prevails, with what remains; balanced ones left out."""
    low, high = ends.min(axis=1), ends.max(axis=1)
    signed = np.where(ends[:, 0] == low, counts, -counts) * (low != high)
    code, group = np.unique(low * np.int64(size) + high, return_inverse=True)
    net = np.bincount(group.reshape(-1), signed, minlength=len(code)).astype(np.int64)
    code, net = code[net != 0], net[net != 0]
    edges = np.stack(np.divmod(code, max(size, 1)), axis=1)
    edges[net < 0] = edges[net < 0, ::-1]
    return edges, np.abs(net)


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


@objective(
    range=(0, 1),
    requires=("surface",),
    invariant_to=("rigid", "scale", "reflection", "order", "tessellation"),
    cost="moderate",
)
def convex(part: Part) -> float:
    """Small for a part that fills its convex hull: ``(H(P) - V(P)) / H(P)``.

    Parameters
    ----------
    part : Part
        May be open and in several pieces.

    Returns
    -------
    float
        ``H(P)`` is the volume of the hull, ``V(P)`` that of the part once each loop of its
        boundary is capped (:func:`closed_volume`). 0 for a convex part, also for one that is cut
        off along planes, and for one in a plane; up to 1 the less of its hull a part fills; 0 is
        best. Rounding, or faces that overlap, can make ``V`` greater than ``H``: 0 then.

    Notes
    -----
    Named in Simari & Singh, Sec. 3. Unlike ``convex_parts`` it is about one part, bounded, and
    needs no shape that encloses a volume; the hulls of two convex parts may well overlap.

    A boundary that runs in a zigzag along the faces has teeth that push the hull outward
    and a cap with dents between them, which count: each half of an ellipsoid of 300, 1300 and
    5000 faces has 0.16, 0.10 and 0.06. That is a floor below which differences mean nothing. A
    dent by itself, the inside of a bowl, is as convex as a bump. A part thinner than 1e-7 of its
    length counts as plane.

    Examples
    --------
    >>> from moseg_core import Problem, Shape
    >>> ell = Shape.from_mesh(
    ...     [[x, y, z] for z in (0, 1)
    ...      for x, y in ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))],
    ...     [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], [0, 1, 7, 6], [1, 2, 8, 7],
    ...      [2, 3, 9, 8], [3, 4, 10, 9], [4, 5, 11, 10], [5, 0, 6, 11]])
    >>> found = Problem(["a"], "convex(a)").evaluate(ell, [0] * 8)
    >>> round(found.cost.value * 7, 9)  # 3 of 3.5
    1.0
    """
    hull = part.measure("basic:hull_volume")
    if part.scales[2] == 0.0 or hull == 0.0:
        return 0.0
    return float(min(1.0, max(0.0, 1.0 - part.measure("basic:closed_volume") / hull)))
