r"""Labels from text files: which of the forms of text a file has.

Its suffix says nothing, ``.txt`` least of all. What names and lines of ids take turns in has
:mod:`named lines <moseg_core.io.labels.named_lines>`; what begins with a bracket is JSON;
everything else is :mod:`columns <moseg_core.io.labels.columns>`.
"""

from __future__ import annotations

from pathlib import Path

from moseg_core.io.labels.columns import COMMENTS, read_columns
from moseg_core.io.labels.json_forms import read_json
from moseg_core.io.labels.listing import Listing, Wanted
from moseg_core.io.labels.named_lines import FACE_ID, are_named_lines, read_named_lines
from moseg_core.io.read.checked import file_error, read_file
from moseg_core.io.read.text_rows import word


def read_text(path: Path, wanted: Wanted) -> Listing:
    r"""Read labels from a text file.

    Parameters
    ----------
    path : Path
    wanted : Wanted

    Raises
    ------
    ShapeError
        The file cannot be read, is not text in UTF-8, or has none of the forms; says where.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "a.txt"
    ...     _ = file.write_text("1\n0\n1\n")
    ...     read_text(file, Wanted(n_elements=3)).labels.tolist()
    [1, 0, 1]
    """
    text = _decoded(path, read_file(path))
    if FACE_ID.match(text.lstrip()):  # no name stands in front
        return read_columns(path, text, wanted)
    if are_named_lines(text):
        return read_named_lines(path, text, wanted)
    if text.lstrip()[:1] in ("[", "{"):
        return read_json(path, wanted)
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    # A name in front, ids further down, and not under the heads of columns: named lines, with
    # something wrong in them.
    ids = [FACE_ID.match(line) is not None for line in lines]
    if lines and not ids[0] and any(ids) and not _is_table(lines):
        return read_named_lines(path, text, wanted)
    return read_columns(path, text, wanted)


def _is_table(lines: list[str]) -> bool:
    """Whether there are as many words on each line as on the first, or cells with signs between."""
    if any(mark in line for line in lines[:2] for mark in ",;\t"):
        return True
    if lines[0].startswith(COMMENTS):
        return True
    return len(lines) > 2 and len({len(line.split()) for line in lines}) == 1


def _decoded(path: Path, data: bytes) -> str:
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if data.startswith(mark):  # what Windows calls Unicode
            return data.decode(encoding, "replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raw = data.splitlines()[line - 1]
        raise file_error(
            path, f"{word(raw)} is not UTF-8; save the file as such", line=line
        ) from error
