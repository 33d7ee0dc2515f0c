"""A surface as a closed solid: each rim is capped, and the outside is out.

What parts need to be printed, weighed or counted as solids. A part was cut out of a surface along
the edges of its mesh, or across its faces where it was clipped, and is open there; it may be open
where the shape was. Every rim is capped (:mod:`moseg_core.shape.closing.rims`) over its own points
(:mod:`moseg_core.shape.closing.fill`). Afterwards every edge has two faces, which run through it in
opposite directions: what printers' and modellers' programs call watertight.

Before that the surface is put in order: vertices at one position become one, faces without extent
are left out, of faces that lie on each other one stays, faces are turned to agree with their
neighbours, and loose pieces to enclose a positive volume. A piece inside out whose bounding box
lies in that of another is the wall of a cavity, and stays.

The faces stay the polygons that they were; caps are triangles behind them. Where an edge has more
than two faces, or a surface has one side only, that cannot be mended here, and it is said.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from moseg_core.shape.closing.fill import bridged, edges_of, fill
from moseg_core.shape.closing.rims import Rim, caps_of, find_rims
from moseg_core.shape.geometry import ranges
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses, turned_faces
from moseg_core.shape.volume.twins import one_of_each
from moseg_core.types import BoolArray, FloatArray, IntArray

#: Below this share of the cubed diagonal a volume is rounding.
_FLAT = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class Closed:
    """A surface with caps over its rims.

    Parameters
    ----------
    mesh : PolygonMesh
        With one vertex for each position, outside out; caps come last.
    caps : int
        How many there are.
    volume : float, model units cubed
        What it encloses; 0 where it is not closed.
    reason : str
        Why it is no closed solid; empty where it is one.
    """

    mesh: PolygonMesh
    caps: int
    volume: float
    reason: str


def close(mesh: PolygonMesh) -> Closed:
    """Cap all rims of a surface.

    Parameters
    ----------
    mesh : PolygonMesh

    Returns
    -------
    Closed
        With a reason where the surface cannot be closed, or encloses nothing.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> solid = close(tent)
    >>> solid.caps, round(solid.volume, 6), solid.mesh.n_polygons, solid.reason
    (1, 0.166667, 4, '')
    """
    single = one_of_each(mesh, EdgeUses.of(mesh))
    if single is not None and single.kept.any():
        mesh = single.mesh(mesh)
    mesh = joined(mesh)
    if mesh.n_polygons == 0:
        return Closed(mesh=mesh, caps=0, volume=0.0, reason="it has no face with an area")
    uses = EdgeUses.of(mesh)
    if ((uses.uses == 2) & (uses.balance != 0)).any():
        turned, piece = turned_faces(uses, _areas(mesh))
        if (piece < 0).any():
            reason = "its surface has one side only, like a Moebius strip"
            return Closed(mesh=mesh, caps=0, volume=0.0, reason=reason)
        mesh = _with_turned(mesh, turned)
        uses = EdgeUses.of(mesh)
    rims = find_rims(mesh, uses)
    inside_out = _inside_out(mesh, uses, rims)
    if inside_out.any():
        mesh = _with_turned(mesh, inside_out)
        uses = EdgeUses.of(mesh)
        rims = find_rims(mesh, uses)
    caps = caps_of(mesh.vertices, rims)
    closed = _with_caps(mesh, caps)
    volume = float(_volumes(closed.vertices, closed.triangles).sum())
    least = _FLAT * closed.diagonal**3
    if volume <= least and caps:
        # Of a thin leaf the least caps may lie beyond the surface: bulge them to the middles.
        bulged = _with_caps(mesh, caps, from_middles=True)
        more = float(_volumes(bulged.vertices, bulged.triangles).sum())
        closed, volume = (bulged, more) if more > least else (closed, volume)
    crowded = int((EdgeUses.of(closed).uses > 2).sum())
    reason = ""
    if crowded:
        reason = f"{crowded} of its edges have more than two faces"
    elif volume <= least:
        reason = "it is flat, also with its rims capped"
    return Closed(mesh=closed, caps=len(caps), volume=0.0 if reason else volume, reason=reason)


def joined(mesh: PolygonMesh) -> PolygonMesh:
    """A mesh with one vertex for each position that is used, without faces of no extent.

    Parameters
    ----------
    mesh : PolygonMesh

    Returns
    -------
    PolygonMesh
        Polygons keep their order; those of fewer than three positions are left out.

    Examples
    --------
    >>> soup = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0],
    ...                                [0, 1, 0]], [[0, 1, 2], [3, 4, 5], [0, 1, 3]])
    >>> once = joined(soup)
    >>> len(once.vertices), once.n_polygons
    (4, 2)
    """
    corners = mesh.merged[mesh.corners]
    polygon = np.repeat(np.arange(mesh.n_polygons), np.diff(mesh.offsets))
    following = np.arange(1, len(corners) + 1)
    following[mesh.offsets[1:] - 1] = mesh.offsets[:-1]
    kept = corners != corners[following]
    triangles = mesh.merged[mesh.triangles]
    a, b, c = triangles.T
    real = (a != b) & (b != c) & (c != a)
    # A polygon needs three corners, and a triangle that shows.
    whole = np.bincount(polygon[kept], minlength=mesh.n_polygons) >= 3
    whole &= np.bincount(mesh.triangle_polygon[real], minlength=mesh.n_polygons) > 0
    kept &= whole[polygon]
    real &= whole[mesh.triangle_polygon]
    sizes = np.bincount(polygon[kept], minlength=mesh.n_polygons)[whole]
    number = np.cumsum(whole) - 1
    used, corners = np.unique(corners[kept], return_inverse=True)
    place = np.unique(mesh.merged, return_index=True)[1]
    return PolygonMesh(
        vertices=mesh.vertices[place[used]],
        corners=corners.reshape(-1).astype(np.int64),
        offsets=np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        triangles=np.searchsorted(used, triangles[real]),
        triangle_polygon=number[mesh.triangle_polygon[real]],
    )


def _areas(mesh: PolygonMesh) -> FloatArray:
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    double: FloatArray = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return np.bincount(mesh.triangle_polygon, double).astype(np.float64)


def _with_turned(mesh: PolygonMesh, turned: BoolArray) -> PolygonMesh:
    """The mesh with some of its polygons run through the other way."""
    sizes = np.diff(mesh.offsets)
    place = np.arange(len(mesh.corners)) - np.repeat(mesh.offsets[:-1], sizes)
    back = np.repeat(mesh.offsets[1:], sizes) - 1 - place
    over = np.repeat(turned, sizes)
    flipped = turned[mesh.triangle_polygon]
    return replace(
        mesh,
        corners=np.where(over, mesh.corners[back], mesh.corners),
        triangles=np.where(flipped[:, None], mesh.triangles[:, ::-1], mesh.triangles),
    )


def _volumes(vertices: FloatArray, triangles: IntArray) -> FloatArray:
    """(T,) float: signed volumes of the tetrahedra from the middle to some triangles."""
    local = vertices - vertices.mean(axis=0)
    a, b, c = (local[triangles[:, k]] for k in range(3))
    volumes: FloatArray = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    return volumes


def _inside_out(mesh: PolygonMesh, uses: EdgeUses, rims: list[Rim]) -> BoolArray:
    """(F,) bool: the faces of pieces that are inside out, and no walls of a cavity."""
    n_faces, n_edges = mesh.n_polygons, len(uses.uses)
    graph = sparse.coo_array(
        (np.ones(len(uses.edge), np.int8), (uses.face, n_faces + uses.edge)),
        (n_faces + n_edges, n_faces + n_edges),
    )
    count, node = csgraph.connected_components(graph, directed=False)
    piece = node[:n_faces]
    local = mesh.vertices - mesh.vertices.mean(axis=0)
    volume = np.bincount(
        piece[mesh.triangle_polygon], _volumes(mesh.vertices, mesh.triangles), count
    )
    for rim in rims:
        ring = local[rim.ring]
        fan = np.cross(ring, np.roll(ring, -1, axis=0)) @ ring.mean(axis=0)
        volume[piece[rim.face]] += float(fan.sum()) / 6.0
    if (volume >= 0.0).all():
        return np.zeros(n_faces, np.bool_)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    owner = np.repeat(piece, np.diff(mesh.offsets))
    np.minimum.at(low, owner, mesh.vertices[mesh.corners])
    np.maximum.at(high, owner, mesh.vertices[mesh.corners])
    # Where the file has everything inside out, cavities are so too: the largest piece tells.
    reverse = volume[np.argmax(np.abs(volume))] < 0.0
    unlike = (volume > 0.0) if reverse else (volume < 0.0)
    within = np.zeros(count, np.bool_)
    for k in np.flatnonzero(unlike).tolist():
        around = ((low <= low[k]) & (high >= high[k])).all(axis=1)
        around[k] = False
        within[k] = around.any()
    wrong = (volume < 0.0) | within if reverse else unlike & ~within
    return wrong[piece]


def _with_caps(
    mesh: PolygonMesh, caps: list[list[Rim]], *, from_middles: bool = False
) -> PolygonMesh:
    """The mesh with triangles over its rims, behind its own polygons.

    Each cap is filled over its own points, or else, or where that cannot be, each of its rims from
    a new point in its middle.
    """
    if not caps:
        return mesh
    barred = _pairs_of_faces(mesh, np.concatenate([rim.ring for cap in caps for rim in cap]))
    added: list[IntArray] = []
    middles: list[FloatArray] = []
    for cap in caps:
        made: IntArray | None = None
        if not from_middles:
            bridges = set(barred)
            loop = bridged(mesh.vertices, [rim.ring for rim in cap], bridges)
            made = fill(mesh.vertices, loop, bridges)
        if made is None:
            fans = []
            for rim in cap:
                middle = np.full(len(rim.ring), len(mesh.vertices) + len(middles))
                middles.append(mesh.vertices[rim.ring].mean(axis=0))
                fans.append(np.stack([rim.ring, np.roll(rim.ring, -1), middle], axis=1))
            made = np.concatenate(fans)
        barred |= edges_of(made)
        added.append(made)
    new = np.concatenate(added)
    faces = mesh.n_polygons
    ends = mesh.offsets[-1] + 3 * np.arange(1, len(new) + 1)
    return replace(
        mesh,
        vertices=np.concatenate([mesh.vertices, np.reshape(middles, (-1, 3))]),
        corners=np.concatenate([mesh.corners, new.reshape(-1)]),
        offsets=np.concatenate([mesh.offsets, ends]),
        triangles=np.concatenate([mesh.triangles, new]),
        triangle_polygon=np.concatenate([mesh.triangle_polygon, faces + np.arange(len(new))]),
    )


def _pairs_of_faces(mesh: PolygonMesh, vertices: IntArray) -> set[tuple[int, int]]:
    """Pairs of some vertices that are corners of one polygon, the lower one first."""
    marked = np.zeros(len(mesh.vertices), np.bool_)
    marked[vertices] = True
    sizes = np.diff(mesh.offsets)
    pairs: set[tuple[int, int]] = set()
    for size in np.unique(sizes).tolist():
        faces = np.flatnonzero(sizes == size)
        corners = mesh.corners[ranges(mesh.offsets, faces)].reshape(-1, size)
        corners = corners[marked[corners].sum(axis=1) > 1]
        i, j = np.triu_indices(size, 1)
        ends = np.sort(np.stack([corners[:, i], corners[:, j]], axis=-1).reshape(-1, 2), axis=1)
        ends = np.unique(ends[marked[ends].all(axis=1)], axis=0)
        pairs.update(map(tuple, ends.tolist()))
    return pairs
