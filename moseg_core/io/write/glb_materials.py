"""Parts of a GLB file that are made of several materials of the input.

trimesh writes one primitive for a mesh, with one material. Where the input has several materials,
the triangles of a part come sorted by them, and here the primitive becomes one for each run: the
same vertices, a stretch of the same list of triangles, and a material called ``part.material``, of
the colour of the part. So no assignment is lost, and a program can put the user's own in their
place, as for OBJ files (:mod:`moseg_core.io.write.obj`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from moseg_core.shape.appearance import Appearance
from moseg_core.types import IntArray

#: Bytes of an index by the type of its accessor.
_BYTES = {5121: 1, 5123: 2, 5125: 4}

Runs = Sequence[tuple[str, int]]


def material_order(
    part: str, looks: Appearance | None, polygons: IntArray
) -> tuple[IntArray, list[tuple[str, int]]]:
    """The triangles of a part sorted by material, and the runs of these.

    Parameters
    ----------
    part : str
        Its name.
    looks : Appearance or None
    polygons : (k,) int
        The polygon of each triangle of the part.

    Returns
    -------
    order : (k,) int
        Of the triangles; those of one material keep theirs.
    runs : list of (str, int)
        A name and a number of triangles; empty where the input is of one material, or none.

    Examples
    --------
    >>> looks = Appearance(materials=("skin",), polygon_materials=np.array([0, -1, 0]))
    >>> order, runs = material_order("head", looks, np.array([0, 1, 2]))
    >>> order.tolist(), runs
    ([1, 0, 2], [('head', 1), ('head.skin', 2)])
    """
    if looks is None or looks.polygon_materials is None or not looks.several_materials:
        return np.arange(len(polygons)), []
    material = looks.polygon_materials[polygons]
    order = np.argsort(material, kind="stable")
    kinds, counts = np.unique(material, return_counts=True)
    names = [part if kind < 0 else f"{part}.{looks.materials[kind]}" for kind in kinds]
    return order, list(zip(names, counts.tolist(), strict=True))


def split_primitives(tree: dict[str, Any], runs: Mapping[str, Runs]) -> None:
    """Divide the primitives of a glTF document, in place.

    Parameters
    ----------
    tree : dict
        Of one primitive for each mesh, whose material no other has.
    runs : mapping of str to sequence of (str, int)
        By the name of a mesh; those without any stay as they are.
    """
    for mesh in tree["meshes"]:
        if not (stretches := runs.get(mesh["name"])):
            continue
        (primitive,) = mesh["primitives"]
        whole = tree["accessors"][primitive["indices"]]
        material = tree["materials"][primitive["material"]]
        start, pieces = whole.get("byteOffset", 0), []
        for place, (name, count) in enumerate(stretches):
            accessor = {key: whole[key] for key in ("bufferView", "componentType", "type")}
            tree["accessors"].append({**accessor, "byteOffset": start, "count": 3 * count})
            start += 3 * count * _BYTES[whole["componentType"]]
            number = primitive["material"] if place == 0 else len(tree["materials"])
            tree["materials"][number : number + 1] = [{**material, "name": name}]
            indices = len(tree["accessors"]) - 1
            pieces.append({**primitive, "indices": indices, "material": number})
        mesh["primitives"] = pieces
