"""From the contents of a mesh file to a shape, with messages that name the file.

The readers of this package (``off``, ``obj``, ``ply``, ``stl``, ``gltf_reader``) differ in how
they find numbers in bytes and agree in the rest: they read the whole file at once, end in flat
arrays of corners with the polygons *in the order of the file*, since a label belongs to the
polygon at its place in the file, and refuse what they cannot read whole. What they agree in
stands here: :func:`read_file` at the one end, :func:`shape_from_polygons` at the other, and
:func:`file_error` for everything that goes wrong between them. What a reader passes over or
repairs it returns in words with what it read, one note for each kind of thing however often it
came, and hands on as the `notes` of the shape.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from moseg_core.errors import ShapeError
from moseg_core.shape.appearance import Appearance
from moseg_core.shape.geometry import FARTHEST
from moseg_core.shape.mesh import PolygonMesh
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray, IntArray
from moseg_core.untrusted.regular_file import read_regular_file

_LONGEST_WORD = 60
_LINE_ENDS = re.compile(r"\s*[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]+\s*")


def file_error(path: Path, what: str, *, line: int | None = None) -> ShapeError:
    """The error that says what is wrong with a file, and where.

    Parameters
    ----------
    path : Path
    what : str
        What is wrong and what to do about it: without a line, the rest of a sentence of which
        the file is the subject; with one, a sentence.
    line : int, optional
        Counted from 1, where the file has lines.

    Examples
    --------
    >>> print(file_error(Path("models/cup.off"), "is empty; export it again"))
    cup.off is empty; export it again
    >>> print(file_error(Path("models/cup.off"), "'x' is not a number", line=7))
    cup.off, line 7: 'x' is not a number
    """
    where = path.name if line is None else f"{path.name}, line {line}:"
    return ShapeError(f"{where} {_LINE_ENDS.sub(' ', what)}")


def shown(text: str) -> str:
    r"""A word of a file as a message shows it: as it is, or quoted and cut short where it is odd.

    Examples
    --------
    >>> shown("KHR_draco"), shown("a\nb")
    ('KHR_draco', "'a\\nb'")
    """
    return text if text.isprintable() and len(text) <= _LONGEST_WORD else quoted(text)


def quoted(text: str) -> str:
    """A word of a file as a message shows it: in quotes, and not too long.

    Examples
    --------
    >>> quoted("a.bin"), len(quoted(1000 * "x"))
    ("'a.bin'", 62)
    """
    return repr(text if len(text) <= _LONGEST_WORD else text[: _LONGEST_WORD - 3] + "...")


def read_file(path: Path, *, most: int | None = None) -> bytes:
    """All bytes of a file, of which there may be no more than so many.

    Raises
    ------
    ShapeError
        The file cannot be read, is none but a pipe or a device, or is empty.
    """
    try:
        data = read_regular_file(path, most=most)
    except OSError as error:
        reason = error.strerror or str(error)
        raise file_error(path, f"cannot be read ({reason}); check the path {path}") from error
    if not data.strip():
        raise file_error(path, "is empty; export it again")
    return data


def small_faces_note(count: int, where: str) -> list[str]:
    """The note about faces of one or two corners, which are no faces; none where there are none.

    Parameters
    ----------
    count : int
    where : str
        Where the first is.

    Examples
    --------
    >>> small_faces_note(2, "line 7")
    ['faces of fewer than three corners: 2, the first in line 7; they are passed over']
    """
    if not count:
        return []
    return [
        f"faces of fewer than three corners: {count}, the first in {where}; they are passed over"
    ]


def refuse_far(path: Path, points: FloatArray, corners: IntArray, what: str) -> None:
    """Refuse places too far away for their moments to be floats.

    Parameters
    ----------
    path : Path
    points : (n, 3) float
        Those that are not finite are left to others to report.
    corners : (C,) int
        Which of the points count.
    what : str
        What a point is called.

    Raises
    ------
    ShapeError
        Says which it is.
    """
    if points.size and max(points.max(), -points.min()) <= FARTHEST:
        return  # not so where one is no number
    far = (np.isfinite(points) & (np.abs(points) > FARTHEST)).any(axis=1)
    if far.any():
        far &= np.isin(np.arange(len(points)), corners)
    if far.any():
        point = int(np.argmax(far))
        raise file_error(
            path,
            f"has {what} {point} at {points[point].tolist()}, beyond what can be measured;"
            " repair or rescale the file first",
        )


def shape_from_polygons(
    path: Path,
    vertices: FloatArray,
    corners: IntArray,
    offsets: IntArray,
    *,
    appearance: Appearance | None = None,
    notes: Iterable[str] = (),
) -> Shape:
    """The shape that a file describes, named after the file.

    Parameters
    ----------
    path : Path
    vertices : (V, 3) float, model units
    corners : (C,) int
        Vertex indices from 0, one polygon after the other.
    offsets : (F + 1,) int
        Polygon ``f`` has the corners ``corners[offsets[f]:offsets[f + 1]]``.
    appearance : Appearance, optional
        What the file says of how the polygons look.
    notes : iterable of str
        What the reader passed over or repaired; the shape's first notes.

    Raises
    ------
    ShapeError
        There are no polygons, or they make no surface; the message begins with the file's name.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> shape = shape_from_polygons(Path("a/tile.off"), points, np.arange(4), np.array([0, 4]))
    >>> shape.name, shape.n_elements, shape.area
    ('tile', 1, 1.0)
    """
    if len(offsets) < 2:
        raise file_error(
            path,
            "has no faces; export the shape with its faces, or a point cloud as .ply, .xyz or .csv",
        )
    refuse_far(path, vertices, corners, "vertex")
    sizes = np.diff(offsets)
    try:
        if (sizes == sizes[0]).all() and sizes[0] > 0:
            mesh = PolygonMesh.from_faces(vertices, corners.reshape(-1, int(sizes[0])), notes=notes)
        else:
            flat, bounds = corners.tolist(), offsets.tolist()
            faces = [flat[a:b] for a, b in pairwise(bounds)]
            mesh = PolygonMesh.from_faces(vertices, faces, notes=notes)
        mesh = replace(mesh, appearance=appearance)
        return Shape.from_polygon_mesh(mesh, name=path.stem)
    except ShapeError as error:
        raise ShapeError(f"{path.name}: {error}") from error
