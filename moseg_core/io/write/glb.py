"""A segmented mesh as a GLB file (glTF 2.0): a node and a mesh for every part.

For viewers and browsers: each part can be picked, hidden or recoloured by its name. Polygons are
cut into triangles, and each part has vertices of its own, with the normals of
:func:`moseg_core.view.picture.corner_normals`: smooth within the part, and doubled along creases,
where one vertex would need several normals. What glTF asks for and files seldom heed: colours
are stored in proportion to light, not as sRGB values, so that viewers show the colours of the
picture.

Coordinates are the user's own, without a turn to the y-up of glTF. The format holds them in single
precision, of which a shape far from the origin, on a map for example, would lose all that matters:
so positions are those relative to the middle of the shape, and every node is placed there. The
triangles are not in the order of the input: labels are found again by place, where the shape is at
hand (``read_labels("x.glb", shape)``).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.labels import checked_labels
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.normals import corner_normals
from moseg_core.view.palette import checked_colors, linear_light


def encode_glb(
    mesh: Geometry, labels: npt.ArrayLike, names: Sequence[str], colors: npt.ArrayLike
) -> bytes:
    """Encode a mesh as one named, coloured object per part.

    Parameters
    ----------
    mesh : Geometry
    labels : (F,) array_like of int
        The part of each element, 0 to ``len(names) - 1``.
    names : sequence of str
        One for each part, all different: names of its node, mesh and material. Parts without
        polygons are left out.
    colors : (n, 3) array_like of uint8
        Red, green and blue for each part, sRGB.

    Returns
    -------
    bytes
        The contents of the file; equal for equal input.

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.
    UsageError
        Not one colour per name, or two parts of one name.

    Examples
    --------
    >>> from moseg_core.shape.mesh import PolygonMesh
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                               [[0, 1, 2, 3]])
    >>> encode_glb(tile, [0], ["tile"], [[65, 112, 216]])[:4]
    b'glTF'
    """
    import trimesh
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    label = checked_labels(mesh, labels, len(names)).astype(np.int64)
    light = linear_light(checked_colors(colors, names))
    if len(set(names)) < len(names):
        twice = next(name for k, name in enumerate(names) if name in names[:k])
        raise UsageError(f"two parts are named '{twice}'; a GLB file needs a name for each")
    normals = corner_normals(mesh, label)
    part = label[mesh.triangle_polygon]
    # The node above all others; one that is also a part would take the others with it.
    root = "world"
    while root in names:
        root += "_"
    scene = trimesh.Scene(base_frame=root)
    used = mesh.vertices[mesh.corners]
    placement = np.eye(4)
    placement[:3, 3] = (used.min(axis=0) + used.max(axis=0)) / 2.0
    for k, name in enumerate(names):
        chosen = part == k
        if not chosen.any():
            continue
        vertices, vertex_normals, faces = _compact(mesh, mesh.triangles[chosen], normals[chosen])
        material = PBRMaterial(  # type: ignore[no-untyped-call]
            name=name,
            baseColorFactor=[*light[k].tolist(), 1.0],
            metallicFactor=0.0,
            roughnessFactor=0.7,
            doubleSided=True,
        )
        scene.add_geometry(
            trimesh.Trimesh(
                vertices=vertices - placement[:3, 3],
                faces=faces,
                vertex_normals=vertex_normals,
                visual=TextureVisuals(material=material),  # type: ignore[no-untyped-call]
                process=False,
            ),
            node_name=name,
            geom_name=name,
            transform=placement,
        )
    glb = scene.export(file_type="glb", include_normals=True)  # type: ignore[no-untyped-call]
    return bytes(glb)


def _compact(
    mesh: Geometry, triangles: IntArray, normals: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Vertices and normals that differ, and the triangles over them."""
    position = mesh.merged[triangles].reshape(-1)
    # Corners that share a normal share it to the last bit: it was computed once for all.
    key = np.column_stack([position, normals.reshape(-1, 3)])
    _, first, number = np.unique(key, axis=0, return_index=True, return_inverse=True)
    vertices = mesh.vertices[triangles.reshape(-1)[first]]
    return vertices, normals.reshape(-1, 3)[first], number.reshape(-1, 3)
