"""The meshes of a glTF document: looked through once each, however many nodes place them.

A mesh is a list of primitives, stretches of one material, and a scene may place it any number of
times, so that a short file shows a great deal. Arrays are made when a primitive is first placed and
kept for the next time, and what is placed is counted: :class:`PlacedMeshes` refuses more triangles
and vertices than the bytes of the file may stand for (:mod:`moseg_core.io.read.limits`).
:mod:`moseg_core.io.read.glb_scene` walks the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from moseg_core.io.read.glb_container import GlbFile, Json
from moseg_core.io.read.limits import ReadLimits
from moseg_core.types import FloatArray, IntArray

_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_NO_SURFACE = (0, 1, 2, 3)  # points and lines
_COMPRESSED = "KHR_draco_mesh_compression"
# One of few triangles takes as long to place as one of some.
_LEAST = 16
# Primitives of several materials may have all vertices in common.
_VERTICES = 10


@dataclass(eq=False)
class Primitive:
    """A primitive that has triangles; its arrays are made when it is first placed.

    Parameters
    ----------
    document : mapping
    mode : int
    n_vertices : int
    vertices : (V, 3) float or None
    triangles : (T, 3) int or None
    texture : (V, 2) float or None
    damaged : bool
        Whether its texture coordinates are.
    """

    document: Json
    mode: int
    n_vertices: int
    vertices: FloatArray | None = None
    triangles: IntArray | None = None
    texture: FloatArray | None = None
    damaged: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh:
    """A mesh of the document, looked through once, however many nodes place it.

    Parameters
    ----------
    document : mapping
    primitives : tuple of Primitive
        Those with triangles.
    n_elements : int
        How many triangles they have, or a tenth of the vertices where that is more.
    n_lines : int
        How many others, of points or lines.
    morphs, morphed : bool
        Whether there are morph targets, and whether the mesh itself shows some of them.
    """

    document: Json
    primitives: tuple[Primitive, ...]
    n_elements: int
    n_lines: int
    morphs: bool
    morphed: bool


class PlacedMeshes:
    """The meshes of a scene, each read once; counts what is placed, and refuses too much."""

    def __init__(self, glb: GlbFile, limits: ReadLimits) -> None:
        self._glb = glb
        self._limits = limits
        self._meshes: dict[object, Mesh] = {}
        self._n_elements = 0

    def mesh(self, number: object) -> Mesh:
        """The mesh of a number as a node gives it, which is checked; placed once more."""
        document = self._glb.item("meshes", number)
        if number not in self._meshes:
            self._meshes[number] = self._looked_through(document)
        found = self._meshes[number]
        self._n_elements += found.n_elements
        self._limits.refuse_triangles(self._glb.path, self._n_elements, self._glb.size)
        return found

    def arrays(self, primitive: Primitive) -> tuple[FloatArray, IntArray]:
        """The vertices (V, 3) and triangles (T, 3) of a primitive."""
        if primitive.vertices is None or primitive.triangles is None:
            primitive.vertices, primitive.triangles = _arrays(self._glb, primitive)
        return primitive.vertices, primitive.triangles

    def _looked_through(self, document: Json) -> Mesh:
        glb = self._glb
        primitives: list[Primitive] = []
        n_elements, n_lines, morphs = 0, 0, False
        for primitive in glb.members(document, "primitives"):
            if not isinstance(primitive, dict):
                raise glb.damaged("a primitive must be an object")
            morphs |= "targets" in primitive
            mode = glb.integer(primitive, "mode", _TRIANGLES)
            n_lines += mode in _NO_SURFACE
            if mode not in (_TRIANGLES, _STRIP, _FAN):
                continue
            position = glb.mapping(primitive, "attributes").get("POSITION")
            # Beside compressed data a file may hold the same again, for those that cannot read it.
            if _COMPRESSED in glb.mapping(primitive, "extensions") and (
                "bufferView" not in glb.item("accessors", position)
            ):
                raise glb.unreadable(_COMPRESSED)
            n_vertices = glb.count(position)
            n_indices = glb.count(primitive["indices"]) if "indices" in primitive else n_vertices
            n_triangles = n_indices // 3 if mode == _TRIANGLES else n_indices - 2
            n_elements += max(n_triangles, n_vertices // _VERTICES, _LEAST)
            primitives.append(Primitive(primitive, mode, n_vertices))
        return Mesh(
            document=document,
            primitives=tuple(primitives),
            n_elements=n_elements,
            n_lines=n_lines,
            morphs=morphs,
            morphed=morphs and any(weight != 0 for weight in glb.members(document, "weights")),
        )


def _arrays(glb: GlbFile, primitive: Primitive) -> tuple[FloatArray, IntArray]:
    """The positions (V, 3) and triangles (T, 3) of a primitive."""
    vertices = glb.array(glb.mapping(primitive.document, "attributes").get("POSITION"))
    if vertices.shape[1] != 3:
        raise glb.damaged("positions must have three coordinates")
    indices = np.arange(len(vertices))
    if "indices" in primitive.document:
        listed = glb.array(primitive.document["indices"])
        if listed.shape[1] != 1 or listed.dtype.kind != "u":
            raise glb.damaged("indices must be unsigned integers")
        indices = listed[:, 0].astype(np.int64)
    if indices.size and indices.max() >= len(vertices):
        raise glb.damaged(
            f"a triangle names vertex {indices.max()}, but its primitive has {len(vertices)}"
        )
    return vertices.astype(np.float64), _triangles(glb, indices, primitive.mode)


def _triangles(glb: GlbFile, indices: IntArray, mode: int) -> IntArray:
    """(T, 3) corners of the triangles that a run of indices forms."""
    if mode == _TRIANGLES:
        if len(indices) % 3:
            raise glb.damaged(f"{len(indices)} indices do not make whole triangles")
        return indices.reshape(-1, 3)
    if len(indices) < 3:
        raise glb.damaged(f"{len(indices)} indices make no strip or fan of triangles")
    first, second, third = indices[:-2], indices[1:-1], indices[2:]
    if mode == _FAN:
        return np.stack([second, third, np.full_like(second, indices[0])], axis=1)
    odd = np.arange(len(first)) % 2 == 1
    # Every other triangle of a strip runs the other way round.
    return np.stack([first, np.where(odd, third, second), np.where(odd, second, third)], axis=1)
