"""The volume of a surface that encloses none by itself, estimated because the user asks for it.

``convex_parts`` (Sec. 10) compares convex hulls with the enclosed volume V. An open mesh, a soup
of polygons or a point cloud has none. Three estimates, none of them taken unasked:

- a number that the user knows;
- ``hull``: the volume of the shape's convex hull, or of the hulls of the pieces that it is cut
  into where it is not convex (:mod:`moseg_core.shape.volume.hulls`). Needs nothing but places. An
  open surface has its rims capped first, since the pieces of a bowl have the hulls of its wall; how
  far that may be off is said in the words;
- ``winding``: the volume of all places around which the surface winds more than half
  (:mod:`moseg_core.shape.volume.winding`), whichever way it is oriented as a whole. Holes and gaps
  are closed by what would be the smoothest membrane over them. Faces are first oriented as most of
  their neighbours are; of pieces that do not touch nobody can tell.

Of faces that lie on each other both take one (:mod:`moseg_core.shape.volume.twins`).

The region of ``winding`` is measured by points, one at a random place in each of some 300 000
equal cells of a box around the shape, along its principal axes. Where the exact volume is known
(a ball, a torus, the samples) the estimate is within 0.1 % of it on closed meshes, within 0.3 %
where all their triangles are shrunk by a tenth, and on clouds with normals about 2 % too small from
2000 random points and 1 % from 8000. A shape that fills little of its box is measured less well.
"""

from __future__ import annotations

import math

import numpy as np

from moseg_core.errors import UsageError
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.capped import with_caps
from moseg_core.shape.volume.hulls import hulls_volume
from moseg_core.shape.volume.orientation import EdgeUses, turned_faces
from moseg_core.shape.volume.twins import of_triangles, one_sheet
from moseg_core.shape.volume.volume import Volume
from moseg_core.shape.volume.winding_tree import WindingTree

_SAMPLES = 300_000
#: For a look at how far another estimate may be off.
_FEW_SAMPLES = 30_000
#: From how far two estimates are apart, as a share, that is worth a word.
_APART = 0.1


def estimated_volume(geometry: Geometry, how: float | str) -> tuple[Volume, str]:
    """A volume as the user asks for it, and in words how it was found.

    Parameters
    ----------
    geometry : Geometry
    how : float or str
        Model units cubed, also as text; or "hull" or "winding".

    Returns
    -------
    volume : Volume
        Its source is "hull", "winding" or "user". None where it cannot be estimated: a flat shape
        has no hull, points without normals have no winding number, or the surface winds around
        nothing.
    words : str
        Empty where there is no volume. Says also why the volume may be wrong.

    Raises
    ------
    UsageError
        No positive number, and neither "hull" nor "winding".

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> tent = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3], [2, 1, 0]])
    >>> volume, words = estimated_volume(tent, "hull")
    >>> round(volume.value, 6), volume.source, words
    (0.166667, 'hull', 'that of its convex hull')
    """
    if how == "hull":
        return _hull_volume(geometry)
    if how == "winding":
        return _winding_volume(geometry)
    try:
        value = float(how)
    except (TypeError, ValueError):
        value = math.nan
    if isinstance(how, bool) or not 0 < value < math.inf:
        raise UsageError(
            f"a volume is a positive number in model units cubed, 'hull' or 'winding', not {how!r}"
        )
    return Volume(value=value, source="user"), "as given"


def _hull_volume(geometry: Geometry) -> tuple[Volume, str]:
    rims, closed = 0, geometry
    if isinstance(geometry, PolygonMesh):
        geometry = closed = one_sheet(geometry)
        uses = EdgeUses.of(geometry).uses
        rims = int((uses == 1).sum())
        if rims < len(uses):  # to cap the faces of a soup adds nothing
            closed = with_caps(geometry)
    value, pieces = hulls_volume(closed)
    if value == 0.0:
        return Volume.none("it is flat: its convex hull has no volume"), ""
    words = "that of its convex hull"
    if pieces > 1:
        words = f"that of the convex hulls of {pieces} pieces of it"
    if isinstance(geometry, PolygonMesh) and rims:
        words += _doubt_of_open(geometry, value, rims)
    return Volume(value=value, source="hull"), words


def _doubt_of_open(mesh: PolygonMesh, value: float, rims: int) -> str:
    """In words how far the volume of an open surface's hulls may be off."""
    edges = "1 boundary edge" if rims == 1 else f"{rims} boundary edges"
    words = f"; a guess, since the surface is open ({edges})"
    inside = _inside(_oriented(mesh)[0], _FEW_SAMPLES)
    if not inside or abs(value - inside) <= _APART * inside:
        return words
    return f"{words}: by '--volume winding' it is {inside:.3g}"


def _winding_volume(geometry: Geometry) -> tuple[Volume, str]:
    if isinstance(geometry, PointCloud) and geometry.normals is None:
        reason = "it has no normals, which a winding number needs; take 'hull' or give a number"
        return Volume.none(reason), ""
    turned = 0
    if isinstance(geometry, PolygonMesh):
        geometry = one_sheet(geometry)
        geometry, turned = _oriented(geometry)
    value = _inside(geometry, _SAMPLES)
    if value is None:
        return Volume.none("it is flat: there is nothing that it could wind around"), ""
    if value == 0.0:
        reason = (
            "it winds more than half around no place; orient its faces alike, take 'hull' or give"
            " a number"
        )
        return Volume.none(reason), ""
    words = "where its surface winds more than half around"
    if turned:
        words += f", {turned} face{'s' * (turned != 1)} turned over to agree with the others"
    if isinstance(geometry, PolygonMesh) and (count := _edges_turned_over(geometry)):
        edges = "1 edge" if count == 1 else f"{count} edges"
        words += f"; it may be far off: at {edges} faces are not oriented alike"
    return Volume(value=value, source="winding"), words


def _inside(geometry: Geometry, samples: int) -> float | None:
    """The volume of the places around which a surface winds more than half; None of a flat one.

    Parameters
    ----------
    geometry : Geometry
        Points have normals.
    samples : int
        About how many places to look at.
    """
    vertices = geometry.used_vertices
    middle = vertices.mean(axis=0)
    axes = np.linalg.svd(np.cov((vertices - middle).T))[0]
    local = (vertices - middle) @ axes
    low, size = local.min(axis=0), np.ptp(local, axis=0)
    if size.min() <= 1e-9 * size.max():
        return None
    counts = np.maximum(1, np.round(size * (samples / size.prod()) ** (1 / 3))).astype(int)
    cell = np.stack(np.unravel_index(np.arange(counts.prod()), tuple(counts)), axis=1)
    # At random within the cells, lest faces along the box round all of its cells the same way.
    inside = cell + np.random.default_rng(0).random(cell.shape)
    tree = WindingTree.of(geometry)
    winding = tree.winding((low + inside * (size / counts)) @ axes.T + middle)
    return float((np.abs(winding) > 0.5).mean()) * float(size.prod())


def _oriented(mesh: PolygonMesh) -> tuple[PolygonMesh, int]:
    """A mesh with its faces oriented as most of their neighbours are, and how many were not."""
    uses = EdgeUses.of(mesh)
    if not (np.abs(uses.balance) > 1).any():
        return mesh, 0
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    of_faces = np.bincount(mesh.triangle_polygon, areas, mesh.n_polygons).astype(np.float64)
    turned = turned_faces(uses, of_faces)[0]
    over = turned[mesh.triangle_polygon, None]
    turned_mesh = of_triangles(mesh, np.where(over, mesh.triangles[:, ::-1], mesh.triangles))
    return turned_mesh, int(turned.sum())


def _edges_turned_over(mesh: PolygonMesh) -> int:
    """Edges through which more faces run in one direction than in the other, by two or more.

    Faces that are oriented alike cancel out in pairs; at a rim one is left. Where two are, the
    winding number is as if the surface had a twofold rim there.
    """
    return int((np.abs(EdgeUses.of(mesh).balance) > 1).sum())
