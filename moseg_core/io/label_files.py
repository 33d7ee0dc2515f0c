"""Labels from files, and to the simplest of them: one per surface element, maybe with names.

Seven kinds of file carry a labelling of the elements of a shape:

======  ==========================================================================
suffix  contents
======  ==========================================================================
.seg    one integer a line: the label of face i on line i (Chen et al. 2009)
.txt    a line with a name, then a line with the face ids that bear it, counted
        from 1; and so on (Kalogerakis et al. 2010)
.json   a result of moseg: ``labels``, and ``problem.labels`` with the names
.ply    the property ``label`` of the faces, or of the points where there are none;
        names in comments; see :mod:`moseg_core.io.read.ply`
.glb    the triangles of named nodes; see :mod:`moseg_core.io.read.glb_scene`
.npz    the arrays ``labels`` and maybe ``names``
.npy    a grid of labels, -1 where there is no element, or a row of labels
======  ==========================================================================

A labelling belongs to a shape, so reading takes the number of its elements and refuses what does
not fit it. The first two can be written without a result too.
"""

from __future__ import annotations

import io
import json
import os
import re
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.io.files import write_file
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.glb_scene import read_glb_names
from moseg_core.io.read.grids import read_array
from moseg_core.io.read.ply import read_ply_label_names, read_ply_labels
from moseg_core.io.read.text_rows import integers, text_rows, word
from moseg_core.types import IntArray

# What a name must not begin with, so that it cannot be taken for a line of face ids.
_FACE_ID = re.compile(r"[+-]?[0-9]+(\s|$)")


@dataclass(frozen=True, eq=False, kw_only=True)
class Labelling:
    """One label per surface element.

    Parameters
    ----------
    labels : (F,) int
        From 0.
    names : tuple of str or None
        ``names[k]`` is the name of label ``k``; None where the file has no names.
    """

    labels: IntArray
    names: tuple[str, ...] | None


def read_labels(path: str | os.PathLike[str], n_elements: int) -> Labelling:
    r"""Read the labelling of a shape, in the format that the suffix says.

    Parameters
    ----------
    path : path-like
        With the suffix ".seg", ".txt", ".json", ".ply", ".glb", ".npz" or ".npy".
    n_elements : int
        How many elements the shape has.

    Returns
    -------
    Labelling
        With one label for each element.

    Raises
    ------
    UsageError
        Another suffix.
    ShapeError
        The file cannot be read, is malformed, or does not fit the shape.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cup_labels.txt"
    ...     _ = file.write_text("body\n1 3\nhandle\n2\n")
    ...     cup = read_labels(file, 3)
    >>> cup.labels.tolist(), cup.names
    ([0, 1, 0], ('body', 'handle'))
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        kind = f"'{path.suffix}'" if path.suffix else "no suffix"
        raise UsageError(
            f"{path.name}: cannot read labels from a file with {kind};"
            f" allowed: {', '.join(_READERS)}"
        )
    labelling = reader(path, n_elements)
    labels, names = labelling.labels, labelling.names
    if len(labels) != n_elements:
        raise file_error(
            path,
            f"has {len(labels)} labels but the shape has {n_elements} elements;"
            " give the labels of this very shape",
        )
    if labels.size and labels.min() < 0:
        face = int(np.argmax(labels < 0))
        raise file_error(
            path, f"gives element {face} the label {labels[face]}; labels and elements count from 0"
        )
    if names is not None and labels.size and labels.max() >= len(names):
        face = int(np.argmax(labels >= len(names)))
        raise file_error(
            path,
            f"gives element {face} the label {labels[face]}, but names only {len(names)} labels"
            " (both counted from 0)",
        )
    return labelling


def _read_seg(path: Path, n_elements: int) -> Labelling:
    rows, lines = text_rows(read_file(path), comment=None)
    for row, line in zip(rows, lines, strict=True):
        if len(row) != 1:
            raise file_error(path, f"expected one label, found {len(row)} words", line=line)
    labels = integers(path, [row[0] for row in rows], lambda i: lines[i])
    if labels.size and labels.min() < 0:
        index = int(np.argmax(labels < 0))
        raise file_error(
            path,
            f"the label {labels[index]} is negative; labels count from 0, and each face has one",
            line=lines[index],
        )
    return Labelling(labels=labels, names=None)


def _read_named(path: Path, n_elements: int) -> Labelling:
    numbers: dict[str, int] = {}  # of names, in the order of their first appearance
    labels = np.full(n_elements, -1, np.int64)
    origin = np.zeros(n_elements, np.int64)  # the line on which each face stands
    name: str | None = None
    for line, raw in enumerate(read_file(path).removeprefix(b"\xef\xbb\xbf").splitlines(), 1):
        if name is None:
            if raw.strip():
                name = _name(path, raw, line)
                numbers.setdefault(name, len(numbers))
            continue
        # The line behind a name is its faces even when blank: no face bears the name.
        label, name = numbers[name], None
        faces = _face_ids(path, raw.split(), line, n_elements)
        taken = labels[faces] >= 0
        if taken.any():
            face = int(faces[np.argmax(taken)])
            raise file_error(
                path,
                f"face {face + 1} stands on line {origin[face]} already; remove one",
                line=line,
            )
        labels[faces] = label
        origin[faces] = line
    if name is not None:
        raise file_error(path, f"ends behind the name '{name}', without its faces; it is cut off")
    missing = labels < 0
    if missing.any():
        face = int(np.argmax(missing))
        raise file_error(
            path,
            f"has no label for face {face + 1} ({int(missing.sum())} such of {n_elements});"
            " every face needs one",
        )
    return Labelling(labels=labels, names=tuple(numbers))


def _name(path: Path, raw: bytes, line: int) -> str:
    try:
        name = raw.decode("utf-8").strip()
    except UnicodeDecodeError as error:
        raise file_error(
            path, f"{word(raw)} is not UTF-8; save the file as such", line=line
        ) from error
    if _FACE_ID.match(name):
        raise file_error(
            path,
            f"expected the name of a label, found {word(raw)};"
            " all faces of a label stand on the one line behind its name",
            line=line,
        )
    return name


def _face_ids(path: Path, tokens: list[bytes], line: int, n_elements: int) -> IntArray:
    """Zero-based faces from one line of ids."""
    ids = integers(path, tokens, lambda _: line)
    outside = (ids < 1) | (ids > n_elements)
    if outside.any():
        what = f"face {ids[np.argmax(outside)]} is none of the shape's faces, 1 to {n_elements}"
        raise file_error(path, f"{what}; give the labels of this very shape", line=line)
    ordered = np.sort(ids)
    twice = ordered[1:] == ordered[:-1]
    if twice.any():
        face = ordered[1:][np.argmax(twice)]
        raise file_error(path, f"face {face} stands twice on this line; remove one", line=line)
    return ids - 1


def _read_result(path: Path, n_elements: int) -> Labelling:
    try:
        result = json.loads(read_file(path))
    except (ValueError, RecursionError) as error:
        raise file_error(path, f"is not JSON ({error}); give a result of moseg") from error
    listed = result.get("labels") if isinstance(result, dict) else None
    if not isinstance(listed, list) or not all(type(label) is int for label in listed):
        raise file_error(path, "has no list of integers 'labels'; give a result of moseg")
    if not all(-(2**63) <= label < 2**63 for label in listed):
        raise file_error(path, "has labels that are too large; labels count from 0")
    described = result.get("problem", {})
    names = described.get("labels") if isinstance(described, dict) else None
    if names is not None and not (
        isinstance(names, list) and all(isinstance(name, str) for name in names)
    ):
        raise file_error(path, "has a member problem.labels that is not a list of names")
    labels = np.array(listed, np.int64)
    return Labelling(labels=labels, names=None if names is None else tuple(names))


def _read_ply(path: Path, n_elements: int) -> Labelling:
    labels = read_ply_labels(path)
    if labels is None:
        raise file_error(path, "has no property 'label'; give a file with labelled faces or points")
    by_index = read_ply_label_names(path)
    if sorted(by_index) != list(range(len(by_index))):
        gap = next(i for i in range(len(by_index)) if i not in by_index)
        raise file_error(path, f"names {len(by_index)} labels, but not label {gap}; name them all")
    names = tuple(by_index[index] for index in range(len(by_index)))
    return Labelling(labels=labels, names=names or None)


def _read_glb(path: Path, n_elements: int) -> Labelling:
    labels, names = read_glb_names(path)
    return Labelling(labels=labels, names=names)


def _read_npz(path: Path, n_elements: int) -> Labelling:
    data = read_file(path)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            labels = archive["labels"]
            names = archive["names"].tolist() if "names" in archive.files else None
    except (KeyError, ValueError, EOFError, OSError, BadZipFile, zlib.error) as problem:
        raise file_error(path, f"has no array 'labels' ({problem}); save it anew") from problem
    if names is not None and not (
        isinstance(names, list) and all(isinstance(name, str) for name in names)
    ):
        raise file_error(path, "has an array 'names' that is not a row of texts; save it anew")
    return Labelling(labels=_row(path, labels), names=None if names is None else tuple(names))


def _read_npy(path: Path, n_elements: int) -> Labelling:
    labels = read_array(path)
    if labels.ndim == 3 and labels.dtype.kind in "iu":
        labels = labels[labels.astype(np.int64) >= 0]  # in C order, as cells are numbered
    return Labelling(labels=_row(path, labels), names=None)


def _row(path: Path, labels: npt.NDArray[np.generic]) -> IntArray:
    """Labels from an array, or an error that says what it is instead."""
    if labels.ndim != 1 or labels.dtype.kind not in "iu":
        raise file_error(
            path, f"holds {labels.dtype} of shape {labels.shape} instead of a row of whole labels"
        )
    return labels.astype(np.int64)


_READERS: dict[str, Callable[[Path, int], Labelling]] = {
    ".seg": _read_seg,
    ".txt": _read_named,
    ".json": _read_result,
    ".ply": _read_ply,
    ".glb": _read_glb,
    ".npz": _read_npz,
    ".npy": _read_npy,
}


def save_labels(
    labels: npt.ArrayLike,
    path: str | os.PathLike[str],
    *,
    names: Sequence[str] | None = None,
) -> None:
    """Write the labelling of a shape, in the format that the suffix says.

    Parameters
    ----------
    labels : (F,) array_like of int
        From 0.
    path : path-like
        With the suffix ".seg", which keeps numbers alone, or ".txt", which needs names.
    names : sequence of str, optional
        ``names[k]`` is the name of label ``k``.

    Raises
    ------
    UsageError
        Another suffix, ".txt" without names, or labels and names that could not be read back.
    MosegError
        The file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "cup_labels.txt"
    ...     save_labels([0, 1, 0], file, names=["body", "handle"])
    ...     cup = read_labels(file, 3)
    >>> cup.labels.tolist(), cup.names
    ([0, 1, 0], ('body', 'handle'))
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in (".seg", ".txt"):
        raise UsageError(f"labels are written as .txt or .seg, not '{suffix or path.name}'")
    if suffix == ".seg":
        write_file(path, encode_seg(labels))
    elif names is None:
        raise UsageError(f"'{path}' needs names for the labels; give them, or write a .seg file")
    else:
        write_file(path, encode_named_labels(labels, names))


def encode_seg(labels: npt.ArrayLike) -> bytes:
    r"""The contents of a ``.seg`` file: one label a line.

    Parameters
    ----------
    labels : (F,) array_like of int
        From 0.

    Raises
    ------
    UsageError
        Labels that are not a row of integers from 0.

    Examples
    --------
    >>> encode_seg([0, 2, 0])
    b'0\n2\n0\n'
    """
    return "".join(f"{label}\n" for label in _checked(labels).tolist()).encode("ascii")


def encode_named_labels(labels: npt.ArrayLike, names: Sequence[str]) -> bytes:
    r"""The contents of a ``.txt`` file: each name, then the ids of its faces, counted from 1.

    Parameters
    ----------
    labels : (F,) array_like of int
        From 0, indices into `names`.
    names : sequence of str
        Distinct; a name that no face bears is written with an empty line of faces.

    Raises
    ------
    UsageError
        Labels without a name, or names that could not be read back: empty, of several lines,
        repeated, or beginning like a face id.

    Examples
    --------
    >>> encode_named_labels([0, 1, 0], ["body", "handle"])
    b'body\n1 3\nhandle\n2\n'
    """
    checked = _checked(labels)
    if checked.size and checked.max() >= len(names):
        raise UsageError(f"label {checked.max()} has no name; there are {len(names)} names")
    for name in names:
        if not name or name != name.strip() or len(name.splitlines()) > 1 or _FACE_ID.match(name):
            raise UsageError(
                f"the label name {name!r} cannot be written to a .txt file: a name is one line,"
                " without blanks at its ends, and does not begin with a number of its own"
            )
    if len(set(names)) < len(names):
        twice = next(name for i, name in enumerate(names) if name in names[:i])
        raise UsageError(f"the label name '{twice}' is repeated; names must be distinct")
    lines = []
    for index, name in enumerate(names):
        lines += [name, " ".join(map(str, (np.flatnonzero(checked == index) + 1).tolist()))]
    return "".join(f"{line}\n" for line in lines).encode("utf-8")


def _checked(labels: npt.ArrayLike) -> IntArray:
    array = np.asarray(labels)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise UsageError(f"labels must be a row of integers, not {array.dtype} of {array.shape}")
    if array.size and array.min() < 0:
        raise UsageError(f"labels count from 0; element {np.argmin(array)} has {array.min()}")
    return array.astype(np.int64)
