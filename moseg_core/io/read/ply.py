"""PLY files: a polygon mesh or a point cloud.

Of the elements that a PLY file may hold (decoded by :mod:`moseg_core.io.read.ply_elements`) two
make a shape: ``vertex`` with the properties x, y and z, and ``face`` with the list
``vertex_indices`` or ``vertex_index``. Without faces the vertices are a point cloud, with the
normals nx, ny, nz if they have such. Everything else is decoded, so that a damaged file is noticed,
and dropped. Labels that faces or points carry are read by :mod:`moseg_core.io.labels.ply`.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from moseg_core.io.read.checked import (
    file_error,
    read_file,
    shape_from_polygons,
    shown,
    small_faces_note,
)
from moseg_core.io.read.clouds import shape_from_points
from moseg_core.io.read.ply_elements import (
    Numbers,
    PlyColumns,
    PlyLists,
    decode_elements,
)
from moseg_core.io.read.ply_header import parse_header
from moseg_core.io.read.text_rows import end_notes
from moseg_core.shape.shape import Shape
from moseg_core.types import BoolArray, FloatArray, IntArray

_MOST_NAMES = 8
_LISTS = ("vertex_indices", "vertex_index")


def read_ply(path: Path) -> Shape:
    r"""Read a PLY file, text or binary: one element per face or, without any, per point.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Shape
        Named after the file.

    Raises
    ------
    ShapeError
        The file cannot be read, is not a PLY file, or holds neither faces nor points.

    Examples
    --------
    >>> import tempfile
    >>> header = ["ply", "format ascii 1.0", "element vertex 4", "property float x",
    ...           "property float y", "property float z", "element face 1",
    ...           "property list uchar int vertex_indices", "end_header"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "tile.ply"
    ...     _ = file.write_text("\n".join([*header, "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"]))
    ...     read_ply(file).n_elements
    1
    """
    data = read_file(path)
    header = parse_header(path, data)
    elements, notes = decode_elements(path, data, header)
    if header.order == "":
        notes += end_notes(data)
    vertices = _vectors(path, elements.get("vertex", {}), "xyz")
    if "tristrips" in elements:
        raise file_error(path, "holds triangle strips, not faces; export it with faces")
    faces = elements.get("face", {})
    lists = [faces[name] for name in _LISTS if name in faces]
    if faces and not lists:
        raise file_error(
            path,
            f"has faces with {_some(list(faces))}, but without the list '{_LISTS[0]}';"
            " export it again",
        )
    if not lists or not _count(lists[0]):
        if not len(vertices):
            raise file_error(path, "has neither faces nor vertices; export it again")
        names = ("nx", "ny", "nz")
        known = set(names) <= set(elements["vertex"])
        normals = _vectors(path, elements["vertex"], names) if known else None
        return shape_from_points(path, vertices, normals=normals, notes=notes)
    found = lists[0]
    if not isinstance(found, PlyLists) or found.values.dtype.kind not in "iu":
        raise file_error(path, "has vertex indices that are not lists of integers; export it again")
    corners, offsets = found.values.astype(np.int64), found.offsets
    kept = whole_faces(offsets)
    if not np.diff(offsets).all():
        raise file_error(
            path,
            f"has a face of no corners, row {np.argmin(np.diff(offsets))} of the faces; its counts"
            " are wrong, or it is damaged; export it again",
        )
    if not kept.all():
        notes += small_faces_note(int((~kept).sum()), f"row {np.argmin(kept)} of the faces")
        corners = corners[np.repeat(kept, np.diff(offsets))]
        offsets = np.concatenate([[0], np.cumsum(np.diff(offsets)[kept])])
    return shape_from_polygons(path, vertices, corners, offsets, notes=notes)


def whole_faces(offsets: IntArray) -> BoolArray:
    """Which faces have three corners at least; others are no elements, nor are their labels.

    Parameters
    ----------
    offsets : (F + 1,) int
        Of the lists of corners.

    Examples
    --------
    >>> whole_faces(np.array([0, 3, 5])).tolist()
    [True, False]
    """
    return np.diff(offsets) > 2


def _some(names: list[str]) -> str:
    more = ", ..." if len(names) > _MOST_NAMES else ""
    return ", ".join(map(shown, names[:_MOST_NAMES])) + more


def _count(column: Numbers | PlyLists) -> int:
    return len(column.offsets) - 1 if isinstance(column, PlyLists) else len(column)


def _vectors(path: Path, columns: PlyColumns, names: Sequence[str]) -> FloatArray:
    axes = []
    for axis in names:
        column = columns.get(axis)
        if column is None or isinstance(column, PlyLists):
            raise file_error(
                path, f"has no coordinate '{axis}' for its vertices; export it with x, y and z"
            )
        axes.append(column.astype(np.float64))
    return np.stack(axes, axis=1)
