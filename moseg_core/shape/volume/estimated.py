"""The volume of a surface that encloses none by itself, estimated because the user asks for it.

``convex_parts`` (Sec. 10) compares convex hulls with the enclosed volume V. An open mesh, a soup
of polygons or a point cloud has none. Three estimates, none of them taken unasked:

- a number that the user knows;
- ``hull``: the volume of the shape's convex hull, or of the hulls of the pieces that it is cut
  into where it is not convex (:mod:`moseg_core.shape.volume.hulls`). Needs nothing but places;
- ``winding``: the volume of all places around which the surface winds more than half
  (:mod:`moseg_core.shape.volume.winding`), whichever way it is oriented as a whole. Holes and gaps
  are closed by what would be the smoothest membrane over them. Faces must be oriented alike: where
  neighbours are seen not to be, the words say so; of pieces that do not touch nobody can tell.

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
from moseg_core.shape.adjacency import undirected
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.volume.hulls import hulls_volume
from moseg_core.shape.volume.volume import Volume
from moseg_core.shape.volume.winding_tree import WindingTree

_SAMPLES = 300_000


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
    ...                               [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
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
    value, pieces = hulls_volume(geometry)
    if value == 0.0:
        return Volume.none("it is flat: its convex hull has no volume"), ""
    words = "that of its convex hull"
    if pieces > 1:
        words = f"that of the convex hulls of {pieces} pieces of it"
    return Volume(value=value, source="hull"), words


def _winding_volume(geometry: Geometry) -> tuple[Volume, str]:
    if isinstance(geometry, PointCloud) and geometry.normals is None:
        reason = "it has no normals, which a winding number needs; take 'hull' or give a number"
        return Volume.none(reason), ""
    vertices = geometry.vertices[np.unique(geometry.corners)]
    middle = vertices.mean(axis=0)
    axes = np.linalg.svd(np.cov((vertices - middle).T))[0]
    local = (vertices - middle) @ axes
    low, size = local.min(axis=0), np.ptp(local, axis=0)
    if size.min() <= 1e-9 * size.max():
        return Volume.none("it is flat: there is nothing that it could wind around"), ""
    counts = np.maximum(1, np.round(size * (_SAMPLES / size.prod()) ** (1 / 3))).astype(int)
    cell = np.stack(np.unravel_index(np.arange(counts.prod()), tuple(counts)), axis=1)
    # At random within the cells, lest faces along the box round all of its cells the same way.
    inside = cell + np.random.default_rng(0).random(cell.shape)
    tree = WindingTree.of(geometry)
    winding = tree.winding((low + inside * (size / counts)) @ axes.T + middle)
    share = float((np.abs(winding) > 0.5).mean())
    if share == 0.0:
        reason = (
            "it winds more than half around no place; orient its faces alike, take 'hull' or give"
            " a number"
        )
        return Volume.none(reason), ""
    value = share * float(size.prod())
    words = "where its surface winds more than half around"
    if isinstance(geometry, PolygonMesh) and (count := _edges_turned_over(geometry)):
        edges = "1 edge" if count == 1 else f"{count} edges"
        words += f"; it may be far off: at {edges} faces are not oriented alike"
    return Volume(value=value, source="winding"), words


def _edges_turned_over(mesh: PolygonMesh) -> int:
    """Edges through which more faces run in one direction than in the other, by two or more.

    Faces that are oriented alike cancel out in pairs; at a rim one is left. Where two are, the
    winding number is as if the surface had a twofold rim there.
    """
    ends, _ = mesh.edges
    edge, group = undirected(ends)
    direction = np.where(ends[:, 0] == edge[group, 0], 1, -1)
    return int((np.abs(np.bincount(group, weights=direction)) > 1).sum())
