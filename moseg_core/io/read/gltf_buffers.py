"""Buffers of a glTF file that are not its binary chunk: within its text, or in files beside it.

The address of a buffer is a URI: ``data:`` holds the bytes themselves; a relative one names a file,
its unusual letters written as ``%20``. A document is not trusted to name any file: it gets those in
its own folder and the folders within, wherever links lead, and nothing over a network.
"""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import MutableMapping
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from moseg_core.io.read.checked import file_error, quoted

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


def read_buffer(
    path: Path, uri: object, length: int, kept: MutableMapping[Path, bytes] | None = None
) -> bytes:
    r"""The bytes at the address of a buffer.

    Parameters
    ----------
    path : Path
        The file that names the address.
    uri : object
        As it stands in the document; checked.
    length : int
        How many bytes the document announces.
    kept : mutable mapping of Path to bytes, optional
        Files that were read already: buffers may lie in one file, and a document may say so of any
        number of them.

    Returns
    -------
    bytes
        The first `length`; what follows is padding.

    Raises
    ------
    ShapeError
        The address is none that is followed, or leads out of the folder of the file, or there are
        fewer bytes.

    Examples
    --------
    >>> read_buffer(Path("a.gltf"), "data:application/octet-stream;base64,AAEC", 2)
    b'\x00\x01'
    """
    if not isinstance(uri, str):
        raise file_error(path, "is damaged: the uri of a buffer must be text; export it again")
    if uri[:5].lower() == "data:":
        data, what = _written_out(path, uri), "its text"
    else:
        data, what = _beside(path, uri, length, {} if kept is None else kept), quoted(uri)
    if len(data) < length:
        raise file_error(
            path, f"announces {length} bytes in {what}, where there are {len(data)}; it is cut off"
        )
    return data[:length]


def _written_out(path: Path, uri: str) -> bytes:
    """The bytes of a ``data:`` URI."""
    head, comma, body = uri.partition(",")
    if not comma:
        raise file_error(path, "is damaged: a data URI without a comma; export it again")
    raw = unquote_to_bytes(body)
    if not head.lower().endswith(";base64"):
        return raw
    try:
        return base64.b64decode(raw + b"=" * (-len(raw) % 4), validate=True)
    except binascii.Error as error:
        raise file_error(path, f"has damaged base64 data ({error}); export it again") from error


def _beside(path: Path, uri: str, length: int, kept: MutableMapping[Path, bytes]) -> bytes:
    """The bytes of a file in the folder of the document."""
    name = unquote(uri)
    folder = path.parent.resolve()
    try:
        place = (folder / name).resolve()
        inside = place.is_relative_to(folder)
    except (OSError, ValueError, RuntimeError):  # a NUL in the name, links in a circle
        inside = False
    if _SCHEME.match(uri) or "\\" in name or not inside:
        raise file_error(
            path,
            f"keeps its data in {quoted(uri)}, out of its folder; put it beside the file, or export"
            " one self-contained .glb",
        )
    if not place.is_file():
        raise file_error(
            path,
            f"keeps its data in {quoted(uri)}, which is not there; put it beside the file, or"
            " export one self-contained .glb",
        )
    if len(kept.get(place, b"")) >= length > 0:
        return kept[place]
    try:
        with place.open("rb") as file:
            kept[place] = file.read(length)
            return kept[place]
    except OSError as error:
        raise file_error(path, f"keeps its data in {quoted(uri)}: {error.strerror}") from error
