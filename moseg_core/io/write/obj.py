"""A segmented mesh as an OBJ file and its materials: the user's own polygons, part by part.

For modelling programs. Polygons stay what they are, quads too, and refer to the vertices of the
input, which the file lists in the input's order with all their digits; texture coordinates and
normals are the input's where a reader kept them (:mod:`moseg_core.shape.appearance`). Each part is
an object (``o``) and a group (``g``) of its name, so that programs that look at either find it, and
the polygons of a part stand together, in the order of the input.

Materials (``usemtl``) are called like parts and have their colours; the file beside it defines them
(``.mtl``). Where the input has several materials, which parts cut across, there is one for each
that a part has, ``part.material``: so no assignment is lost, and the part still shows its colour.
Their colours are sRGB values, as most programs read them.

Sources: the appendix on the object files of the Advanced Visualizer, "Object Files (.obj)" and
"Material Library File (.mtl)".
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from moseg_core.io.write.line_names import line_names
from moseg_core.shape.appearance import Appearance
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.palette import checked_colors

#: What begins a comment or continues a line.
_MEANINGFUL = "#\\"


def encode_obj(
    mesh: Geometry,
    labels: npt.ArrayLike,
    names: Sequence[str],
    colors: npt.ArrayLike,
    *,
    materials_file: str,
) -> tuple[bytes, bytes]:
    r"""Encode a mesh as one object for each part, and the materials of these.

    Parameters
    ----------
    mesh : Geometry
        Of what is no mesh of polygons the triangles are written.
    labels : (F,) array_like of int
        The part of each element, 0 to ``len(names) - 1``.
    names : sequence of str
        One for each part. Parts without polygons are left out.
    colors : (n, 3) array_like of uint8
        Red, green and blue for each part, sRGB.
    materials_file : str
        What the file of materials will be called.

    Returns
    -------
    obj, mtl : bytes
        The contents of the two files, in UTF-8; equal for equal input.

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.
    UsageError
        Not one colour per name.

    Examples
    --------
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                               [[0, 1, 2, 3]])
    >>> obj, mtl = encode_obj(tile, [0], ["tile"], [[65, 112, 216]], materials_file="x.mtl")
    >>> obj.decode().splitlines()[-4:]
    ['o tile', 'g tile', 'usemtl tile', 'f 1 2 3 4']
    >>> mtl.decode().splitlines()[:2]
    ['newmtl tile', 'Kd 0.25490 0.43922 0.84706']
    """
    label = checked_labels(mesh, labels, len(names)).astype(np.int64)
    shades = checked_colors(colors, names) / 255.0
    called = line_names(names, also=_MEANINGFUL)
    vertices, words, offsets, element = _corner_words(mesh)
    label = label[element]
    looks = (mesh.appearance if isinstance(mesh, PolygonMesh) else None) or Appearance()
    material = looks.polygon_materials
    if material is None or not looks.several_materials:
        material = np.full(len(label), -1)
    own = line_names(looks.materials, also=_MEANINGFUL)

    lines = [f"mtllib {materials_file}"]
    lines += _statements("v", vertices)
    lines += [] if looks.texture is None else _statements("vt", looks.texture.values)
    lines += [] if looks.normals is None else _statements("vn", looks.normals.values)
    used: dict[str, int] = {}
    bounds = offsets.tolist()
    for part, name in enumerate(called):
        members = np.flatnonzero(label == part)
        if not len(members):
            continue
        lines += [f"o {name}", f"g {name}"]
        stated = ""
        for face, number in zip(members.tolist(), material[members].tolist(), strict=True):
            wanted = name if number < 0 else f"{name}.{own[number]}"
            if wanted != stated:
                lines.append(f"usemtl {wanted}")
                stated = wanted
                used[wanted] = part
            lines.append("f " + " ".join(words[bounds[face] : bounds[face + 1]]))
    library = [line for name, part in used.items() for line in _material(name, shades[part])]
    return _text(lines), _text(library)


def _corner_words(mesh: Geometry) -> tuple[FloatArray, list[str], IntArray, IntArray]:
    """Vertices; a word for each corner; where the corners of polygons begin; their elements."""
    if not isinstance(mesh, PolygonMesh):
        used, corners = np.unique(mesh.triangles, return_inverse=True)
        offsets = 3 * np.arange(len(mesh.triangles) + 1)
        words = [str(corner) for corner in (corners.reshape(-1) + 1).tolist()]
        return mesh.vertices[used], words, offsets, mesh.triangle_polygon
    element = np.arange(mesh.n_polygons)
    position = (mesh.corners + 1).tolist()
    looks = mesh.appearance or Appearance()
    # A face has texture coordinates, or normals, at all of its corners or at none.
    texture, normal = (
        [""] * len(position) if values is None else _whole(values.corners, mesh.offsets)
        for values in (looks.texture, looks.normals)
    )
    if looks.texture is None and looks.normals is None:
        return mesh.vertices, list(map(str, position)), mesh.offsets, element
    words = [
        f"{v}/{t}/{n}" if n else f"{v}/{t}" if t else f"{v}"
        for v, t, n in zip(position, texture, normal, strict=True)
    ]
    return mesh.vertices, words, mesh.offsets, element


def _whole(corners: IntArray, offsets: IntArray) -> list[str]:
    """Numbers of corners as words, from 1; empty for polygons of which a corner has none."""
    least = np.repeat(np.minimum.reduceat(corners, offsets[:-1]), np.diff(offsets))
    pairs = zip(corners.tolist(), least.tolist(), strict=True)
    return [str(row + 1) if low >= 0 else "" for row, low in pairs]


def _statements(keyword: str, rows: FloatArray) -> list[str]:
    # repr() keeps all digits of a float, and no more.
    return [f"{keyword} {' '.join(map(repr, row))}" for row in rows.tolist()]


def _material(name: str, shade: FloatArray) -> list[str]:
    red, green, blue = shade.tolist()
    return [f"newmtl {name}", f"Kd {red:.5f} {green:.5f} {blue:.5f}", "Ks 0 0 0", "illum 1", ""]


def _text(lines: list[str]) -> bytes:
    return ("\n".join(lines) + "\n").encode()
