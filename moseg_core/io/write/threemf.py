"""A segmented shape as a 3MF file, for printing: one object for each part, all in their places.

3MF is a ZIP archive of three texts of XML: which kinds of files there are, where the model is, and
the model ("3D Manufacturing Format, Core Specification", version 1.3). Each part is an object of
its own name with the material of its colour; an object of all of them, their assembly, is what is
built, so that a slicer moves them together and can still give each a colour or a filament.

The format wants closed solids: so parts are capped before (:mod:`moseg_core.shape.closing.close`).
It knows units, moseg does not: a unit of the shape is written as a millimetre.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.io.write.line_names import line_names
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray
from moseg_core.view.palette import checked_colors

_MODEL = "3D/3dmodel.model"
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
_START = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_RELATIONS = "application/vnd.openxmlformats-package.relationships+xml"
_MODELS = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml"
_XML = '<?xml version="1.0" encoding="UTF-8"?>\n'

_TYPES = (
    f'{_XML}<Types xmlns="{_PACKAGE}/content-types">'
    f'<Default Extension="rels" ContentType="{_RELATIONS}"/>'
    f'<Default Extension="model" ContentType="{_MODELS}"/></Types>\n'
)
_WHERE = (
    f'{_XML}<Relationships xmlns="{_PACKAGE}/relationships">'
    f'<Relationship Id="model" Target="/{_MODEL}" Type="{_START}"/></Relationships>\n'
)


@dataclass(frozen=True, eq=False, kw_only=True)
class Solid:
    """A part as triangles, closed if it can be.

    Parameters
    ----------
    name : str
    vertices : (V, 3) float, model units
    triangles : (T, 3) int
        Those with two corners at one vertex are left out.
    """

    name: str
    vertices: FloatArray
    triangles: IntArray


def check_solids(shape: Shape) -> None:
    """Refuse what has no parts that could be closed.

    Raises
    ------
    UsageError
        The shape is a point cloud.
    """
    if isinstance(shape.geometry, PointCloud):
        raise UsageError(
            f"'{shape.name}' is a point cloud, and a .3mf file holds solids; points can be written"
            " as .ply, .glb or .vtu"
        )


def encode_3mf(solids: Sequence[Solid], colors: npt.ArrayLike, *, name: str) -> bytes:
    """Encode parts as the objects of an assembly.

    Parameters
    ----------
    solids : sequence of Solid
        At least one with a triangle; those without any are left out.
    colors : (n, 3) array_like of uint8
        Red, green and blue for each, sRGB.
    name : str
        Of the assembly.

    Returns
    -------
    bytes
        The contents of the file; equal for equal input.

    Raises
    ------
    UsageError
        Not one colour per solid.

    Examples
    --------
    >>> corner = Solid(name="corner", vertices=np.eye(4, 3), triangles=np.array([[0, 1, 2]]))
    >>> data = encode_3mf([corner], [[65, 112, 216]], name="shape")
    >>> zipfile.ZipFile(io.BytesIO(data)).namelist()
    ['[Content_Types].xml', '_rels/.rels', '3D/3dmodel.model']
    """
    names = [solid.name for solid in solids]
    shades = checked_colors(colors, names)
    called = [quoteattr(each) for each in line_names([*names, name])]
    bases: list[str] = []
    objects: list[str] = []
    components: list[str] = []
    for solid, said, shade in zip(solids, called[:-1], shades, strict=True):
        mesh = _mesh(solid)
        if not mesh:
            continue
        number = len(bases)
        bases.append(f'<base name={said} displaycolor="#{bytes(shade).hex().upper()}FF"/>')
        objects += [
            f'<object id="{number + 2}" type="model" name={said} pid="1" pindex="{number}">',
            *mesh,
            "</object>",
        ]
        components.append(f'<component objectid="{number + 2}"/>')
    whole = len(bases) + 2
    lines = [
        f'<model unit="millimeter" xml:lang="en-US" xmlns="{_CORE}">',
        "<resources>",
        '<basematerials id="1">',
        *bases,
        "</basematerials>",
        *objects,
        f'<object id="{whole}" type="model" name={called[-1]}>',
        "<components>",
        *components,
        "</components>",
        "</object>",
        "</resources>",
        f'<build><item objectid="{whole}"/></build>',
        "</model>\n",
    ]
    return _archive(
        {"[Content_Types].xml": _TYPES, "_rels/.rels": _WHERE, _MODEL: _XML + "\n".join(lines)}
    )


def _mesh(solid: Solid) -> list[str]:
    """The lines of a mesh; none where no triangle is left."""
    corners = solid.triangles
    corners = corners[(corners != np.roll(corners, 1, axis=1)).all(axis=1)]
    if not len(corners):
        return []
    used, corners = np.unique(corners, return_inverse=True)
    # repr() keeps all digits of a float, and no more.
    points = [
        f'<vertex x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in solid.vertices[used].tolist()
    ]
    faces = [
        f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in corners.reshape(-1, 3).tolist()
    ]
    return [
        "<mesh>", "<vertices>", *points, "</vertices>",
        "<triangles>", *faces, "</triangles>", "</mesh>",
    ]  # fmt: skip


def _archive(texts: dict[str, str]) -> bytes:
    """A ZIP archive in which nothing tells when or where it was made."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in texts.items():
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
            archive.writestr(entry, text.encode())
    return buffer.getvalue()
