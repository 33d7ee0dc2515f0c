"""The volume of what is made out of a shape: of its parts, and of the shape deformed.

A sum of signed tetrahedra is a volume only where all faces are oriented alike. Which faces are can
be told from the edges that they share: two neighbours run through their common edge in opposite
directions. So it is known of a surface in one piece, of all parts of such a surface, and of every
part of a surface that encloses a volume of its own. There the volume is exact: that of the surface
with its holes and cuts capped (:mod:`moseg_core.shape.volume.capped`).

An estimate of a shape says nothing about its faces, nor anything about a part. Where faces are not
known to be oriented alike, what is made out of an estimated shape is estimated afresh, in the same
way. Hulls need the cuts closed first: the hulls of a bowl in pieces are those of its wall. A number
that the user gave is about one shape only.
"""

from __future__ import annotations

import numpy as np

from moseg_core.shape.adjacency import mesh_adjacency, undirected
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.capped import capped_volume, with_caps
from moseg_core.shape.volume.estimated import estimated_volume
from moseg_core.shape.volume.orientation import EdgeUses
from moseg_core.shape.volume.twins import one_of_each
from moseg_core.shape.volume.volume import Volume
from moseg_core.types import FloatArray

#: Below this share of the cubed diagonal a volume is rounding, as for whole shapes.
_FLAT = 1e-9
#: The same in an embedding, the vertices of which are computed rather than read.
_FLAT_DEFORMED = 1e-12


def part_volume(
    part: Geometry,
    enclosed: Volume,
    *,
    whole: Geometry,
    whole_volume: Volume,
    center: FloatArray,
    diagonal: float,
) -> Volume:
    """The volume of some elements of a shape.

    Parameters
    ----------
    part : Geometry
    enclosed : Volume
        What the part encloses by itself, its cuts left open.
    whole : Geometry
    whole_volume : Volume
    center : (3,) float, model units
        Of the part; its tetrahedra are measured from there.
    diagonal : float, model units
        Of the part's bounding box.

    Returns
    -------
    Volume
        Exact, or estimated as that of the whole; or none.

    Examples
    --------
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    >>> found = part_volume(tent, Volume.none("it is open"), whole=tent,
    ...                     whole_volume=Volume.none("it is open"), center=np.zeros(3),
    ...                     diagonal=1.7)
    >>> round(found.value, 6), found.source
    (0.166667, 'exact')
    """
    if enclosed.value is not None:
        return enclosed
    doubt = enclosed.reason
    if isinstance(part, PolygonMesh) and isinstance(whole, PolygonMesh):
        doubt = "" if whole_volume.source == "exact" else _doubt(whole) and _doubt(part)
    if doubt:
        return _part_estimate(part, whole, whole_volume, doubt)
    triangles = part.triangles
    if isinstance(part, PolygonMesh) and (single := one_of_each(part, EdgeUses.of(part))):
        triangles = single.triangles(part)
    value = capped_volume(part.vertices - center, triangles, part.merged)
    if value <= _FLAT * diagonal**3:
        return Volume.none("it is flat, also with its cuts capped")
    return Volume.exact(value)


def deformed_volume(
    mesh: PolygonMesh,
    *,
    original: PolygonMesh,
    original_volume: Volume,
    space: str,
    diagonal: float,
) -> Volume:
    """The volume of a shape with its vertices elsewhere.

    Parameters
    ----------
    mesh : PolygonMesh
        With the new vertices.
    original : PolygonMesh
        With those of the shape; what touches is asked of it.
    original_volume : Volume
    space : str
        What the deformed version is called.
    diagonal : float
        Of the deformed bounding box.

    Returns
    -------
    Volume
        Of a shape without a volume none. Else, where its faces are oriented alike, the absolute
        signed volume of the deformed surface, its holes capped: what folds over counts with its
        sign. Else an estimate as that of the original; or none.
    """
    source = original_volume.source
    if source is None:
        return original_volume
    if source != "exact" and (doubt := _doubt(original)):
        if source == "user":
            return Volume.none(f"{doubt}, and {_NUMBER} the space '{space}'")
        return estimated_volume(mesh, source)[0]
    middle = mesh.vertices[mesh.triangles].reshape(-1, 3).mean(axis=0)
    # Which faces lie on each other, and which vertices, is asked of the original too.
    single = one_of_each(original, EdgeUses.of(original))
    triangles = mesh.triangles if single is None else single.triangles(mesh)
    value = capped_volume(mesh.vertices - middle, triangles, original.merged)
    if value <= _FLAT_DEFORMED * diagonal**3:
        return Volume.none(f"it is flat in the space '{space}'")
    return Volume.exact(value)


_NUMBER = "the number that was given for the whole says nothing of"


def _part_estimate(part: Geometry, whole: Geometry, whole_volume: Volume, doubt: str) -> Volume:
    """A volume in the way in which that of the whole was estimated, if it was."""
    if whole_volume.source == "user":
        return Volume.none(f"{doubt}, and {_NUMBER} a part")
    if whole_volume.source == "winding":
        return estimated_volume(part, "winding")[0]
    if whole_volume.source == "hull":
        if not isinstance(part, PolygonMesh) or not _cut_along_edges(whole):
            return Volume.none(f"{doubt}, and its cuts cannot be closed, which its hulls need")
        return estimated_volume(with_caps(part), "hull")[0]
    return Volume.none(doubt)


def _doubt(mesh: PolygonMesh) -> str:
    """Why the faces of a surface may not be oriented alike; empty where they are."""
    ends, _ = mesh.edges
    code = ends[:, 0] * np.int64(len(mesh.vertices)) + ends[:, 1]
    if len(np.unique(code)) < len(code):
        return "its faces are not oriented consistently"
    pieces = mesh_adjacency(mesh).components()[0]
    if pieces > 1:
        return f"its {pieces} pieces may be oriented against each other"
    return ""


def _cut_along_edges(whole: Geometry) -> bool:
    """Whether a part of a surface is bounded by its edges: not so where faces only lie close."""
    if not isinstance(whole, PolygonMesh):
        return False
    _, group = undirected(whole.edges[0])
    odd = bool((np.bincount(group) % 2).any())
    return not odd or mesh_adjacency(whole).components()[0] == 1
