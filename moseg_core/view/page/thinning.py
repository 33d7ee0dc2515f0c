"""Fewer triangles for a page: vertices that share a cell of a grid become one.

Vertex clustering (Rossignac and Borrel 1993, doi:10.1007/978-3-642-78114-8_29): it takes any
triangles, closed or not, and no longer than to sort them. Each vertex moves to the mean of those in
its cell; a triangle with two corners in one cell is gone, and of several over the same three cells
one is left, with the label that has the most area among them. The grid is refined until about as
many triangles are left as are wanted. The same input gives the same output.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.types import FloatArray, IntArray

#: The grid is taken where it leaves between this share of the triangles that are wanted, and all.
_ENOUGH = 0.85
_TRIES = 8
#: Cells along the longest side: more would not fit into the number of a triangle of cells.
_MOST_CELLS = 2000


@dataclass(frozen=True, eq=False, kw_only=True)
class Triangles:
    """Triangles with labels.

    Parameters
    ----------
    vertices : (V, 3) float, model units
    triangles : (T, 3) int
        Vertex indices.
    labels : (T,) int
    source : (T,) int
        The triangle of the input that each of them is, or stands for.
    """

    vertices: FloatArray
    triangles: IntArray
    labels: IntArray
    source: IntArray


def thinned(given: Triangles, *, most: int) -> Triangles:
    """At most so many triangles that look like those given.

    Parameters
    ----------
    given : Triangles
        With labels from 0.
    most : int
        At least 100.

    Returns
    -------
    Triangles
        The same object where it has no more. A part much smaller than a cell may be gone.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = (grid.ravel() for grid in np.meshgrid(np.arange(101.0), np.arange(101.0)))
    >>> first = np.flatnonzero((x < 100) & (y < 100))
    >>> corners = np.concatenate([first + [[0], [1], [101]], first + [[1], [102], [101]]], axis=1).T
    >>> plane = Triangles(
    ...     vertices=np.column_stack([x, y, 0 * x]),
    ...     triangles=corners,
    ...     labels=(x[corners[:, 0]] > 50).astype(int),
    ...     source=np.arange(len(corners)),
    ... )
    >>> few = thinned(plane, most=2000)
    >>> len(plane.triangles), 1500 < len(few.triangles) <= 2000, np.unique(few.labels).tolist()
    (20000, True, [0, 1])
    """
    if len(given.triangles) <= most:
        return given
    corners = given.vertices[given.triangles]
    extent = float(np.ptp(given.vertices, axis=0).max())
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / extent**2, axis=1
    )
    # A plane of n x n cells has some 2 n^2 triangles; slanted surfaces meet more cells.
    cells = float(np.sqrt(most / max(1e-9, areas.sum())))
    low, high, best = 1.0, float(_MOST_CELLS), None
    for _ in range(_TRIES):
        cells = min(max(cells, low), high)
        left = _clustered(given, areas, int(cells))
        count = len(left.triangles)
        if count <= most and (best is None or count > len(best.triangles)):
            best = left
        if best is not None and len(best.triangles) >= _ENOUGH * most:
            break
        if count > most:
            high = min(high, cells)
        else:
            low = max(low, cells)
        wanted = cells * np.sqrt(0.93 * most / max(count, 1))
        cells = wanted if low < wanted < high else (low + high) / 2.0
    while best is None:  # a soup that hardly thins: coarser, until it does
        cells = max(1.0, cells / 2.0)
        left = _clustered(given, areas, int(cells))
        best = left if len(left.triangles) <= most or cells == 1.0 else None
    return best


def _clustered(given: Triangles, areas: FloatArray, cells: int) -> Triangles:
    """What is left on a grid of so many cells along the longest side."""
    low = given.vertices.min(axis=0)
    side = float(np.ptp(given.vertices, axis=0).max()) / cells
    cell = np.minimum((given.vertices - low) / side, cells - 1).astype(np.int64)
    key = (cell[:, 0] * cells + cell[:, 1]) * cells + cell[:, 2]
    used, cluster = np.unique(key, return_inverse=True)
    n = len(used)
    members = np.bincount(cluster, minlength=n)
    vertices = np.column_stack(
        [np.bincount(cluster, given.vertices[:, axis], n) / members for axis in range(3)]
    )
    corners = cluster[given.triangles]
    a, b, c = np.sort(corners, axis=1).T
    open_ = np.flatnonzero((a != b) & (b != c))
    # Of the triangles over the same cells those of the label with the most area, largest first.
    _, group = np.unique((a[open_] * n + b[open_]) * n + c[open_], return_inverse=True)
    label = given.labels[open_]
    pairs = group * (int(given.labels.max()) + 1) + label
    _, pair = np.unique(pairs, return_inverse=True)
    shared = np.bincount(pair, areas[open_])[pair]
    order = np.lexsort((open_, -areas[open_], label, -shared, group))
    first = order[np.unique(group[order], return_index=True)[1]]
    kept = np.sort(open_[first])
    return Triangles(
        vertices=vertices,
        triangles=corners[kept],
        labels=given.labels[kept],
        source=given.source[kept],
    )
