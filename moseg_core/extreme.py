"""The corners that count: vertices without which convex hulls and extents come out the same.

What is furthest in some direction is furthest in whatever contains it or is contained by it. So
the convex hull of a union of super-elements has its corners among the corners of *their* hulls,
which are found once for a coarse shape: an inner vertex of a super-element that is bent inwards,
saddle-shaped or flat never matters again. Hull volumes and bounding boxes of coarse parts
(:attr:`moseg_core.part.Part.extreme_vertices`) are then those of all vertices, up to rounding, at
the price of a fraction of them: one in three of a mesh whose faces were each cut into sixteen, two
in three of one that is as fine and smooth.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from moseg_core.mesh import PolygonMesh
from moseg_core.types import BoolArray, IntArray, frozen


@dataclass(frozen=True, eq=False)
class Extremes:
    """Vertices that may be corners of a hull, by group of faces.

    Parameters
    ----------
    vertices : (k,) int
        Numbers of vertices, those of one group after those of another; one that several groups
        touch comes several times.
    starts : (K + 1,) int
        Where each group's begin.
    n_vertices : int
        Of the mesh.
    """

    vertices: IntArray
    starts: IntArray
    n_vertices: int

    def of(self, groups: IntArray) -> IntArray:
        """(m,) int: the vertices of some groups, ascending, each once."""
        marked: BoolArray = np.zeros(self.n_vertices, np.bool_)
        sizes = self.starts[groups + 1] - self.starts[groups]
        before = np.cumsum(sizes) - sizes
        inside = np.arange(int(sizes.sum())) + np.repeat(self.starts[groups] - before, sizes)
        marked[self.vertices[inside]] = True
        return np.flatnonzero(marked)


def find_extremes(mesh: PolygonMesh, members: IntArray) -> Extremes:
    """The corners of each group's convex hull.

    Parameters
    ----------
    mesh : PolygonMesh
    members : (F,) int
        The group of each face, 0 to K - 1, each at least once.

    Returns
    -------
    Extremes
        All vertices of a group that lies in a plane, which has no hull to speak of.

    Examples
    --------
    A cube of eight corners and one vertex in the middle of a side, as one group:

    >>> import moseg_core as moseg
    >>> v = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)] + [[0, 0.5, 0.5]]
    >>> f = [[0, 1, 8], [1, 3, 8], [3, 2, 8], [2, 0, 8], [4, 6, 7, 5], [0, 4, 5, 1],
    ...      [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    >>> shape = moseg.Shape.from_mesh(v, f)
    >>> find_extremes(shape.geometry, np.zeros(9, int)).vertices.tolist()
    [0, 1, 2, 3, 4, 5, 6, 7]
    """
    from scipy.spatial import ConvexHull, QhullError

    size = len(mesh.vertices)
    owner = np.repeat(members[mesh.triangle_polygon], 3)
    pairs = np.unique(owner * size + mesh.triangles.reshape(-1))
    groups, vertices = np.divmod(pairs, size)
    bounds = np.searchsorted(groups, np.arange(int(members.max()) + 2))
    kept = []
    for first, last in pairwise(bounds):
        mine = vertices[first:last]
        if len(mine) > 4:
            corners = mesh.vertices[mine]
            with suppress(QhullError):  # a flat group keeps all
                mine = np.sort(mine[ConvexHull(corners - corners.mean(axis=0)).vertices])
        kept.append(mine)
    starts = np.concatenate([[0], np.cumsum([len(mine) for mine in kept])])
    return Extremes(frozen(np.concatenate(kept).astype(np.int64)), frozen(starts), size)
