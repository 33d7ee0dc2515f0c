"""The volume that a mesh encloses, where it does (Sec. 10, the V of ``convexparts``).

Exact, by the divergence theorem, and only for meshes that bound a solid: closed, every edge used
once each way. :mod:`moseg_core.shape.volume.estimated` answers for the others, when asked.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.adjacency import Adjacency, undirected
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.volume import Volume
from moseg_core.types import FloatArray, IntArray


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
    ends, _ = mesh.edges
    if len(ends) == 0:
        return Volume.none("it has no edges")
    edge, group = undirected(ends)
    direction = np.where(ends[:, 0] == edge[group, 0], 1, -1)
    uses = np.bincount(group)
    balance = np.bincount(group, weights=direction)
    odd = int((uses % 2).sum())
    if odd:
        return Volume.none(f"it is open ({odd} boundary edge{'s' * (odd != 1)})")
    if balance.any():
        return Volume.none("its faces are not oriented consistently")
    corners = mesh.vertices[mesh.triangles]
    extent = np.ptp(mesh.vertices[mesh.corners], axis=0)
    corners = corners - corners.reshape(-1, 3).mean(axis=0)
    count, component = adjacency.components()
    if count > 1 and not _cavities_only(corners, component[mesh.triangle_polygon], count):
        return Volume.none("its components are oriented against each other")
    volume = abs(signed_volume(corners))
    if volume <= 1e-9 * float(np.linalg.norm(extent)) ** 3:
        return Volume.none("it is flat")
    return Volume.exact(volume)


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
