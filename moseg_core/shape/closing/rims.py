"""The rims at which a surface is open: closed loops of edges, and which of them are holes.

Edges that faces run through more often one way than the other make up closed loops, since every
face is one. A loop that touches itself in a vertex is divided there. A cap runs through a rim the
other way than the faces do.

A wall that is cut across, of a pipe or a cup, is open along two rims, around its outer and its
inner side, and its cap is the ring between them. The inner rim is told by the surface that ends
there: seen from a cap of its own, the surface would lie on the side to which the cap looks. So it
is a *hole* in the cap of the smallest rim around it whose surface ends in the same direction. The
two ends of a short piece of pipe without a wall are near each other, too, but their surface goes on
in opposite directions, and each has a cap.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses
from moseg_core.types import BoolArray, FloatArray, IntArray, frozen

#: Farther than so many times its width from the plane of a rim, another one is no hole in its cap.
_NEAR = 0.5


@dataclass(frozen=True, eq=False, kw_only=True)
class Rim:
    """A closed loop of open edges.

    Parameters
    ----------
    ring : (k,) int
        Vertices in the order in which a cap runs through them; none twice.
    area : (3,) float, model units squared
        Vector area of the cap; points to where the cap looks.
    beyond : (3,) float, model units
        Where the surface would go on, summed along the rim.
    face : int
        One of the faces that end here.
    """

    ring: IntArray
    area: FloatArray
    beyond: FloatArray
    face: int

    def __post_init__(self) -> None:
        frozen(self.ring)
        frozen(self.area)
        frozen(self.beyond)

    @property
    def inverted(self) -> bool:
        """Whether a cap of its own would look at the surface that it closes."""
        return bool(self.area @ self.beyond < 0.0)


def find_rims(mesh: PolygonMesh, uses: EdgeUses) -> list[Rim]:
    """The rims of a surface whose faces are oriented alike.

    Parameters
    ----------
    mesh : PolygonMesh
        With one vertex for each position.
    uses : EdgeUses
        Of its faces.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> rim, = find_rims(tent, EdgeUses.of(tent))
    >>> rim.ring.tolist(), rim.area.tolist()
    ([2, 1, 0], [0.0, 0.0, -0.5])
    """
    vertex = np.unique(mesh.merged, return_index=True)[1]
    ends = vertex[mesh.edges[0]]
    balance = uses.balance[uses.edge]
    # Each as often as it is open, in the direction that prevails.
    prevails = np.where(uses.forward, balance, -balance) > 0
    rows = np.flatnonzero(prevails)
    _, first = np.unique(uses.edge[rows], return_index=True)
    rows = rows[np.sort(first)]
    rows = np.repeat(rows, np.abs(balance[rows]))
    normals = _normals(mesh)
    face_at = dict(zip(map(tuple, ends[rows].tolist()), uses.face[rows].tolist(), strict=True))
    found = []
    for loop in _loops(ends[rows]):
        onward = [*loop[1:], loop[0]]
        faces = [face_at[edge] for edge in zip(loop, onward, strict=True)]
        start, stop = mesh.vertices[loop], mesh.vertices[onward]
        middle = start.mean(axis=0)
        found.append(
            Rim(
                ring=np.array(loop[::-1]),
                area=np.cross(stop - middle, start - middle).sum(axis=0) / 2.0,
                beyond=np.cross(stop - start, normals[faces]).sum(axis=0),
                face=faces[0],
            )
        )
    return found


def caps_of(vertices: FloatArray, rims: list[Rim]) -> list[list[Rim]]:
    """The rims that bound a cap together: first the one around, then the holes in it.

    Parameters
    ----------
    vertices : (V, 3) float
    rims : list of Rim
        Of a surface that is outside out.
    """
    around: dict[int, list[Rim]] = {k: [rim] for k, rim in enumerate(rims) if not rim.inverted}
    caps = list(around.values())
    for rim in rims:
        if not rim.inverted:
            continue
        fit = [k for k in around if _is_hole(vertices, rim, rims[k])]
        if fit:
            around[min(fit, key=lambda k: float(np.linalg.norm(rims[k].area)))].append(rim)
        else:
            caps.append([rim])
    return caps


def _loops(edges: IntArray) -> list[list[int]]:
    """Directed edges, as many to each vertex as from it, as loops that visit no vertex twice."""
    after: defaultdict[int, list[int]] = defaultdict(list)
    for start, stop in edges.tolist():
        after[start].append(stop)
    loops = []
    for start in list(after):
        while after[start]:
            path, place = [start], {start: 0}
            while True:
                here = after[path[-1]].pop()
                if here not in place:
                    place[here] = len(path)
                    path.append(here)
                    continue
                loop = path[place[here] :]
                loops.append(loop)
                for vertex in loop[1:]:
                    del place[vertex]
                del path[place[here] + 1 :]
                if here == start:
                    break
    return loops


def _normals(mesh: PolygonMesh) -> FloatArray:
    """(F, 3) float: unit normals of the polygons, 0 of those without area."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    total = np.stack(
        [np.bincount(mesh.triangle_polygon, cross[:, k], mesh.n_polygons) for k in range(3)], axis=1
    )
    length = np.linalg.norm(total, axis=1, keepdims=True)
    normals: FloatArray = total / np.where(length > 0, length, 1.0)
    return normals


def _is_hole(vertices: FloatArray, inner: Rim, outer: Rim) -> bool:
    """Whether a rim lies within another, near its plane, and its surface ends the same way."""
    size = float(np.linalg.norm(outer.area))
    if size == 0.0 or inner.area @ outer.area >= 0.0 or inner.beyond @ outer.area <= 0.0:
        return False
    normal = outer.area / size
    points, ring = vertices[inner.ring], vertices[outer.ring]
    middle = ring.mean(axis=0)
    if abs(float((points.mean(axis=0) - middle) @ normal)) > _NEAR * np.sqrt(size):
        return False
    # Two directions of the plane, such that the ring turns left in it.
    first = np.cross(normal, np.eye(3)[int(np.argmin(np.abs(normal)))])
    first /= np.linalg.norm(first)
    plane = np.stack([first, np.cross(normal, first)], axis=1)
    return bool(inside_ring((points - middle) @ plane, (ring - middle) @ plane).all())


def inside_ring(points: FloatArray, ring: FloatArray) -> BoolArray:
    """Whether points lie inside a polygon of the plane, by how often a ray crosses it.

    Parameters
    ----------
    points : (n, 2) float
    ring : (k, 2) float

    Examples
    --------
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> inside_ring(np.array([[1.0, 1], [3, 1]]), square).tolist()
    [True, False]
    """
    a, b = ring, np.roll(ring, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    spans = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
    left = x < a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    crossed: BoolArray = (spans & left).sum(axis=1) % 2 == 1
    return crossed
