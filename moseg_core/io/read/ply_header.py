"""The headers of PLY files, which say what the data behind them are.

A PLY file describes itself: its header names elements ("vertex", "face", or anything), how many
rows each has, and the properties of a row, each a number or a list of numbers with its length in
front. :mod:`moseg_core.io.read.ply_elements` decodes the data by such a header.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from moseg_core.io.read.checked import file_error, quoted
from moseg_core.io.read.text_rows import word

_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "int64": "i8", "uint64": "u8",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
_DIGITS = re.compile(r"[0-9]{1,18}")
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
# What parts words: no other blank of Unicode, which would be part of a name.
_BLANKS = " \t\r\n\v\f"
_WORD = re.compile(f"[^{_BLANKS}]+")
# A header is a few hundred bytes; a longer one means that there is no end to it.
_LONGEST_HEADER = 1 << 20


@dataclass(frozen=True, kw_only=True)
class PlyProperty:
    """One property of an element.

    Parameters
    ----------
    name : str
    item : str
        numpy code of the values, without byte order: "f4", "i4".
    length : str or None
        numpy code of the length in front of a list; None where the property is one number.
    """

    name: str
    item: str
    length: str | None = None


@dataclass(frozen=True, kw_only=True)
class PlyElement:
    """An element as the header announces it: its name, number of rows and properties."""

    name: str
    count: int
    properties: tuple[PlyProperty, ...]


@dataclass(frozen=True, kw_only=True)
class PlyHeader:
    """What stands before the data.

    Parameters
    ----------
    order : str
        "" for text, "<" or ">" for binary data of that byte order.
    elements : tuple of PlyElement
        In the order of their data.
    comments : tuple of str
        The comment lines, without the word "comment".
    size, lines : int
        How many bytes and lines the header takes.
    """

    order: str
    elements: tuple[PlyElement, ...]
    comments: tuple[str, ...]
    size: int
    lines: int


def parse_header(path: Path, data: bytes) -> PlyHeader:
    r"""Read the header at the beginning of a file's bytes.

    Parameters
    ----------
    path : Path
        For messages.
    data : bytes

    Raises
    ------
    ShapeError
        It is not the header of a PLY file, or is malformed; says on which line.

    Examples
    --------
    >>> text = b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n0\n1\n"
    >>> header = parse_header(Path("a.ply"), text)
    >>> header.elements[0].name, header.elements[0].count, header.lines
    ('vertex', 2, 5)
    """
    rows, size = _header_rows(path, data)
    order: str | None = None
    announced: list[tuple[str, int, dict[str, PlyProperty]]] = []
    comments: list[str] = []
    for line, text in enumerate(rows[1:-1], 2):
        words = _WORD.findall(text)
        match words:
            case ["format", kind, _] if kind in _ORDERS:
                order = _ORDERS[kind]
            case ["element", name, count] if _DIGITS.fullmatch(count):
                announced.append((name, int(count), {}))
            case ["property", *declared] if announced:
                found = _property(path, declared, line)
                known = announced[-1][2]
                if found.name in known:
                    raise file_error(path, f"property {quoted(found.name)} is repeated", line=line)
                known[found.name] = found
            case ["comment" | "obj_info", *_]:
                comments.append(text.partition(" ")[2])
            case []:
                pass
            case _:
                what = f"{word(text.encode())} is not understood in a PLY header"
                raise file_error(path, f"{what}; the file is damaged, export it again", line=line)
    if order is None:
        raise file_error(path, "names no format in its header; it is damaged, export it again")
    if len({name for name, _, _ in announced}) < len(announced):
        raise file_error(path, "announces an element twice in its header; it is damaged")
    return PlyHeader(
        order=order,
        elements=tuple(
            PlyElement(name=name, count=count, properties=tuple(known.values()))
            for name, count, known in announced
        ),
        comments=tuple(comments),
        size=size,
        lines=len(rows),
    )


def _header_rows(path: Path, data: bytes) -> tuple[list[str], int]:
    """The lines of the header, "ply" to "end_header", and its size in bytes."""
    if data[:3] != b"ply" or data[3:4] not in (b"\n", b"\r", b" "):
        raise file_error(
            path, f"begins with {word(data[:12])} instead of 'ply'; it is not a PLY file"
        )
    head = data[:_LONGEST_HEADER]
    # Old files end lines in CR alone; binary data begin right behind the last terminator.
    feed, back = head.find(b"\n"), head.find(b"\r")
    end = b"\r" if back >= 0 and (feed < 0 or feed > back + 1) else b"\n"
    rows: list[str] = []
    start = 0
    while (stop := head.find(end, start)) >= 0:
        rows.append(head[start:stop].decode("utf-8", "replace").strip(_BLANKS))
        start = stop + 1
        if rows[-1] == "end_header":
            return rows, start
    # Without any data behind it, a header may lack the end of its last line.
    if head[start:].strip() == b"end_header":
        return [*rows, "end_header"], len(head)
    raise file_error(path, "has no 'end_header'; it is cut off, export it again")


def _property(path: Path, declared: list[str], line: int) -> PlyProperty:
    match declared:
        case ["list", length, item, name] if _TYPES.get(length, "f")[0] in "iu" and item in _TYPES:
            return PlyProperty(name=name, item=_TYPES[item], length=_TYPES[length])
        case [item, name] if item in _TYPES:
            return PlyProperty(name=name, item=_TYPES[item])
    raise file_error(
        path,
        f"{word(' '.join(declared).encode())} is not a property moseg can read;"
        f" types: {', '.join(sorted(_TYPES))}",
        line=line,
    )
