"""Packed values, unpacked as far as a header announces them and no further.

A kilobyte of gzip can stand for a megabyte, of bzip2 for far more, and a header may lie about it
either way. So a stream is unpacked piece by piece, until there is as much as was announced; where
more follows than a program may leave behind its values, the file is refused.
"""

from __future__ import annotations

import bz2
import gzip
import io
import zlib
from pathlib import Path
from typing import Any, Literal

from moseg_core import ReadLimits, ShapeError

_PIECE = 2**20
_BEHIND = 2**16
"""Bytes that may follow the values; what they say is passed over."""


def unpacked(
    path: Path,
    data: bytes,
    packing: Literal["gzip", "bzip2"],
    *,
    announced: int,
    limits: ReadLimits,
) -> io.BytesIO:
    """Unpack what a header announces.

    Parameters
    ----------
    path : Path
        For messages.
    data : bytes
        Packed.
    packing : {"gzip", "bzip2"}
    announced : int
        Bytes that there should be, headers included.
    limits : ReadLimits

    Returns
    -------
    io.BytesIO
        At its beginning; with fewer bytes than announced where the stream ends before.

    Raises
    ------
    ShapeError
        The stream is cut off or damaged, announces more than the limits allow, or goes on.

    Examples
    --------
    >>> packed = gzip.compress(b"abc")
    >>> unpacked(Path("x"), packed, "gzip", announced=3, limits=ReadLimits()).read()
    b'abc'
    """
    limits.refuse_unpacked(path, announced, size=len(data))
    whole = io.BytesIO()
    try:
        with opened(data, packing) as stream:
            while whole.tell() <= announced + _BEHIND and (piece := stream.read(_PIECE)):
                whole.write(piece)
    except (OSError, EOFError, zlib.error) as error:
        raise ShapeError(f"{path.name} cannot be unzipped ({error}); copy it anew") from error
    if whole.tell() > announced + _BEHIND:
        raise ShapeError(
            f"{path.name} unpacks to more than the {announced:,} bytes that its header announces;"
            " it is damaged"
        )
    whole.seek(0)
    return whole


def opened(data: bytes, packing: Literal["gzip", "bzip2"]) -> Any:
    """A stream of what packed bytes stand for."""
    packed = io.BytesIO(data)
    return gzip.GzipFile(fileobj=packed) if packing == "gzip" else bz2.BZ2File(packed)
