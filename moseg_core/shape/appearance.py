"""How a file says that its polygons look: texture coordinates, normals and materials.

None of it has a say in where parts are. It travels with the mesh, corner by corner, so that parts
arrive in the next program as the modeller left them: with the UVs that a texture is laid out by,
the normals that shade it, and the names of its materials. Readers fill it in
(:mod:`moseg_core.io.read.obj`, :mod:`moseg_core.io.read.glb_scene`), writers of the same formats
write it out again. Pieces of cut polygons have it too (:mod:`moseg_core.clipping.looks`); what
regroups polygons otherwise leaves it out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from moseg_core.types import FloatArray, IntArray, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class CornerValues:
    """Values that corners of polygons share, as they share vertices.

    A vertex on a texture seam has several places in the texture, one for each side; so these
    values have numbers of their own, beside those of vertices.

    Parameters
    ----------
    values : (n, k) float
    corners : (C,) int
        The row of `values` that each corner has, in the order of ``PolygonMesh.corners``; -1 for
        a corner that has none.

    Examples
    --------
    >>> seam = CornerValues(values=np.array([[0.0, 0], [1, 0], [1, 1]]),
    ...                     corners=np.array([0, 1, 2, 0, 2, -1]))
    >>> seam.values[seam.corners[:3]].tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]
    """

    values: FloatArray
    corners: IntArray

    def __post_init__(self) -> None:
        frozen(self.values)
        frozen(self.corners)


@dataclass(frozen=True, eq=False, kw_only=True)
class Appearance:
    """Texture coordinates, normals and materials of the polygons of a mesh.

    Parameters
    ----------
    texture : CornerValues or None
        (n, 2): places in the texture, from 0 to 1 across it, the first to the right, the second
        up, as in OBJ files. None where no corner has one.
    normals : CornerValues or None
        (n, 3): directions away from the surface, of any length.
    materials : tuple of str
        Their names, in the order of their first use.
    polygon_materials : (F,) int or None
        The material of each polygon, -1 where it has none; None where no polygon has one.

    Examples
    --------
    >>> look = Appearance(materials=("skin", "eye"), polygon_materials=np.array([0, 0, 1, -1]))
    >>> look.texture is None, look.materials[look.polygon_materials[2]]
    (True, 'eye')
    """

    texture: CornerValues | None = None
    normals: CornerValues | None = None
    materials: tuple[str, ...] = ()
    polygon_materials: IntArray | None = None

    @property
    def several_materials(self) -> bool:
        """Whether materials tell polygons apart: several, or one that some polygons lack."""
        numbers = self.polygon_materials
        return numbers is not None and (len(self.materials) > 1 or bool((numbers < 0).any()))

    def __post_init__(self) -> None:
        if self.polygon_materials is not None:
            frozen(self.polygon_materials)


def material_runs(
    stated: Sequence[tuple[int, str]], n_polygons: int
) -> tuple[tuple[str, ...], IntArray | None]:
    """The materials of polygons that come in runs of one material, as files list them.

    Parameters
    ----------
    stated : sequence of (int, str)
        The first polygon of each run, ascending, and the name; empty for none. What comes before
        the first run has no material.
    n_polygons : int

    Returns
    -------
    names : tuple of str
        Of the materials that a polygon has, by first use.
    materials : (F,) int or None
        -1 for a polygon without one; None where none has one.

    Examples
    --------
    >>> names, materials = material_runs([(1, "skin"), (2, "eye"), (3, "skin")], 4)
    >>> names, materials.tolist()
    (('skin', 'eye'), [-1, 0, 1, 0])
    """
    starts = [0, *(face for face, _ in stated), n_polygons]
    names: dict[str, int] = {}
    numbers = [-1]
    for (_, name), start, stop in zip(stated, starts[1:-1], starts[2:], strict=True):
        used = bool(name) and start < stop
        numbers.append(names.setdefault(name, len(names)) if used else -1)
    if not names:
        return (), None
    return tuple(names), np.repeat(np.array(numbers, np.int64), np.diff(starts))
