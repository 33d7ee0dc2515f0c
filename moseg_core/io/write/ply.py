"""A segmented shape as a PLY file: the user's own polygons, each with its colour and label.

The file holds what was read, vertex for vertex and face for face: nothing is triangulated,
joined or reordered, and coordinates keep all their digits, so that the labels can be used with
the original file as well. Only a clipped mesh has other faces; its ``source`` says whose pieces
they are. Faces have ``red``, ``green``, ``blue`` and ``label``, which moseg reads back with its
names (:mod:`moseg_core.io.labels.ply`). Programs that know properties of vertices only, Blender for
one, find the same there: a vertex has the label that most of its faces have. So along boundaries
colours run into each other, where those of faces stay apart.

The format is binary, little-endian, version 1.0. Of polygons with different numbers of corners
the rows differ in size, which the format provides for and some readers do not expect (trimesh
is one); where all polygons are of one kind every reader should do. Of a point cloud the file holds
the points, with normals where there are any, and of a voxel grid the middle of every cell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from moseg_core.io.labels.fitting import heaviest
from moseg_core.shape.cloud import PointCloud
from moseg_core.shape.labels import checked_labels
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.types import UNLABELLED, IntArray
from moseg_core.view.palette import checked_colors

_COLOR = tuple(f"property uchar {channel}" for channel in ("red", "green", "blue"))
_GREY = np.array([128, 128, 128], np.uint8)  # of vertices that no face uses


def encode_ply(
    mesh: PolygonMesh,
    labels: npt.ArrayLike,
    names: Sequence[str],
    colors: npt.ArrayLike,
    *,
    source: npt.NDArray[np.int64] | None = None,
) -> bytes:
    r"""Encode a mesh with a colour and a label per polygon.

    Parameters
    ----------
    mesh : PolygonMesh
    labels : (F,) array_like of int
        The part of each polygon, 0 to ``len(names) - 1``.
    names : sequence of str
        One for each part; they become comments ``moseg label <index> <name>`` in the header, in
        UTF-8 and on one line each.
    colors : (n, 3) array_like of uint8
        Red, green and blue for each part, sRGB.
    source : (F,) int, optional
        The face that each polygon was cut from, where the mesh was clipped; written as ``source``.

    Returns
    -------
    bytes
        The contents of the file; equal for equal input.

    Raises
    ------
    ShapeError
        Not one integer label per polygon, or a label without a name.
    UsageError
        Not one colour per name.

    Examples
    --------
    >>> tile = PolygonMesh.from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
    ...                               [[0, 1, 2, 3]])
    >>> data = encode_ply(tile, [0], ["tile"], [[65, 112, 216]])
    >>> data.split(b"\n")[:3]
    [b'ply', b'format binary_little_endian 1.0', b'comment moseg label 0 tile']
    """
    label = checked_labels(mesh, labels, len(names)).astype(np.int64)
    palette = checked_colors(colors, names)
    color = palette[label]
    at_vertex = _vertex_labels(mesh, label)
    vertices = np.empty(
        len(mesh.vertices), [("place", "<f8", 3), ("color", "u1", 3), ("label", "<i4")]
    )
    vertices["place"], vertices["label"] = mesh.vertices, at_vertex
    vertices["color"] = np.where(at_vertex[:, None] == UNLABELLED, _GREY, palette[at_vertex])
    header = [
        *_beginning(names),
        *mesh_header(mesh, vertex=(*_COLOR, "property int label")),
        "property int label",
        *(() if source is None else ("property int source",)),
        "end_header\n",
    ]
    numbers = {"label": label} | ({} if source is None else {"source": source})
    whole = {name: column.astype("<i4") for name, column in numbers.items()}
    faces = face_rows(mesh, color, whole)
    return "\n".join(header).encode() + vertices.tobytes() + faces.tobytes()


def _vertex_labels(mesh: PolygonMesh, label: IntArray) -> IntArray:
    """(V,) int: the label that most faces of each vertex have; -1 where no face uses it."""
    of_corner = np.repeat(label, np.diff(mesh.offsets))
    ones = np.ones(len(of_corner))
    return heaviest(mesh.corners, of_corner, ones, len(mesh.vertices))


def encode_points_ply(
    shape: Shape, labels: npt.ArrayLike, names: Sequence[str], colors: npt.ArrayLike
) -> bytes:
    r"""Encode one vertex per element, with a colour and a label each, and no faces.

    Parameters
    ----------
    shape : Shape
        A point cloud or voxel grid.
    labels : (F,) array_like of int
    names : sequence of str
    colors : (n, 3) array_like of uint8
        As for :func:`encode_ply`.

    Raises
    ------
    ShapeError, UsageError
        As for :func:`encode_ply`.

    Examples
    --------
    >>> cloud = Shape.from_points([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> data = encode_points_ply(cloud, [0, 0, 0], ["dots"], [[65, 112, 216]])
    >>> data.split(b"\n")[3]
    b'element vertex 3'
    """
    label = checked_labels(shape.geometry, labels, len(names)).astype(np.int64)
    normals = shape.geometry.normals if isinstance(shape.geometry, PointCloud) else None
    axes = ["x", "y", "z", *([] if normals is None else ["nx", "ny", "nz"])]
    row = np.dtype([("place", "<f8", len(axes)), ("color", "u1", 3), ("label", "<i4")])
    rows = np.empty(len(label), row)
    rows["place"] = shape.points if normals is None else np.hstack([shape.points, normals])
    rows["color"] = checked_colors(colors, names)[label]
    rows["label"] = label
    header = [
        *_beginning(names),
        f"element vertex {len(label)}",
        *(f"property double {axis}" for axis in axes),
        *_COLOR,
        "property int label",
        "end_header\n",
    ]
    return "\n".join(header).encode() + rows.tobytes()


def _beginning(names: Sequence[str]) -> list[str]:
    """The first lines of the header, up to the names of the labels."""
    # A comment ends with its line, and one without a name would be malformed.
    words = {index: " ".join(name.split()) for index, name in enumerate(names)}
    return [
        "ply",
        "format binary_little_endian 1.0",
        *(f"comment moseg label {index} {name}" for index, name in words.items() if name),
    ]


def mesh_header(mesh: PolygonMesh, *, vertex: Sequence[str] = ()) -> list[str]:
    """Header lines of vertices and faces, down to the colours of the faces.

    Parameters
    ----------
    mesh : PolygonMesh
    vertex : sequence of str
        Lines of what vertices have beside their places.
    """
    return [
        f"element vertex {len(mesh.vertices)}",
        *(f"property double {axis}" for axis in "xyz"),
        *vertex,
        f"element face {mesh.n_polygons}",
        f"property list {'uchar' if _short(mesh) else 'int'} int vertex_indices",
        *_COLOR,
    ]


def _short(mesh: PolygonMesh) -> bool:
    """Whether a byte holds the number of corners of every polygon."""
    return bool(np.diff(mesh.offsets).max() < 256)


def face_rows(
    mesh: PolygonMesh, color: npt.NDArray[np.uint8], numbers: Mapping[str, npt.NDArray[Any]]
) -> npt.NDArray[np.uint8]:
    """Encode the rows of the element face; those of one size are made at once.

    Parameters
    ----------
    mesh : PolygonMesh
    color : (F, 3) uint8
    numbers : mapping of str to (F,) arrays
        What follows the colour, little-endian.
    """
    sizes, length = np.diff(mesh.offsets), "<u1" if _short(mesh) else "<i4"

    def row(size: int) -> np.dtype[np.void]:
        return np.dtype(
            [("size", length), ("corners", "<i4", (size,)), ("color", "u1", 3)]
            + [(name, column.dtype.str) for name, column in numbers.items()]
        )

    kinds = np.unique(sizes).tolist()
    steps = np.zeros(len(sizes) + 1, np.int64)
    np.cumsum(sizes * 4 + row(0).itemsize, out=steps[1:])
    data = np.empty(steps[-1], np.uint8)
    for size in kinds:
        members = np.flatnonzero(sizes == size)
        rows = np.empty(len(members), row(size))
        rows["size"] = size
        rows["corners"] = mesh.corners[mesh.offsets[members][:, None] + np.arange(size)]
        rows["color"] = color[members]
        for name, values in numbers.items():
            rows[name] = values[members]
        width = rows.dtype.itemsize
        data[steps[members][:, None] + np.arange(width)] = rows.view(np.uint8).reshape(-1, width)
    return data
