"""The data of PLY files: the rows of every element, in text and in both byte orders.

Everything that the header announces is decoded without knowing what it means;
:mod:`moseg_core.io.read.ply` makes a shape or labels of it.

Rows with lists have no fixed size. Mostly all lists turn out as long as those of the first row,
and then one structured array over the whole element decodes it; else a walk over the rows finds
where each value lies, and the values are gathered in bulk.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from moseg_core.errors import ShapeError
from moseg_core.io.read.checked import file_error, quoted
from moseg_core.io.read.ply_header import PlyElement, PlyHeader, PlyProperty
from moseg_core.io.read.text_rows import Row, floats, integers, line_of_item, text_rows
from moseg_core.types import IntArray

Numbers: TypeAlias = npt.NDArray[np.generic]


@dataclass(frozen=True, eq=False)
class PlyLists:
    """The lists of one property: that of row ``r`` is ``values[offsets[r]:offsets[r + 1]]``."""

    values: Numbers
    offsets: IntArray


PlyColumns: TypeAlias = dict[str, Numbers | PlyLists]


def read_elements(path: Path, data: bytes, header: PlyHeader) -> dict[str, PlyColumns]:
    """The rows of all elements; :func:`decode_elements` also tells what was passed over."""
    return decode_elements(path, data, header)[0]


def decode_elements(
    path: Path, data: bytes, header: PlyHeader
) -> tuple[dict[str, PlyColumns], list[str]]:
    """Decode the rows of all elements.

    Parameters
    ----------
    path : Path
        For messages.
    data : bytes
        The whole file.
    header : PlyHeader

    Returns
    -------
    columns : dict of dict
        For each element, for each property an array of the rows' numbers, or their lists.
    notes : list of str
        That bytes behind the data were passed over: fewer than a row takes, or zeros.

    Raises
    ------
    ShapeError
        There are fewer or more data than the header announces, or words that are not numbers.
    """
    if header.order == "":
        return _text_elements(path, data[header.size :], header), []
    columns: dict[str, PlyColumns] = {}
    position = header.size
    for element in header.elements:
        columns[element.name], position = _binary_element(
            path, data, position, element, header.order
        )
    over = data[position:]
    if not over.strip():
        return columns, []
    if header.elements and (len(over) < _least(header.elements[-1]) or not over.strip(b"\0")):
        return columns, [f"bytes behind the data: {len(over)}; passed over"]
    raise file_error(
        path,
        f"holds more than its header announces (bytes over: {len(over)});"
        " it is damaged, export it again",
    )


def _least(element: PlyElement) -> int:
    """How many bytes a row takes, its lists empty; 0 where it has none."""
    return sum(np.dtype(p.length or p.item).itemsize for p in element.properties)


def _too_little(element: PlyElement, row: int) -> str:
    return (
        f"ends after {row} of {element.count} rows of the element {quoted(element.name)};"
        " it is cut off, export it again"
    )


def _text_elements(path: Path, body: bytes, header: PlyHeader) -> dict[str, PlyColumns]:
    rows, lines = text_rows(body, comment=None)
    columns: dict[str, PlyColumns] = {}
    start = 0
    for element in header.elements:
        # A row without properties is a line without words.
        stop = start + element.count if element.properties else start
        if stop > len(rows):
            raise file_error(path, _too_little(element, len(rows) - start))
        numbered = [line + header.lines for line in lines[start:stop]]
        columns[element.name] = _text_element(path, element, rows[start:stop], numbered)
        start = stop
    if start < len(rows):
        raise file_error(
            path,
            f"there is more than the header announces (lines over: {len(rows) - start});"
            " the file is damaged, export it again",
            line=lines[start] + header.lines,
        )
    return columns


def _text_element(path: Path, element: PlyElement, rows: list[Row], lines: list[int]) -> PlyColumns:
    """Pick each row apart, property by property, and convert what belongs together."""
    place = [0] * len(rows)  # the next word of each row
    columns: PlyColumns = {}

    def refuse(index: int) -> ShapeError:
        what = f"the row of {quoted(element.name)} holds {len(rows[index])} numbers"
        return file_error(
            path, f"{what}, which is not what its header says; it is damaged", line=lines[index]
        )

    def take(sizes: list[int]) -> list[bytes]:
        taken: list[bytes] = []
        for index, (row, size) in enumerate(zip(rows, sizes, strict=True)):
            start = place[index]
            stop = start + size
            if stop > len(row) or size < 0:
                raise refuse(index)
            taken += row[start:stop]
            place[index] = stop
        return taken

    ones = [1] * len(rows)
    for declared in element.properties:
        convert = floats if declared.item[0] == "f" else integers
        if declared.length is None:
            columns[declared.name] = convert(path, take(ones), lambda i: lines[i])
            continue
        sizes = integers(path, take(ones), lambda i: lines[i])
        offsets = np.concatenate([[0], np.cumsum(sizes)])
        values = convert(path, take(sizes.tolist()), line_of_item(offsets, lines))
        columns[declared.name] = PlyLists(values, offsets)
    for index, row in enumerate(rows):
        if place[index] != len(row):
            raise refuse(index)
    return columns


def _binary_element(
    path: Path, data: bytes, position: int, element: PlyElement, order: str
) -> tuple[PlyColumns, int]:
    """Decode one element; also where the next begins."""
    if not element.properties:
        return {}, position
    least = _least(element)
    if element.count * least > len(data) - position:
        raise file_error(path, _too_little(element, (len(data) - position) // least))
    uniform = _uniform_element(data, position, element, order)
    if uniform is not None:
        return uniform
    return _ragged_element(path, data, position, element, order)


def _uniform_element(
    data: bytes, position: int, element: PlyElement, order: str
) -> tuple[PlyColumns, int] | None:
    """Decode an element whose lists are as long as in its first row; None where they are not."""
    fields: list[tuple[str, str, int | tuple[int]]] = []
    at = position
    for k, declared in enumerate(element.properties):
        size = 1
        if declared.length is not None:
            length = np.dtype(order + declared.length)
            if at + length.itemsize > len(data):
                return None
            size = int(np.frombuffer(data, length, 1, at)[0]) if element.count else 0
            if size < 0:
                return None
            fields.append((f"length{k}", length.str, 1))
            at += length.itemsize
        item = np.dtype(order + declared.item)
        at += item.itemsize * size
        if at > len(data):
            return None
        fields.append((f"item{k}", item.str, (size,)))
    row = np.dtype(fields)
    if row.itemsize * element.count > len(data) - position:
        return None
    table = np.frombuffer(data, row, element.count, position)
    columns: PlyColumns = {}
    for k, declared in enumerate(element.properties):
        values = table[f"item{k}"]
        if declared.length is None:
            columns[declared.name] = values[:, 0]
            continue
        size = values.shape[1]
        if (table[f"length{k}"] != size).any():
            return None
        offsets = np.arange(element.count + 1, dtype=np.int64) * size
        columns[declared.name] = PlyLists(values.reshape(-1), offsets)
    return columns, position + row.itemsize * element.count


def _ragged_element(
    path: Path, data: bytes, position: int, element: PlyElement, order: str
) -> tuple[PlyColumns, int]:
    """Decode an element row by row: first where everything lies, then the values at once."""
    starts: list[list[int]] = [[] for _ in element.properties]
    sizes: list[list[int]] = [[] for _ in element.properties]
    steps = [
        (_length_type(p), np.dtype(p.item).itemsize, starts[k].append, sizes[k].append)
        for k, p in enumerate(element.properties)
    ]
    byteorder: Literal["little", "big"] = "little" if order == "<" else "big"
    at, end = position, len(data)
    for row in range(element.count):
        for (width, signed), itemsize, put_start, put_size in steps:
            size = 1
            if width:
                size = int.from_bytes(data[at : at + width], byteorder, signed=signed)
                at += width
                if size < 0:
                    what = f"has a list of {size} items in row {row} of {quoted(element.name)}"
                    raise file_error(path, f"{what}; it is damaged, export it again")
            put_start(at)
            put_size(size)
            at += size * itemsize
            if at > end:
                raise file_error(path, _too_little(element, row))
    columns: PlyColumns = {}
    for k, declared in enumerate(element.properties):
        counts = np.array(sizes[k], np.int64)
        lists = _gathered(data, np.array(starts[k], np.int64), counts, order + declared.item)
        columns[declared.name] = lists.values if declared.length is None else lists
    return columns, at


def _length_type(declared: PlyProperty) -> tuple[int, bool]:
    """How many bytes the length of a list takes (none for a number), and whether it has a sign."""
    if declared.length is None:
        return 0, False
    return np.dtype(declared.length).itemsize, declared.length[0] == "i"


def _gathered(data: bytes, starts: IntArray, counts: IntArray, item: str) -> PlyLists:
    """The lists that begin at the given bytes and hold so many items each."""
    itemsize = np.dtype(item).itemsize
    offsets = np.concatenate([[0], np.cumsum(counts)])
    within = np.arange(offsets[-1]) - np.repeat(offsets[:-1], counts)
    first = np.repeat(starts, counts) + within * itemsize
    raw = np.frombuffer(data, np.uint8)
    values = raw[first[:, None] + np.arange(itemsize)].reshape(-1).view(item)
    return PlyLists(values, offsets)
