"""STL files: triangles with three positions each, in file order.

Binary files are told from text by their length, which their count of triangles determines, and
not by their first word: binary files that begin with "solid" are common. Text files may hold
several solids, which follow each other. Normals and the two attribute bytes are not used.

Bytes behind the triangles that are no further triangles, a line's end or the padding of a block,
are passed over with a note. Where they might be triangles, or are more than those, the count is
wrong, and the file is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, read_file, shape_from_polygons
from moseg_core.io.read.text_rows import Row, leading_floats, text_rows, word
from moseg_core.shape.shape import Shape
from moseg_core.types import FloatArray

_HEADER = 84
_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])

# The lines of one facet: how each begins, and how many words it has.
_FACET = (
    (b"facet", 5),
    (b"outer", 2),
    (b"vertex", 4),
    (b"vertex", 4),
    (b"vertex", 4),
    (b"endloop", 1),
    (b"endfacet", 1),
)
# The words of one facet, None for a number, and where the numbers of its corners begin.
_WORDS = (
    *(b"facet", b"normal", None, None, None, b"outer", b"loop"),
    *(b"vertex", None, None, None) * 3,
    *(b"endloop", b"endfacet"),
)
_FIRST_NUMBERS = (8, 12, 16)


@dataclass(frozen=True, eq=False, kw_only=True)
class StlContents:
    """What an STL file holds: the triangles of a binary one, or a text.

    Parameters
    ----------
    records : (F,) structured array or None
        The triangles, with fields `normal`, `corners` and `attribute`; None of a text.
    text : bytes
        Without what stands behind it; empty of a binary file.
    notes : list of str
        What was passed over.
    """

    records: npt.NDArray[np.void] | None
    text: bytes
    notes: list[str]


def read_stl(path: Path) -> Shape:
    r"""Read an STL file, binary or text: one element per triangle, in file order.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Shape
        Named after the file. Triangles that meet are joined by position.

    Raises
    ------
    ShapeError
        The file cannot be read or is not a mesh in STL; says where and why.

    Examples
    --------
    >>> import tempfile
    >>> corner = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0"
    >>> facet = f"facet normal 0 0 1\nouter loop\n{corner}\nendloop\nendfacet"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "tile.stl"
    ...     _ = file.write_text(f"solid tile\n{facet}\nendsolid tile\n")
    ...     read_stl(file).n_elements
    1
    """
    found = stl_contents(path, read_file(path))
    if found.records is not None:
        positions = found.records["corners"].reshape(-1, 3).astype(np.float64)
    else:
        regular = _regular_positions(found.text)
        positions = _text_positions(path, found.text) if regular is None else regular
    corners = np.arange(len(positions))
    return shape_from_polygons(
        path, positions, corners, np.arange(0, len(positions) + 1, 3), notes=found.notes
    )


def stl_contents(path: Path, data: bytes) -> StlContents:
    r"""Tell a binary file from text, and either from what stands behind it.

    Parameters
    ----------
    path : Path
        For messages.
    data : bytes
        What is in the file.

    Raises
    ------
    ShapeError
        It is neither; says why.

    Examples
    --------
    >>> stl_contents(Path("a.stl"), b"solid a\nendsolid a\n\0\0").text
    b'solid a\nendsolid a\n'
    """
    count = int.from_bytes(data[_HEADER - 4 : _HEADER], "little")
    length = _HEADER + count * _TRIANGLE.itemsize
    text = data.rstrip(b"\0\x1a")
    if len(data) == length or (count > 0 and _padded(data, length)):
        over, behind, records = len(data) - length, "the last triangle", True
    elif data.lstrip()[:5].lower() == b"solid" and b"\0" not in text:
        over, behind, records = len(data) - len(text), "the text", False
    elif len(data) < _HEADER:
        raise file_error(
            path, f"is no STL file: {len(data)} bytes, and no 'solid' in front; export it again"
        )
    else:
        state = "is cut off or damaged" if len(data) < length else "does not match its header"
        raise file_error(
            path,
            f"{state}: {count} triangles take {length} bytes, and there are {len(data)};"
            " export it again",
        )
    notes = [f"bytes behind {behind}: {over}; passed over"] if over else []
    if not records:
        return StlContents(records=None, text=text, notes=notes)
    table = np.frombuffer(data, _TRIANGLE, count, _HEADER)
    return StlContents(records=table, text=b"", notes=notes)


def _padded(data: bytes, length: int) -> bool:
    """Whether what stands behind the triangles of a binary file is something else."""
    over = data[length:]
    if not over.strip(b"\0\r\n \x1a"):
        return bool(over)
    return len(over) % _TRIANGLE.itemsize != 0 and len(over) <= length


def _regular_positions(data: bytes) -> FloatArray | None:
    """(3 F, 3) float: the corners of a text file of one solid, read without regard to lines.

    Several times as fast as :func:`_text_positions`. None where anything is out of the ordinary,
    which the slow reading then accepts or names.
    """
    lines = data.strip().splitlines(keepends=True)
    if lines[-1].split()[:1] != [b"endsolid"]:
        return None
    body = b"".join(lines[1:-1])
    words = body.split()
    n_facets, rest = divmod(len(words), len(_WORDS))
    columns = [words[k :: len(_WORDS)] for k in range(len(_WORDS))]
    if rest or any(
        keyword is not None and column != [keyword] * n_facets
        for keyword, column in zip(_WORDS, columns, strict=True)
    ):
        return None
    positions = np.empty((n_facets, 3, 3))
    try:
        for corner, first in enumerate(_FIRST_NUMBERS):
            for axis in range(3):
                positions[:, corner, axis] = list(map(float, columns[first + axis]))
    except ValueError:
        return None
    return None if b"_" in body else positions.reshape(-1, 3)


def _text_positions(path: Path, data: bytes) -> FloatArray:
    """(3 F, 3) float: the corners of all facets of all solids."""
    rows, lines = text_rows(data, comment=None)
    keywords = [row[0].lower() for row in rows]
    # What follows the name of a solid is free text, so these lines are cut out by keyword alone.
    body = [i for i, key in enumerate(keywords) if key not in (b"solid", b"endsolid")]
    n_facets, rest = divmod(len(body), len(_FACET))
    pattern = _FACET * n_facets + _FACET[:rest]
    for i, (keyword, width) in zip(body, pattern, strict=True):
        if keywords[i] != keyword or len(rows[i]) != width:
            raise _unexpected(path, rows[i], keyword, lines[i])
    if rest:
        raise file_error(path, "ends within a triangle; it is cut off, export it again")
    _check_solids(path, keywords, lines)
    vertices = [i for i in body if keywords[i] == b"vertex"]
    return leading_floats(path, [rows[i] for i in vertices], [lines[i] for i in vertices], start=1)


def _check_solids(path: Path, keywords: list[bytes], lines: list[int]) -> None:
    """Refuse anything outside of solids, solids that do not end, and facets split by either."""
    inside, start = False, 0
    for i, keyword in enumerate(keywords):
        if keyword == b"solid" and not inside:
            inside, start = True, i + 1
        elif keyword == b"endsolid" and inside:
            if (i - start) % len(_FACET):
                raise file_error(
                    path,
                    "the solid ends within a facet; the file is damaged, export it again",
                    line=lines[i],
                )
            inside = False
        elif keyword in (b"solid", b"endsolid") or not inside:
            raise file_error(
                path,
                f"{word(keyword)} is out of place; the file is damaged, export it again",
                line=lines[i],
            )
    if inside:
        raise file_error(path, "ends without 'endsolid'; it is cut off, export it again")


def _unexpected(path: Path, row: Row, keyword: bytes, line: int) -> ShapeError:
    found = b" ".join(row)
    what = f"expected the '{keyword.decode()}' line of a triangle, found {word(found)}"
    return file_error(path, f"{what}; the file is damaged, export it again", line=line)
