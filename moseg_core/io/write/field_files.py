"""A field in files: its values, by the order of the elements.

``.npy`` holds the values alone, (F,) float; ``.csv`` a line for each element with where it is and
how much area it has; ``.ply`` the shape with the value of each element as the property ``value``
and a colour for viewers (:mod:`moseg_core.view.ramp`). Equal values give equal bytes.
"""

from __future__ import annotations

import io

import numpy as np
import numpy.typing as npt

from moseg_core.io.write.ply import face_rows, mesh_header
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray
from moseg_core.view.ramp import ramp, shades

_START = ["ply", "format binary_little_endian 1.0"]
_COLORS = [f"property uchar {channel}" for channel in ("red", "green", "blue")]
_END = ["property double value", "end_header\n"]


def encode_field(shape: Shape, values: FloatArray, format: str) -> bytes:
    r"""The values of a field as the contents of a file.

    Parameters
    ----------
    shape : Shape
        As it was read.
    values : (F,) float
    format : {"npy", "csv", "ply"}

    Examples
    --------
    >>> shape = Shape.from_points([[0, 0, 0], [1, 0, 0]], areas=[1, 2])
    >>> print(encode_field(shape, np.array([0.5, 0.1]), "csv").decode().replace("\r\n", "\n"))
    x,y,z,area,value
    0.0,0.0,0.0,1.0,0.5
    1.0,0.0,0.0,2.0,0.1
    <BLANKLINE>
    """
    if format == "csv":
        return _csv(shape, values)
    if format == "ply":
        return _ply(shape, values, ramp()[shades(values)])
    buffer = io.BytesIO()
    np.save(buffer, np.ascontiguousarray(values))
    return buffer.getvalue()


def _csv(shape: Shape, values: FloatArray) -> bytes:
    # repr() keeps all digits of a float, and no more.
    rows = np.column_stack([shape.points, shape.areas, values]).tolist()
    lines = ["x,y,z,area,value", *(",".join(map(repr, row)) for row in rows)]
    return ("\r\n".join(lines) + "\r\n").encode()


def _ply(shape: Shape, values: FloatArray, color: npt.NDArray[np.uint8]) -> bytes:
    mesh = shape.geometry
    if isinstance(mesh, PolygonMesh):
        header = "\n".join([*_START, *mesh_header(mesh), *_END])
        faces = face_rows(mesh, color, {"value": values.astype("<f8")})
        return header.encode() + mesh.vertices.astype("<f8").tobytes() + faces.tobytes()
    row = np.dtype([("place", "<f8", 3), ("color", "u1", 3), ("value", "<f8")])
    rows = np.empty(len(values), row)
    rows["place"], rows["color"], rows["value"] = shape.points, color, values
    axes = [f"property double {axis}" for axis in "xyz"]
    header = "\n".join([*_START, f"element vertex {len(values)}", *axes, *_COLORS, *_END])
    return header.encode() + rows.tobytes()
