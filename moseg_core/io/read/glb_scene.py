"""glTF files: the triangles of a scene, in the order in which the scene lists them.

A glTF scene is a forest of nodes, each with a placement relative to its parent and perhaps a
mesh; a mesh is a list of primitives (stretches of one material). The elements of the shape are
the triangles, and their order is that of the document, whatever the names:

1. nodes depth first, each before its children, roots and children as the lists name them;
2. within a node the primitives of its mesh as listed;
3. within a primitive the triangles as its indices form them (strips and fans as glTF defines).

The scene is the default one, or the first where the file names no default; a file without
scenes shows all nodes that are nobody's child, in order. Points and lines are left out. Skins,
morph targets and animations are not applied: a mesh is read in the pose in which it was modelled,
and stands where its node stands. One with a skin does not: its joints place it, and the format
says to ignore its node. A mirroring placement turns its triangles over so that outsides stay out.

Texture coordinates (``TEXCOORD_0``) and the names of materials are kept beside the triangles, for
writers; images are not.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, read_file, shape_from_polygons
from moseg_core.io.read.glb_container import GlbFile, Json
from moseg_core.io.read.glb_meshes import Mesh, PlacedMeshes, Primitive
from moseg_core.io.read.limits import LIMITS, ReadLimits
from moseg_core.shape.appearance import Appearance, CornerValues, material_runs
from moseg_core.shape.shape import Shape
from moseg_core.shape.up import Up
from moseg_core.types import FloatArray, IntArray

_INSTANCED = "EXT_mesh_gpu_instancing"

_PLACING = {"matrix", "translation", "rotation", "scale"}

UP = "moseg_up"
"""In the extras of a scene that moseg wrote: the axis of the shape that its nodes turn to +y."""


def read_glb(path: Path, *, limits: ReadLimits = LIMITS) -> Shape:
    """Read a glTF file, ``.glb`` or ``.gltf``: one element per triangle, in the scene's order.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional
        How many triangles a scene may show that places its meshes again and again.

    Returns
    -------
    Shape
        Named after the file, in the scene's units (metres, by the format's definition), and with
        y up, likewise.

    Raises
    ------
    ShapeError
        The file cannot be read, is no whole glTF file, keeps its geometry compressed or outside
        of its folder, or shows no triangles or too many; says why.

    Examples
    --------
    >>> import tempfile, trimesh
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "box.glb"
    ...     _ = trimesh.creation.box().export(file)
    ...     read_glb(file).n_elements
    12
    """
    glb = GlbFile.parse(path, read_file(path))
    vertices, corners, appearance, notes = _shown(glb, limits)
    shape = shape_from_polygons(
        path,
        vertices,
        corners,
        np.arange(0, len(corners) + 1, 3),
        appearance=appearance,
        notes=[*glb.notes, *notes],
    )
    return shape.with_up("y")


def _shown(glb: GlbFile, limits: ReadLimits) -> tuple[FloatArray, IntArray, Appearance, list[str]]:
    """What a scene shows: vertices (V, 3), corners of triangles (3 T,), their look, and notes."""
    scene = PlacedMeshes(glb, limits)
    points: list[FloatArray] = [np.empty((0, 3))]
    corners: list[IntArray] = [np.empty((0, 3), np.int64)]
    n_points = 0
    textures: list[FloatArray] = []
    materials: list[tuple[int, str]] = []
    n_triangles = 0
    found: Counter[tuple[str, str]] = Counter()
    for node, number, placement in _placed_meshes(glb):
        mesh = scene.mesh(number)
        found.update(_left_out(glb, node, mesh))
        for primitive in mesh.primitives:
            vertices, triangles = scene.arrays(primitive)
            if primitive.texture is None:
                primitive.texture, primitive.damaged = _texture(glb, primitive)
            if primitive.damaged:
                found["lists of texture coordinates that are damaged", "passed over"] += 1
            textures.append(primitive.texture)
            materials.append((n_triangles, _material(glb, primitive.document)))
            n_triangles += len(triangles)
            if _mirrors(placement):
                triangles = triangles[:, [0, 2, 1]]
            points.append(_placed(vertices, placement))
            corners.append(triangles + n_points)
            n_points += len(vertices)
    flat = np.concatenate(corners).reshape(-1)
    names, polygon_materials = material_runs(materials, n_triangles)
    appearance = Appearance(
        texture=_corner_texture(textures, flat),
        materials=names,
        polygon_materials=polygon_materials,
    )
    notes = [f"{what}: {count}; {done}" for (what, done), count in found.items()]
    return np.concatenate(points), flat, appearance, notes


def _texture(glb: GlbFile, primitive: Primitive) -> tuple[FloatArray, bool]:
    """(V, 2) texture coordinates with the second one up, NaN for none; whether they are damaged."""
    n_vertices = primitive.n_vertices
    none = np.full((n_vertices, 2), np.nan)
    attributes = glb.mapping(primitive.document, "attributes")
    if "TEXCOORD_0" not in attributes:
        return none, False
    try:
        if glb.count(attributes["TEXCOORD_0"]) != n_vertices:
            return none, True
        given = glb.array(attributes["TEXCOORD_0"]).astype(np.float64)
    except ShapeError:  # no part hangs on them
        return none, True
    if given.shape != (n_vertices, 2) or not np.isfinite(given).all():
        return none, True
    # In glTF the second coordinate runs down from the upper edge.
    return np.stack([given[:, 0], 1.0 - given[:, 1]], axis=1), False


def _corner_texture(textures: list[FloatArray], corners: IntArray) -> CornerValues | None:
    """The texture coordinates of all vertices as those of corners; None where there are none."""
    known = [np.isfinite(texture).all(axis=1) for texture in textures]
    if not any(each.any() for each in known):
        return None
    values = np.nan_to_num(np.concatenate(textures))
    return CornerValues(
        values=values, corners=np.where(np.concatenate(known)[corners], corners, -1)
    )


def _material(glb: GlbFile, primitive: Json) -> str:
    """The name of a primitive's material, or its number; empty where it has none."""
    if "material" not in primitive:
        return ""
    number = primitive["material"]
    try:
        return _name(glb.item("materials", number)) or f"material {number}"
    except ShapeError:  # a number of no material: where parts are does not hang on it
        return ""


@dataclass(frozen=True, kw_only=True)
class GlbPiece:
    """A run of triangles of one node and one material.

    Parameters
    ----------
    node, mesh, material : str or None
        Their names; None where they have none.
    place : int
        Which of the nodes with a mesh it is, from 0, in scene order.
    n_triangles : int
    """

    node: str | None
    mesh: str | None
    material: str | None
    place: int
    n_triangles: int


def read_glb_pieces(path: Path, *, limits: ReadLimits = LIMITS) -> list[GlbPiece]:
    """What the triangles of a GLB file are called, in the order of :func:`read_glb`.

    Parameters
    ----------
    path : Path
    limits : ReadLimits, optional

    Raises
    ------
    ShapeError
        As for :func:`read_glb`.
    """
    glb = GlbFile.parse(path, read_file(path))
    scene = PlacedMeshes(glb, limits)
    pieces: list[GlbPiece] = []
    for place, (node, number, _) in enumerate(_placed_meshes(glb)):
        mesh = scene.mesh(number)
        for primitive in mesh.primitives:
            _, triangles = scene.arrays(primitive)
            material: Json = {}
            if "material" in primitive.document:
                material = glb.item("materials", primitive.document["material"])
            pieces.append(
                GlbPiece(
                    node=_name(node),
                    mesh=_name(mesh.document),
                    material=_name(material),
                    place=place,
                    n_triangles=len(triangles),
                )
            )
    return pieces


def read_glb_up(path: Path) -> Up | None:
    """The axis of the user's coordinates that a file of moseg's own turns to +y.

    Parameters
    ----------
    path : Path

    Returns
    -------
    {"x", "-x", "y", "-y", "z", "-z"} or None
        None where nothing was turned, or another program wrote the file.

    Raises
    ------
    ShapeError
        As for :func:`read_glb`.
    """
    glb = GlbFile.parse(path, read_file(path))
    if not glb.members(glb.document, "scenes"):
        return None
    scene = glb.item("scenes", glb.integer(glb.document, "scene", 0))
    extras = scene.get("extras")
    said = extras.get(UP) if isinstance(extras, dict) else None
    return next((up for up in get_args(Up) if up == said), None)


def _name(item: Json) -> str | None:
    name = item.get("name")
    return name if isinstance(name, str) and name else None


def _placed_meshes(glb: GlbFile) -> Iterator[tuple[Json, object, FloatArray]]:
    """Nodes with a mesh, its number and their placements, (4, 4) to the scene, in scene order."""
    seen: set[object] = set()
    # A stack in place of recursion: chains of nodes may be longer than Python's own stack.
    here = np.eye(4)
    stack: list[tuple[object, FloatArray]] = [(root, here) for root in reversed(_roots(glb))]
    while stack:
        index, parent = stack.pop()
        node = glb.item("nodes", index)
        if index in seen:
            raise glb.damaged(f"nodes[{index}] stands in the scene twice")
        seen.add(index)
        if _INSTANCED in glb.mapping(node, "extensions"):
            raise file_error(glb.path, f"uses the extension {_INSTANCED}; export it without")
        # A product that overflows leaves positions that are not finite, which the mesh reports.
        placement = parent
        if _PLACING & node.keys():
            with np.errstate(over="ignore", invalid="ignore"):
                placement = parent @ _local_placement(glb, node)
        if "mesh" in node:
            stands = np.eye(4) if "skin" in node else placement
            yield node, node["mesh"], stands
        stack.extend((child, placement) for child in reversed(glb.members(node, "children")))


def _left_out(glb: GlbFile, node: Json, mesh: Mesh) -> dict[tuple[str, str], int]:
    """How often there is something in a node that does not come to the shape.

    By what it is and what is done instead.
    """
    found: dict[tuple[str, str], int] = {}
    if "skin" in node:
        done = "read in the pose in which they were modelled, without the placement of their nodes"
        found["meshes with a skin", done] = 1
    if mesh.morphs:
        done = "read without them"
        weights = glb.members(node, "weights")
        if any(weight != 0 for weight in weights) or (not weights and mesh.morphed):
            done += ", though the file shows some of them"
        found["meshes with morph targets", done] = 1
    if mesh.n_lines:
        found["lists of points or lines", "passed over"] = mesh.n_lines
    return found


def _roots(glb: GlbFile) -> list[object]:
    """The numbers of the nodes at the top of the scene."""
    if glb.members(glb.document, "scenes"):
        scene = glb.item("scenes", glb.integer(glb.document, "scene", 0))
        return glb.members(scene, "nodes")
    count = len(glb.members(glb.document, "nodes"))
    nodes = [glb.item("nodes", index) for index in range(count)]
    # Others are no numbers of nodes, which is said when it comes to them.
    children = {
        child for node in nodes for child in glb.members(node, "children") if type(child) is int
    }
    return [index for index in range(count) if index not in children]


def _local_placement(glb: GlbFile, node: Json) -> FloatArray:
    """(4, 4) placement relative to the parent: a matrix, or translation, rotation and scale."""
    if "matrix" in node:
        # The format stores columns one after the other.
        return glb.numbers(node, "matrix", [0.0] * 16).reshape(4, 4).T
    x, y, z, w = glb.numbers(node, "rotation", [0.0, 0.0, 0.0, 1.0])
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    placement = np.eye(4)
    placement[:3, :3] = rotation * glb.numbers(node, "scale", [1.0, 1.0, 1.0])
    placement[:3, 3] = glb.numbers(node, "translation", [0.0, 0.0, 0.0])
    return placement


def _placed(vertices: FloatArray, placement: FloatArray) -> FloatArray:
    """(V, 3) positions in the scene.

    Column by column rather than as a matrix product, whose rounding may depend on where in the
    array a row stands: equal positions must stay equal to be joined.
    """
    x, y, z = vertices.T
    with np.errstate(over="ignore", invalid="ignore"):
        rows = [a * x + b * y + c * z + d for a, b, c, d in placement[:3]]
    return np.stack(rows, axis=1)


def _mirrors(placement: FloatArray) -> bool:
    """Whether a placement turns outsides in."""
    with np.errstate(over="ignore", invalid="ignore"):
        return bool(np.linalg.det(placement[:3, :3]) < 0)
