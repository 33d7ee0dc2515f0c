"""The volume that a mesh encloses, where it does (Sec. 10, the V of ``convexparts``).

Exact, by the divergence theorem, and only for meshes that bound a solid: closed, every edge used
once each way, of faces that lie on each other one counted
(:mod:`moseg_core.shape.volume.twins`). Of any other mesh it is told what is wrong with it, from how
many faces each edge has and how they run through it, and what helps.
:mod:`moseg_core.shape.volume.estimated` answers then, when asked.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.adjacency import Adjacency, mesh_adjacency
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.orientation import EdgeUses, turned_faces
from moseg_core.shape.volume.twins import OneOfEach, one_of_each
from moseg_core.shape.volume.volume import Volume
from moseg_core.types import FloatArray, IntArray

_PAST_WALLS = "take --volume winding, which sees past inner walls"
_TURNS = "take --volume winding, which turns faces alike"
_EITHER_WAY = "take --volume winding, for which a piece may be oriented either way"
_ONE_SIDE = "has one side only, as a Moebius strip has"
_NO_SIDES = "take --volume hull, which asks for no orientation, or give a number"


def enclosed_volume(mesh: PolygonMesh, adjacency: Adjacency) -> Volume:
    """Volume that the surface encloses, or the reason why it encloses none.

    Every edge must be run through as often in one direction as in the other. The volume is then
    the absolute sum of the signed tetrahedra over the triangles. Components that are oriented
    against the others must lie within one of those, as the walls of a cavity do.

    Parameters
    ----------
    mesh : PolygonMesh
    adjacency : Adjacency
        Of its polygons.

    Returns
    -------
    Volume
        Exact, or none.

    Examples
    --------
    >>> from moseg_core.shape.adjacency import mesh_adjacency
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> enclosed_volume(tent, mesh_adjacency(tent)).reason
    'it is open (3 boundary edges)'
    """
    uses = EdgeUses.of(mesh)
    if len(uses.uses) == 0:
        return Volume.none("it has no edges")
    single = one_of_each(mesh, uses)
    if single is not None:
        return _of_one_of_each(mesh, single)
    if what := _wrong_edges(uses, mesh.n_polygons):
        return what
    corners = mesh.vertices[mesh.triangles]
    extent = np.ptp(mesh.vertices[mesh.corners], axis=0)
    count, component = adjacency.components()
    return _inside(corners, component[mesh.triangle_polygon], count, extent)


def _inside(
    corners: FloatArray, component: IntArray, count: int, extent: FloatArray, note: str = ""
) -> Volume:
    """What closed and oriented (T, 3, 3) triangles in so many components enclose."""
    corners = corners - corners.reshape(-1, 3).mean(axis=0)
    if count > 1 and not _cavities_only(corners, component, count):
        return Volume.none("its components are oriented against each other", _EITHER_WAY)
    volume = abs(signed_volume(corners))
    if volume <= 1e-9 * float(np.linalg.norm(extent)) ** 3:
        return Volume.none("it is flat")
    return Volume.exact(volume, note)


def _of_one_of_each(mesh: PolygonMesh, single: OneOfEach) -> Volume:
    """What the faces enclose that are left where of all in one place one is taken."""
    many = "all" if single.twins == mesh.n_polygons else f"{single.twins} of {mesh.n_polygons}"
    twins = f"{many} faces lie on another one, as for two sides of a surface"
    if single.copies:
        plural = "s" * (single.copies != 1)
        twins = f"{single.copies} duplicate face{plural}, and {twins}"
    left = single.mesh(mesh)
    if not single.kept.any():
        return Volume.none(f"{twins}, and nothing else is there")
    if what := _wrong_edges(single.uses, mesh.n_polygons):
        return Volume.none(f"{twins}, and of one of each {_their(what.reason)}", what.remedy)
    extent = np.ptp(mesh.vertices[mesh.corners], axis=0)
    count, component = mesh_adjacency(left).components()
    note = f"{twins}; one of each encloses the volume"
    return _inside(left.vertices[left.triangles], component, count, extent, note)


def _their(reason: str) -> str:
    """A reason about the whole, said of the faces that are left."""
    return reason.replace("it is", "the surface is", 1).replace("its faces", "faces", 1)


def _wrong_edges(uses: EdgeUses, n_faces: int) -> Volume | None:
    """Why edges say that a surface encloses nothing; None where they do not.

    An edge that an even number of faces run through, as many either way, is none to complain of:
    two boxes may have one in common.
    """
    rims = int((uses.uses == 1).sum())
    odd = int((uses.uses % 2 == 1).sum())
    crowded = int((uses.uses > 2).sum()) if odd > rims or (uses.balance != 0).any() else 0
    many = f"{crowded} edge{'s have' if crowded != 1 else ' has'} three or more faces"
    if rims:
        reason = f"it is open ({rims} boundary edge{'s' * (rims != 1)})"
        if odd > rims:
            reason = f"{reason}, and {many}"
        one_sided = bool((turned_faces(uses, np.ones(n_faces))[1][uses.face] < 0).any())
        return (
            Volume.none(f"{reason}, and {_ONE_SIDE}", _NO_SIDES)
            if one_sided
            else (Volume.none(reason))
        )
    if odd:
        return Volume.none(many, _PAST_WALLS)
    if not uses.balance.any():
        return None
    turned, piece = turned_faces(uses, np.ones(n_faces))
    if (piece[uses.face] < 0).any():
        return Volume.none(f"it {_ONE_SIDE}", _NO_SIDES)
    over = int(turned.sum())
    reason = "its faces are not oriented consistently"
    if over:
        reason += f" ({over} of {n_faces} {'is' if over == 1 else 'are'} turned over)"
        return Volume.none(reason, _TURNS)
    return Volume.none(f"{reason}, and {many}", _PAST_WALLS)


def _cavities_only(corners: FloatArray, component: IntArray, count: int) -> bool:
    """Whether components of the lesser orientation lie in the box of one of the other."""
    signed = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    volumes = np.bincount(component, weights=signed, minlength=count)
    volumes = volumes * np.sign(volumes.sum())
    low = np.full((count, 3), np.inf)
    high = np.full((count, 3), -np.inf)
    np.minimum.at(low, component, corners.min(axis=1))
    np.maximum.at(high, component, corners.max(axis=1))
    outer = np.flatnonzero(volumes > 0)
    return all(
        ((low[outer] <= low[k]) & (high[outer] >= high[k])).all(axis=1).any()
        for k in np.flatnonzero(volumes < 0)
    )


def signed_volume(corners: FloatArray) -> float:
    """Sum of the signed tetrahedra between the origin and (T, 3, 3) triangles."""
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0)
