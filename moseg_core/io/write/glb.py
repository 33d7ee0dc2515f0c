"""A segmented mesh as a GLB file (glTF 2.0): a node and a mesh for every part.

For viewers and browsers: each part can be picked, hidden or recoloured by its name. Polygons are
cut into triangles, and each part has vertices of its own, with the normals of
:func:`moseg_core.view.picture.corner_normals`: smooth within the part, and doubled along creases,
where one vertex would need several normals. What glTF asks for and files seldom heed: colours
are stored in proportion to light, not as sRGB values, so that viewers show the colours of the
picture.

Coordinates are the user's own. The format holds them in single precision, of which a shape far from
the origin, on a map for example, would lose all that matters: so positions are those relative to
the middle of the shape, and every node is placed there. In glTF +y points up. Where it is known
that another axis does in the shape, the nodes turn it there, and the scene remembers from where
(:data:`moseg_core.io.read.glb_scene.UP`). Texture coordinates are the input's, where a reader kept
them, and so are names of materials (:mod:`moseg_core.io.write.glb_materials`).

The triangles are not in the order of the input: labels are found again by place, where the shape is
at hand (``read_labels("x.glb", shape)``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.io.read.glb_scene import UP
from moseg_core.io.write.glb_materials import Runs, material_order, split_primitives
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.up import Up, turn_to_y
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.normals import corner_normals
from moseg_core.view.palette import checked_colors, linear_light


def encode_glb(
    mesh: Geometry,
    labels: npt.ArrayLike,
    names: Sequence[str],
    colors: npt.ArrayLike,
    *,
    up: Up | None = None,
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
    up : {"x", "-x", "y", "-y", "z", "-z"}, optional
        The axis that points up, which nodes turn to +y.

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
    turn = turn_to_y(up)
    turned = bool((turn != np.eye(3)).any())
    scene = trimesh.Scene(base_frame=root, metadata={UP: up} if turned else None)
    used = mesh.vertices[mesh.corners]
    middle = (used.min(axis=0) + used.max(axis=0)) / 2.0
    placement = np.eye(4)
    placement[:3, :3], placement[:3, 3] = turn, turn @ middle
    texture = _texture(mesh)
    looks = mesh.appearance if isinstance(mesh, PolygonMesh) else None
    runs: dict[str, Runs] = {}
    for k, name in enumerate(names):
        chosen = np.flatnonzero(part == k)
        if not len(chosen):
            continue
        order, runs[name] = material_order(name, looks, mesh.triangle_polygon[chosen])
        chosen = chosen[order]
        places = None if texture is None else texture[chosen]
        compact = _compact(mesh, mesh.triangles[chosen], normals[chosen], places)
        material = PBRMaterial(  # type: ignore[no-untyped-call]
            name=name,
            baseColorFactor=[*light[k].tolist(), 1.0],
            metallicFactor=0.0,
            roughnessFactor=0.7,
            doubleSided=True,
        )
        scene.add_geometry(
            trimesh.Trimesh(
                vertices=compact.vertices - middle,
                faces=compact.triangles,
                vertex_normals=compact.normals,
                visual=TextureVisuals(uv=compact.texture, material=material),  # type: ignore[no-untyped-call]
                process=False,
            ),
            node_name=name,
            geom_name=name,
            transform=placement,
        )
    glb = scene.export(  # type: ignore[no-untyped-call]
        file_type="glb",
        include_normals=True,
        tree_postprocessor=lambda tree: split_primitives(tree, runs),
    )
    return bytes(glb)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Compact:
    """Vertices that differ in place, normal or texture coordinates, and triangles over them."""

    vertices: FloatArray
    normals: FloatArray
    texture: FloatArray | None
    triangles: IntArray


def _compact(
    mesh: Geometry, triangles: IntArray, normals: FloatArray, texture: FloatArray | None
) -> _Compact:
    # Corners that share a normal share it to the last bit: it was computed once for all.
    columns = [mesh.merged[triangles].reshape(-1), normals.reshape(-1, 3)]
    if texture is not None:
        columns.append(texture.reshape(-1, 2))
    _, first, number = np.unique(
        np.column_stack(columns), axis=0, return_index=True, return_inverse=True
    )
    return _Compact(
        vertices=mesh.vertices[triangles.reshape(-1)[first]],
        normals=normals.reshape(-1, 3)[first],
        texture=None if texture is None else texture.reshape(-1, 2)[first],
        triangles=number.reshape(-1, 3),
    )


def _texture(mesh: Geometry) -> FloatArray | None:
    """(T, 3, 2): texture coordinates of the corners of triangles, 0 where there are none."""
    if not isinstance(mesh, PolygonMesh) or mesh.appearance is None:
        return None
    texture = mesh.appearance.texture
    if texture is None:
        return None
    row = texture.corners[mesh.triangle_corners]
    return np.where(row[..., None] >= 0, texture.values[row], 0.0)
