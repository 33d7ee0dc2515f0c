"""Faces that lie on each other: a surface that has every face twice, once for either side.

Models made for pictures often have each face a second time, turned over, so that it is seen from
both sides (many of ShapeNet are). The signed volumes of the two cancel, so such a surface seems to
enclose nothing, and one that is partly made so seems to enclose the rest alone. One face of each
pair encloses what is meant. But a wall that two boxes share is a pair of faces too, and there it
is both that may be left out.

What is meant shows piece by piece (faces that share edges): where one of each face closes a piece,
it is that; where leaving out both of each pair does, it is that; where neither closes it, it is
whichever leaves fewer open edges. Where the file tells no orientation, since both are there, faces
are turned to agree with their neighbours (:mod:`moseg_core.shape.volume.orientation`), pieces
outward, and those within another one inward, as walls of a cavity.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses, turned_faces
from moseg_core.shape.volume.winding_tree import WindingTree
from moseg_core.types import BoolArray, IntArray


@dataclass(frozen=True, eq=False, kw_only=True)
class OneOfEach:
    """One face of all that lie on each other.

    Parameters
    ----------
    twins : int
        How many faces lie on another one.
    copies : int
        How many lie on an earlier one that looks the same way.
    kept : (F,) bool
        The faces that stand for the surface.
    turned : (F,) bool
        Which of those are turned over.
    uses : EdgeUses
        How those use the edges.
    """

    twins: int
    copies: int
    kept: BoolArray
    turned: BoolArray
    uses: EdgeUses

    def triangles(self, mesh: PolygonMesh) -> IntArray:
        """(T, 3) int: the triangles of the faces that are kept, turned as they should be."""
        triangles = np.where(
            self.turned[mesh.triangle_polygon, None], mesh.triangles[:, ::-1], mesh.triangles
        )
        return triangles[self.kept[mesh.triangle_polygon]]

    def mesh(self, mesh: PolygonMesh) -> PolygonMesh:
        """A mesh of the faces that are kept, as triangles."""
        return of_triangles(mesh, self.triangles(mesh))


def one_of_each(mesh: PolygonMesh, uses: EdgeUses) -> OneOfEach | None:
    """One face of all that lie on each other; None where none do.

    Parameters
    ----------
    mesh : PolygonMesh
    uses : EdgeUses
        Of all its faces.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3], [3, 2, 1]])
    >>> found = one_of_each(tent, EdgeUses.of(tent))
    >>> found.twins, found.kept.tolist()
    (2, [True, True, True, False])
    """
    if not (uses.uses > 2).any():
        return None  # of two faces that nothing else touches nothing can be enclosed
    place, way = _places(mesh)
    count = np.bincount(place)
    if count.max() == 1:
        return None
    net = np.bincount(place, way).astype(np.int64)
    once = np.zeros(len(place), np.bool_)
    # The first that looks the way in which most do.
    fits = (net[place] == 0) | (np.sign(net[place]) == way)
    candidates = np.flatnonzero(fits)
    once[candidates[np.unique(place[candidates], return_index=True)[1]]] = True
    never = once & (net[place] != 0)

    none = np.zeros(len(place), np.bool_)
    single, without = uses.of_faces(once, none), uses.of_faces(never, none)
    piece = _pieces(single, len(place))
    open_single = _open(single, piece)
    open_without = _open(without, piece)
    some = np.bincount(piece, never) > 0
    both_out = some & (open_without < open_single)
    kept = np.where(both_out[piece], never, once)
    free = kept & ~both_out[piece] & (net[place] == 0)
    turned = _turned(mesh, uses.of_faces(kept, none), free, kept)
    return OneOfEach(
        twins=int((count[place] > 1).sum()),
        copies=len(place) - len(np.unique(2 * place + (way > 0))),
        kept=kept,
        turned=turned,
        uses=uses.of_faces(kept, turned),
    )


def of_triangles(mesh: PolygonMesh, triangles: IntArray) -> PolygonMesh:
    """Other triangles, (T, 3) int, over the vertices of a mesh."""
    return replace(
        mesh,
        corners=triangles.reshape(-1),
        offsets=3 * np.arange(len(triangles) + 1),
        triangles=triangles,
        triangle_polygon=np.arange(len(triangles)),
        appearance=None,
    )


def one_sheet(mesh: PolygonMesh) -> PolygonMesh:
    """A mesh with one of all faces that lie on each other; the same where none do."""
    found = one_of_each(mesh, EdgeUses.of(mesh))
    return mesh if found is None or not found.kept.any() else found.mesh(mesh)


def _places(mesh: PolygonMesh) -> tuple[IntArray, IntArray]:
    """For each face the number of the place where it lies, and which way up it is, 1 or -1.

    Faces lie in one place where they have the same corners in the same order, or the reverse.
    """
    position = mesh.merged[mesh.corners]
    sizes = np.diff(mesh.offsets)
    place, way = np.empty(len(sizes), np.int64), np.empty(len(sizes), np.int64)
    found = 0
    for size in np.unique(sizes):
        faces = np.flatnonzero(sizes == size)
        rows = position[mesh.offsets[faces][:, None] + np.arange(size)]
        start = rows.argmin(axis=1)[:, None]
        onward = np.take_along_axis(rows, (start + np.arange(size)) % size, axis=1)
        backward = np.take_along_axis(rows, (start - np.arange(size)) % size, axis=1)
        forward = onward[:, 1] <= onward[:, -1]
        rows = np.where(forward[:, None], onward, backward)
        order = np.lexsort(rows.T[::-1])
        new = np.ones(len(order), np.int64)
        new[1:] = (np.diff(rows[order], axis=0) != 0).any(axis=1)
        place[faces[order]] = found - 1 + np.cumsum(new)
        found += int(new.sum())
        way[faces] = np.where(forward, 1, -1)
    return place, way


def _pieces(uses: EdgeUses, n_faces: int) -> IntArray:
    """(F,) int: the piece of each face, joined by any edges."""
    n_edges = len(uses.uses)
    graph = sparse.coo_array(
        (np.ones(len(uses.edge), np.int8), (uses.face, n_faces + uses.edge)),
        (n_faces + n_edges, n_faces + n_edges),
    )
    return csgraph.connected_components(graph, directed=False)[1][:n_faces].astype(np.int64)


def _open(uses: EdgeUses, piece: IntArray) -> IntArray:
    """(P,) int: how many edges of each piece an odd number of faces use."""
    odd = np.flatnonzero(uses.uses[uses.edge] % 2 == 1)
    once = odd[np.unique(uses.edge[odd], return_index=True)[1]]
    return np.bincount(piece[uses.face[once]], minlength=int(piece.max()) + 1)


def _turned(mesh: PolygonMesh, uses: EdgeUses, free: BoolArray, kept: BoolArray) -> BoolArray:
    """Which faces to turn over: of those whose orientation the file does not tell."""
    weights = np.where(free, 0.0, 1.0)
    turned, piece = turned_faces(uses, weights * kept)
    turned &= free
    triangles = mesh.triangles
    local = mesh.vertices - mesh.vertices[mesh.corners].mean(axis=0)
    whole = kept & (piece >= 0)
    told = np.unique(piece[whole & ~free])
    blank = np.setdiff1d(np.unique(piece[whole]), told)
    if len(blank) == 0:
        return turned
    of_triangle = np.where(kept, piece, -1)[mesh.triangle_polygon]
    over = turned[mesh.triangle_polygon]
    triangles = np.where(over[:, None], triangles[:, ::-1], triangles)
    order = np.argsort(of_triangle, kind="stable")
    found, start = np.unique(of_triangle[order], return_index=True)
    parts = np.split(triangles[order], start[1:])
    sheets = {k: sheet for k, sheet in zip(found.tolist(), parts, strict=True) if k >= 0}
    # What is open is no wall of a cavity.
    closed = blank[_open(uses, piece + 1)[blank + 1] == 0]
    depths = _depths(replace(mesh, vertices=local), sheets, set(closed.tolist()))
    inward = []
    for number in blank.tolist():
        a, b, c = (local[sheets[number][:, k]] for k in range(3))
        middle = (a + b + c).mean(axis=0) / 3.0
        outward = np.einsum("ij,ij->", a - middle, np.cross(b - middle, c - middle)) > 0
        if outward != (depths[number] % 2 == 0):
            inward.append(number)
    return turned ^ (kept & np.isin(piece, inward))


def _depths(moved: PolygonMesh, sheets: dict[int, IntArray], asked: set[int]) -> dict[int, int]:
    """Within how many others each of some sheets of triangles lies."""
    vertices = moved.vertices
    numbers = np.array(list(sheets))
    low = np.array([vertices[sheet].min(axis=(0, 1)) for sheet in sheets.values()])
    high = np.array([vertices[sheet].max(axis=(0, 1)) for sheet in sheets.values()])
    trees: dict[int, WindingTree] = {}
    depths = dict.fromkeys(sheets, 0)
    for i, inner in enumerate(sheets):
        if inner not in asked:
            continue
        around = ((low < low[i]) & (high > high[i])).all(axis=1)
        for outer in numbers[around].tolist():
            if outer not in trees:
                trees[outer] = WindingTree.of(of_triangles(moved, sheets[outer]))
            point = vertices[sheets[inner][0]].mean(axis=0)[None]
            depths[inner] += int(abs(trees[outer].winding(point, np.inf)[0]) > 0.5)
    return depths
