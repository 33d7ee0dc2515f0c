"""Labels to files of the two simplest forms, which need no result: ``.seg`` and ``.txt``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from moseg_core.errors import UsageError
from moseg_core.io.labels.named_lines import FACE_ID
from moseg_core.io.whole_file import write_file
from moseg_core.types import UNLABELLED, IntArray


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
        From 0; -1 for elements without one, which a ``.txt`` file leaves out.
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
    ...     file.read_text().splitlines()
    ['body', '1 3', 'handle', '2']
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
        From 0, or -1.

    Raises
    ------
    UsageError
        Labels that are not a row of integers from 0, or -1.

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
        From 0, indices into `names`; faces of label -1 are left out.
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
        if not name or name != name.strip() or len(name.splitlines()) > 1 or FACE_ID.match(name):
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
    if array.size and array.min() < UNLABELLED:
        raise UsageError(f"labels count from 0; element {np.argmin(array)} has {array.min()}")
    return array.astype(np.int64)
