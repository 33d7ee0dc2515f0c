"""OBJ files: statements, one a line, of which positions and faces make the shape.

A label belongs to a face line, so face lines are kept one to one and in order, whatever objects,
groups and materials they stand between, and a quad or larger polygon stays one polygon. Texture
coordinates and normals do not cut the surface: corners are joined by position. They and the names
of materials are kept beside the polygons, for writers (:mod:`moseg_core.io.read.obj_appearance`).

Programs add statements of their own (``e`` for the edges of MeshCNN). What is unknown and cannot be
a damaged vertex or face line is passed over, and so are faces of one or two corners, which are no
faces; the shape's notes say so.

An OBJ file has no counts. A file that was cut off between two lines cannot be told from a whole
one unless faces then name vertices that are missing; one that was cut inside a line mostly can.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import (
    file_error,
    read_file,
    shape_from_polygons,
    small_faces_note,
)
from moseg_core.io.read.obj_appearance import (
    corner_numbers,
    corner_values,
    other_numbers,
)
from moseg_core.io.read.text_rows import (
    Row,
    end_notes,
    integers,
    leading_floats,
    line_of_item,
    text_rows,
    word,
)
from moseg_core.shape.appearance import Appearance, material_runs
from moseg_core.shape.shape import Shape
from moseg_core.types import IntArray

_MOST_NOTES = 12

# Geometry that is not polygons of this file: free-form patches, and other files.
_UNSUPPORTED = frozenset(b"surf bsp bzp cdp call".split())

# Statements without a say in which polygons there are.
_IGNORED = frozenset(
    b"vt vn vp vw p l o g s mg t mtllib maplib usemtl usemap lod bevel c_interp d_interp"
    b" shadow_obj trace_obj deg bmat step cstype res curv curv2 cdc parm trim hole scrv sp end con"
    b" ctech stech csh".split()
)


# An unknown statement has a name. One that begins with f, or like a v with its number, may be a
# damaged line of a face or vertex, and every later label or number would be off by one.
_STATEMENT = re.compile(rb"(?![fF])[A-Za-z_][\w.:-]*")
_DAMAGED = re.compile(rb"v[-.\d]", re.IGNORECASE)


def read_obj(path: Path) -> Shape:
    r"""Read an OBJ file: one element per face line, in file order.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Shape
        Named after the file. Points and lines (``p``, ``l``) are no part of it.

    Raises
    ------
    ShapeError
        The file cannot be read or is not a polygon mesh in OBJ; says where and why.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "tile.obj"
    ...     _ = file.write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    ...     read_obj(file).n_elements
    1
    """
    data = read_file(path)
    rows, lines = text_rows(data, continuation=True)
    positions: list[Row] = []
    position_lines: list[int] = []
    faces: list[Row] = []
    face_lines: list[int] = []
    textures: list[Row] = []
    texture_lines: list[int] = []
    normals: list[Row] = []
    normal_lines: list[int] = []
    materials: list[tuple[int, str]] = []
    unknown: dict[bytes, list[int]] = {}
    small: list[int] = []
    for row, line in zip(rows, lines, strict=True):
        keyword = row[0]
        if keyword == b"v":
            positions.append(row)
            position_lines.append(line)
        elif keyword == b"f" or keyword == b"fo":
            if 1 < len(row) < 4:
                small.append(line)
                continue
            faces.append(row)
            face_lines.append(line)
        elif keyword == b"vt":
            textures.append(row)
            texture_lines.append(line)
        elif keyword == b"vn":
            normals.append(row)
            normal_lines.append(line)
        elif keyword == b"usemtl":
            materials.append((len(faces), b" ".join(row[1:]).decode("utf-8", "replace")))
        elif keyword not in _IGNORED:
            if (
                keyword in _UNSUPPORTED
                or not _STATEMENT.fullmatch(keyword)
                or _DAMAGED.match(keyword)
            ):
                raise _unexpected(path, keyword, line)
            unknown.setdefault(keyword, []).append(line)
    if unknown and not faces:
        raise _unexpected(path, *next((keyword, found[0]) for keyword, found in unknown.items()))
    if small and small[-1] == lines[-1] and not data.endswith((b"\n", b"\r")):
        raise file_error(path, "the last face is cut off; export it again", line=lines[-1])
    notes = small_faces_note(len(small), f"line {small[0]}" if small else "")
    notes += [
        f"statement {word(keyword)} is unknown and passed over"
        f" ({_times(found)}, first in line {found[0]})"
        for keyword, found in unknown.items()
    ]
    over = len(notes) - _MOST_NOTES
    if over > 0:
        notes[_MOST_NOTES - 1 :] = [f"{over + 1} more statements are unknown and passed over"]
    vertices = leading_floats(path, positions, position_lines, start=1)
    numbers, offsets = _faces(path, faces, face_lines)
    sizes = np.diff(offsets)

    def places(column: int, stated: list[int]) -> IntArray:
        return _from_zero(numbers[:, column], stated, face_lines, sizes)

    corners = places(0, position_lines)
    _check_vertices(path, numbers[:, 0], corners, len(positions), line_of_item(offsets, face_lines))
    texture, texture_notes = corner_values(
        "texture coordinates", textures, numbers[:, 1] != 0, places(1, texture_lines)
    )
    shading, shading_notes = corner_values(
        "normals", normals, numbers[:, 2] != 0, places(2, normal_lines)
    )
    names, polygon_materials = material_runs(materials, len(faces))
    appearance = Appearance(
        texture=texture, normals=shading, materials=names, polygon_materials=polygon_materials
    )
    notes += texture_notes + shading_notes + end_notes(data)
    return shape_from_polygons(path, vertices, corners, offsets, appearance=appearance, notes=notes)


def _times(found: list[int]) -> str:
    return "once" if len(found) == 1 else f"{len(found)} times"


def _unexpected(path: Path, keyword: bytes, line: int) -> ShapeError:
    if keyword in _UNSUPPORTED:
        what = f"{word(keyword)} is not supported; export the file with polygons (f) only"
    else:
        what = (
            f"{word(keyword)} is not a statement of an OBJ file;"
            " the file is damaged or of another format"
        )
    return file_error(path, what, line=line)


def _from_zero(numbers: IntArray, stated: list[int], faces: list[int], sizes: IntArray) -> IntArray:
    """Numbers of corners counted from 0, negative where there is nothing of the number.

    They count from 1; negative ones count back from the last of the statements that stand before
    the face, by lines.
    """
    if not numbers.size or numbers.min() >= 0:
        return numbers - 1
    defined = np.repeat(np.searchsorted(stated, faces), sizes)
    return np.where(numbers < 0, numbers + defined, numbers - 1)


def _faces(path: Path, rows: list[Row], lines: list[int]) -> tuple[IntArray, IntArray]:
    """(C, 3) numbers of the corners of the face lines as they stand there, and offsets."""
    sizes = np.array([len(row) - 1 for row in rows], np.int64)
    if (sizes < 1).any():
        face = int(np.argmax(sizes < 1))
        what = f"a face needs at least 3 corners, this one has {sizes[face]}; remove or repair it"
        raise file_error(path, what, line=lines[face])
    offsets = np.zeros(len(rows) + 1, np.int64)
    np.cumsum(sizes, out=offsets[1:])
    tokens = [token for row in rows for token in row[1:]]
    numbers = np.zeros((len(tokens), 3), np.int64)
    found = corner_numbers(tokens)
    if found is not None:
        numbers[:, : found.shape[1]] = found
    else:
        first = [token.partition(b"/")[0] for token in tokens]
        numbers[:, 0] = integers(path, first, line_of_item(offsets, lines))
        numbers[:, 1:] = other_numbers(tokens)
    return numbers, offsets


def _check_vertices(
    path: Path,
    numbers: IntArray,
    corners: IntArray,
    n_vertices: int,
    line_of: Callable[[int], int],
) -> None:
    """Refuse faces that name vertices which are not there."""
    outside = (corners < 0) | (corners >= n_vertices)
    if outside.any():
        corner = int(np.argmax(outside))
        what = (
            f"the face names vertex {numbers[corner]}, but there are {n_vertices} vertices"
            " (numbered from 1, or from -1 backwards); the file is cut off or damaged"
        )
        raise file_error(path, what, line=line_of(corner))
