"""Labels in a PLY file: a property of the faces, or of the vertices.

Faces come first; of a file without faces, a point cloud, the vertices are the elements. The
property is known by its name (:mod:`moseg_core.io.labels.properties`) or asked for; it may be of
any type, as long as its numbers are whole: CloudCompare writes all of its scalar fields as floats.
moseg itself writes ``label``, names the labels in comments, ``comment moseg label <index>
<name>``, and of pieces that faces were clipped to says in ``source`` of which face each is one.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from moseg_core.io.labels.listing import Listing, Wanted, whole_labels
from moseg_core.io.labels.properties import chosen, familiar
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.ply import whole_faces
from moseg_core.io.read.ply_elements import Numbers, PlyColumns, PlyLists, read_elements
from moseg_core.io.read.ply_header import PlyHeader, parse_header
from moseg_core.types import FloatArray

_INDEX = re.compile(r"[0-9]{1,9}")
_LISTS = ("vertex_indices", "vertex_index")
# What is no label, whatever its numbers are.
_OTHERS = re.compile(r"(x|y|z|n[xyz]|u|v|s|t|red|green|blue|alpha|[rgba]|source)$")


def read_ply_labels(path: Path, wanted: Wanted) -> Listing:
    r"""Read the labels of the faces of a PLY file, or of its vertices.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, is not a PLY file, or has no such property; says which it has.

    Examples
    --------
    >>> import tempfile
    >>> header = ["ply", "format ascii 1.0", "element vertex 2", "property float x",
    ...           "property float y", "property float z", "property float scalar_Label"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "two.ply"
    ...     _ = file.write_text("\n".join([*header, "end_header", "0 0 0 4", "1 0 0 2", ""]))
    ...     read_ply_labels(file, Wanted(n_elements=2)).labels.tolist()
    [4, 2]
    """
    data = read_file(path)
    header = parse_header(path, data)
    elements = read_elements(path, data, header)
    faces, vertices = elements.get("face", {}), elements.get("vertex", {})
    lists = next((faces[name] for name in _LISTS if name in faces), None)
    has_faces = isinstance(lists, PlyLists) and len(lists.offsets) > 1
    bearers = [("face", faces), ("vertex", vertices)] if has_faces else [("vertex", vertices)]
    bearer, name, notes = _property(path, bearers, wanted)
    column = dict(bearers)[bearer][name]
    if isinstance(column, PlyLists):
        raise file_error(
            path,
            f"has a {bearer} property '{name}' that is a list, not one number; export it as int",
        )
    labels = whole_labels(path, column, noun=bearer)
    kept = np.arange(len(labels))
    if bearer == "face" and isinstance(lists, PlyLists):
        kept = np.flatnonzero(whole_faces(lists.offsets))
    labels = labels[kept]
    names = _names(path, header) if name == "label" else ()
    of_faces = bearer == "face"
    places = weights = source = None
    if of_faces and isinstance(lists, PlyLists):
        places, areas = _places(vertices, lists)
        places, areas = (None if each is None else each[kept] for each in (places, areas))
        pieces = faces.get("source")
        if pieces is not None and not isinstance(pieces, PlyLists) and pieces.dtype.kind in "iu":
            source, weights = pieces.astype(np.int64)[kept], areas
    return Listing(
        labels=labels,
        names=names or None,
        of="vertices" if has_faces and not of_faces else "elements",
        notes=notes,
        places=places,
        source=source,
        weights=weights,
    )


def _property(
    path: Path, bearers: list[tuple[str, PlyColumns]], wanted: Wanted
) -> tuple[str, str, tuple[str, ...]]:
    """Whose property holds the labels, what it is called, and what is to be said of the choice."""
    able = {
        bearer: [name for name in columns if name not in _LISTS and not _OTHERS.match(name)]
        for bearer, columns in bearers
    }
    if wanted.properties:
        known = [name for names in able.values() for name in names]
        name, _ = chosen(path, "property", list(dict.fromkeys(known)), wanted.properties)
        if name is not None:
            return next(bearer for bearer, names in able.items() if name in names), name, ()
    for bearer, names in able.items():
        if familiar(names):
            name, notes = chosen(path, "property", names, ())
            assert name is not None  # one is familiar
            return bearer, name, notes
    others = [f"'{name}' of a {bearer}" for bearer, names in able.items() for name in names]
    hint = "; give a file with labelled faces or points"
    if others:
        first = next(name for names in able.values() for name in names)
        hint = (
            f", or another name that is usual for labels; it has {', '.join(others)}: say which"
            f" with --label-property {first}"
        )
    raise file_error(path, f"has no property 'label'{hint}")


def _places(vertices: PlyColumns, lists: PlyLists) -> tuple[FloatArray | None, FloatArray | None]:
    """Middle of the corners, and area, of each face; None where the file tells neither."""
    axes: list[Numbers] = []
    for axis in "xyz":
        column = vertices.get(axis)
        if column is None or isinstance(column, PlyLists):
            return None, None
        axes.append(column)
    points = np.stack([axis.astype(np.float64) for axis in axes], axis=1)
    corners, offsets = lists.values.astype(np.int64), lists.offsets
    sizes = np.diff(offsets)
    inside = not corners.size or (corners.min() >= 0 and corners.max() < len(points))
    if not inside or not (sizes > 0).all() or not np.isfinite(points[corners]).all():
        return None, None
    middles = np.add.reduceat(points[corners], offsets[:-1]) / sizes[:, None]
    following = np.arange(1, len(corners) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    around = points[corners] - np.repeat(middles, sizes, axis=0)
    with np.errstate(over="ignore", invalid="ignore"):  # places too far to be measured
        crosses = np.add.reduceat(np.cross(around, around[following]), offsets[:-1])
        return middles, np.linalg.norm(crosses, axis=1) / 2.0


def _names(path: Path, header: PlyHeader) -> tuple[str, ...]:
    """The names of labels in the header's lines ``comment moseg label <index> <name>``."""
    by_index: dict[int, str] = {}
    for comment in header.comments:
        words = comment.split(maxsplit=3)
        if words[:2] != ["moseg", "label"]:
            continue
        if len(words) < 4 or not _INDEX.fullmatch(words[2]):
            raise file_error(
                path, f"has the comment '{comment}'; it must read 'moseg label <index> <name>'"
            )
        index = int(words[2])
        if index in by_index:
            raise file_error(
                path, f"names label {index} twice: '{by_index[index]}' and '{words[3]}'"
            )
        by_index[index] = words[3]
    if sorted(by_index) != list(range(len(by_index))):
        gap = next(i for i in range(len(by_index)) if i not in by_index)
        raise file_error(path, f"names {len(by_index)} labels, but not label {gap}; name them all")
    return tuple(by_index[index] for index in range(len(by_index)))
