"""A segmented shape as a VTU file, an unstructured grid of VTK: for simulation and ParaView.

Every element is a cell, in the order of the input: a polygon a triangle, quad or polygon, a cell of
a voxel grid a hexahedron, a point a vertex. Cells have data: ``label``, the number of the part, and
``area`` (of solid cells their volume); of clipped meshes ``source``, the face that each piece was
cut from. What labels are called stands in the field data, a number under each name, as meshio keeps
the physical groups of Gmsh: ``field_data["head"]`` is ``[label, dimension]``. VTK's own arrays of
texts would stop meshio, which reads numbers alone.

Arrays are binary within the XML, base64 after a header of 8 bytes that counts them, little-endian
and not compressed ("VTK XML Formats", and the VTK User's Guide, "VTK File Formats").
"""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

from moseg_core.io.write.line_names import line_names
from moseg_core.shape.geometry import Geometry
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.types import FloatArray, IntArray

# Types of cells, as vtkCellType.h numbers them.
_VERTEX, _TRIANGLE, _POLYGON, _QUAD, _HEXAHEDRON = 1, 5, 7, 9, 12

#: From a cell's corners, those of number k at the bits of k, to the order of a hexahedron.
_AROUND = np.array([0, 4, 6, 2, 1, 5, 7, 3])


def encode_vtu(
    geometry: Geometry,
    labels: npt.ArrayLike,
    names: Sequence[str],
    data: Mapping[str, FloatArray | IntArray],
) -> bytes:
    r"""Encode elements as cells with a label each.

    Parameters
    ----------
    geometry : Geometry
    labels : (F,) array_like of int
        The part of each element, 0 to ``len(names) - 1``.
    names : sequence of str
        One for each part.
    data : mapping of str to (F,) array
        What else there is to say of each element.

    Returns
    -------
    bytes
        The contents of the file; equal for equal input.

    Raises
    ------
    ShapeError
        Not one integer label per element, or a label without a name.

    Examples
    --------
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                               [[0, 1, 2, 3]])
    >>> text = encode_vtu(tile, [0], ["tile"], {"area": np.array([1.0])}).decode()
    >>> text.splitlines()[6]
    '<Piece NumberOfPoints="4" NumberOfCells="1">'
    """
    label = checked_labels(geometry, labels, len(names)).astype(np.int32)
    corners, offsets, kinds, dimension = _cells(geometry)
    words = [
        _array("Int32", name, np.array([k, dimension], np.int32), tuples=2)
        for k, name in enumerate(line_names(names))
    ]
    columns = {"label": label, **data}
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian"'
        ' header_type="UInt64">',
        "<UnstructuredGrid>",
        "<FieldData>",
        *words,
        "</FieldData>",
        f'<Piece NumberOfPoints="{len(geometry.vertices)}" NumberOfCells="{len(label)}">',
        "<Points>",
        _array("Float64", "Points", geometry.vertices),
        "</Points>",
        "<Cells>",
        _array("Int64", "connectivity", corners),
        _array("Int64", "offsets", offsets[1:]),
        _array("UInt8", "types", kinds),
        "</Cells>",
        '<CellData Scalars="label">',
        *(
            _array("Float64" if column.dtype.kind == "f" else "Int32", name, column)
            for name, column in columns.items()
        ),
        "</CellData>",
        "</Piece>",
        "</UnstructuredGrid>",
        "</VTKFile>",
        "",
    ]
    return "\n".join(lines).encode()


def _cells(geometry: Geometry) -> tuple[IntArray, IntArray, npt.NDArray[np.uint8], int]:
    """Corners, offsets, types and the dimension of the cells that stand for elements."""
    sizes = np.diff(geometry.offsets)
    if isinstance(geometry, PolygonMesh):
        kinds = np.where(sizes == 3, _TRIANGLE, np.where(sizes == 4, _QUAD, _POLYGON))
        return geometry.corners, geometry.offsets, kinds.astype(np.uint8), 2
    if (sizes == 1).all():
        return geometry.corners, geometry.offsets, np.full(len(sizes), _VERTEX, np.uint8), 0
    corners = geometry.corners.reshape(-1, 8)[:, _AROUND].reshape(-1)
    return corners, geometry.offsets, np.full(len(sizes), _HEXAHEDRON, np.uint8), 3


_TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "<u1"}


def _array(kind: str, name: str, values: npt.NDArray[Any], *, tuples: int | None = None) -> str:
    """An array as an element of XML; of field data with the number of its rows."""
    data = np.ascontiguousarray(values, _TYPES[kind]).tobytes()
    counted = np.array([len(data)], "<u8").tobytes()
    said = "" if tuples is None else f' NumberOfTuples="{tuples}"'
    said += f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    text = base64.b64encode(counted + data).decode()
    start = f'<DataArray type="{kind}" Name={quoteattr(name)}{said} format="binary">'
    return f"{start}{text}</DataArray>"
