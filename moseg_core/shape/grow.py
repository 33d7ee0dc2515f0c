"""Growing connected pieces from seeds over the element graph, for coarse shapes.

Every element goes to the seed that is nearest along the graph, an edge being as long as its two
elements are apart. That is Dijkstra's algorithm from many sources at once: a piece is a subtree
of the shortest paths, hence connected. An element that no seed reaches becomes a seed itself, so
that every connected component has at least one. Ties go by (distance, element).
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.compiled import kernel
from moseg_core.shape.heap import push, sift
from moseg_core.types import FloatArray, Int32Array, IntArray


@kernel
def grow_pieces(
    points: FloatArray, indptr: Int32Array, indices: Int32Array, seeds: IntArray, members: IntArray
) -> int:
    """The piece of each element, written into `members`.

    Parameters
    ----------
    points : (F, 3) float
    indptr, indices : (F + 1,), (E,) int32
        Adjacency in CSR form.
    seeds : (n,) int
        Different elements; piece ``k`` grows from ``seeds[k]``.
    members : (F,) int, written

    Returns
    -------
    int
        Number of pieces, ``n`` and those of unreached components.
    """
    size = points.shape[0]
    distance = np.full(size, np.inf)
    key = np.empty(len(indices) + size + 1)
    code = np.empty(len(indices) + size + 1, np.int64)
    members[:] = -1
    count, pieces = 0, 0
    for s in seeds:
        members[s] = pieces
        distance[s] = 0.0
        count = push(key, code, count, 0.0, s)
        pieces += 1
    unreached = 0
    while True:
        while count > 0:
            d, f = key[0], code[0]
            count -= 1
            sift(key, code, count, key[count], code[count])
            if d > distance[f]:
                continue
            for e in range(indptr[f], indptr[f + 1]):
                g = indices[e]
                dx = points[g, 0] - points[f, 0]
                dy = points[g, 1] - points[f, 1]
                dz = points[g, 2] - points[f, 2]
                further = d + np.sqrt(dx * dx + dy * dy + dz * dz)
                if further < distance[g]:
                    distance[g] = further
                    members[g] = members[f]
                    count = push(key, code, count, further, g)
        while unreached < size and members[unreached] >= 0:
            unreached += 1
        if unreached == size:
            return pieces
        members[unreached] = pieces
        distance[unreached] = 0.0
        count = push(key, code, count, 0.0, unreached)
        pieces += 1


@kernel
def middle_elements(
    points: FloatArray, areas: FloatArray, members: IntArray, pieces: int
) -> IntArray:
    """(n,) int: the element of each piece that is nearest to its centroid.

    Parameters
    ----------
    points : (F, 3) float
    areas : (F,) float
        A piece of no area has the mean of its points for a centroid.
    members : (F,) int
        0 to `pieces` - 1, each at least once.
    pieces : int
    """
    size = points.shape[0]
    weight = np.zeros(pieces)
    number = np.zeros(pieces)
    center = np.zeros((pieces, 3))
    plain = np.zeros((pieces, 3))
    for f in range(size):
        k = members[f]
        weight[k] += areas[f]
        number[k] += 1.0
        for j in range(3):
            center[k, j] += areas[f] * points[f, j]
            plain[k, j] += points[f, j]
    for k in range(pieces):
        for j in range(3):
            if weight[k] > 0.0:
                center[k, j] /= weight[k]
            else:
                center[k, j] = plain[k, j] / number[k]
    middle = np.full(pieces, -1, np.int64)
    nearest = np.full(pieces, np.inf)
    for f in range(size):
        k = members[f]
        dx = points[f, 0] - center[k, 0]
        dy = points[f, 1] - center[k, 1]
        dz = points[f, 2] - center[k, 2]
        apart = dx * dx + dy * dy + dz * dz
        if middle[k] < 0 or apart < nearest[k]:
            nearest[k] = apart
            middle[k] = f
    return middle
