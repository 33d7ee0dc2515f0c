"""One part as a file of its own: a mesh, of which the name is the label.

``.stl`` holds triangles in single precision, ``.obj`` and ``.ply`` the polygons in double,
``.glb`` triangles with smooth normals, about the part's middle. ``.ply`` and ``.glb`` have the
part's colour; points of a cloud are written as such in ``.ply``, as small bodies in ``.glb``. What
becomes of a part before, and how files are called, is :mod:`moseg_core.io.part_files`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from moseg_core.io.write.glb import encode_glb
from moseg_core.io.write.names import safe_file_name
from moseg_core.io.write.ply import encode_ply, encode_points_ply
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.shape.up import Up
from moseg_core.view.point_bodies import drawable


@dataclass(frozen=True, eq=False, kw_only=True)
class PartMesh:
    """What is written of a part.

    Parameters
    ----------
    label : str
    geometry : Geometry or None
        None where there is nothing to write.
    closed : bool
        Whether it is a closed solid: every edge has two faces, and it encloses a volume.
    note : str
        What a user should know of it, to follow the label; empty for nothing.
    shortfall : float, model units
        Of a hull of few vertices how far the part sticks out of it.
    up : {"x", "-x", "y", "-y", "z", "-z"} or None
        The axis of the shape that points up, where it is known; formats that have one of their own
        are turned to it.
    """

    label: str
    geometry: Geometry | None
    closed: bool = False
    note: str = ""
    shortfall: float = 0.0
    up: Up | None = None


def encode_part(part: PartMesh, suffix: str, color: npt.NDArray[np.uint8]) -> bytes:
    """A part as the contents of a file; equal for equal parts.

    Parameters
    ----------
    part : PartMesh
        With a geometry; of points only for some suffixes (:data:`OF_POINTS`).
    suffix : str
        One of :data:`PART_SUFFIXES`.
    color : (3,) uint8
        Red, green and blue, sRGB.

    Examples
    --------
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                               [[0, 1, 2, 3]])
    >>> part = PartMesh(label="my tile", geometry=tile)
    >>> print(encode_part(part, ".obj", np.zeros(3, np.uint8)).decode())
    o my_tile
    v 0.0 0.0 0.0
    v 1.0 0.0 0.0
    v 1.0 1.0 0.0
    v 0.0 1.0 0.0
    f 1 2 3 4
    <BLANKLINE>
    """
    return _ENCODERS[suffix](part, color)


def encode_stl(vertices: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64]) -> bytes:
    """Triangles as a binary STL file.

    Parameters
    ----------
    vertices : (V, 3) float
        Kept in single precision.
    triangles : (T, 3) int

    Examples
    --------
    >>> len(encode_stl(np.eye(3), np.array([[0, 1, 2]])))
    134
    """
    import trimesh
    from trimesh.exchange.stl import export_stl

    mesh = trimesh.Trimesh(vertices=vertices, faces=triangles, process=False)
    return bytes(export_stl(mesh))


def _stl(part: PartMesh, color: npt.NDArray[np.uint8]) -> bytes:
    assert part.geometry is not None  # asked for by the caller
    return encode_stl(part.geometry.vertices, part.geometry.triangles)


def _obj(part: PartMesh, color: npt.NDArray[np.uint8]) -> bytes:
    mesh = part.geometry
    assert isinstance(mesh, PolygonMesh)  # everything but points
    ends = mesh.offsets.tolist()
    corners = (mesh.corners + 1).tolist()
    # repr() keeps all digits of a float, and no more.
    lines = [f"o {safe_file_name(part.label)}"]
    lines += ["v " + " ".join(map(repr, place)) for place in mesh.vertices.tolist()]
    lines += ["f " + " ".join(map(str, corners[start:stop])) for start, stop in pairwise(ends)]
    return ("\n".join(lines) + "\n").encode()


def _ply(part: PartMesh, color: npt.NDArray[np.uint8]) -> bytes:
    mesh = part.geometry
    assert mesh is not None  # asked for by the caller
    labels = np.zeros(mesh.n_elements, np.int64)
    if isinstance(mesh, PointCloud):
        cloud = Shape.from_points(mesh.vertices, areas=mesh.areas, normals=mesh.normals)
        return encode_points_ply(cloud, labels, [part.label], color[None])
    assert isinstance(mesh, PolygonMesh)  # grids have become meshes
    return encode_ply(mesh, labels, [part.label], color[None])


def _glb(part: PartMesh, color: npt.NDArray[np.uint8]) -> bytes:
    assert part.geometry is not None  # asked for by the caller
    labels = np.zeros(part.geometry.n_elements, np.int64)
    return encode_glb(drawable(part.geometry), labels, [part.label], color[None], up=part.up)


_ENCODERS: Mapping[str, Callable[[PartMesh, npt.NDArray[np.uint8]], bytes]] = MappingProxyType(
    {".stl": _stl, ".obj": _obj, ".ply": _ply, ".glb": _glb}
)

PART_SUFFIXES = tuple(_ENCODERS)
"""The formats of a part of its own."""

OF_POINTS = (".ply", ".glb")
"""Those of them that hold points."""
