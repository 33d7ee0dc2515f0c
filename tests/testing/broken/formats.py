"""Readers and writers that are broken in one way each."""

from __future__ import annotations

import itertools
import json

import numpy as np

from moseg_core.components.discovery.specs import ReaderSpec, WriterSpec
from moseg_core.errors import ShapeError, UsageError
from moseg_core.shape.shape import Shape

HOME = "tests.testing.broken.formats"


def _reader(name):
    return ReaderSpec(
        name="broken", target=f"{HOME}:{name}", suffixes=(".pts",), example=f"{HOME}:example"
    )


def _writer(name):
    return WriterSpec(name="broken", target=f"{HOME}:{name}", suffixes=(".pts",))


BROKEN = {
    "reader-reads-its-example": _reader("read_once"),
    "reader-refuses-what-is-none": _reader("read_trusting"),
    "reader-survives-cut-files": _reader("read_by_count"),
    "reader-reads-what-is-written": _reader("read_hundred"),
    "writer-returns-bytes": _writer("write_text"),
    "writer-repeats": _writer("write_numbered"),
}
SOUND = {"reader": _reader("read_points"), "writer": _writer("write_points")}


def example(suffix):
    """Four points, counted."""
    return b"4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"


def text_example(suffix):
    """Four points, not encoded."""
    return example(suffix).decode()


def _rows(path):
    try:
        text = path.read_text()
        count = int(text.split("\n", 1)[0])
        rows = [[float(word) for word in line.split()] for line in text.split("\n")[1:] if line]
    except ValueError as error:
        raise ShapeError(f"'{path}' is no list of points: {error}") from error
    return count, rows


def read_points(path):
    """Points, counted."""
    count, rows = _rows(path)
    if len(rows) != count or {len(row) for row in rows} != {3}:
        raise ShapeError(f"'{path}' does not have {count} rows of three numbers")
    return Shape.from_points(rows, areas=np.ones(count))


_READ = itertools.count(1)


def read_once(path):
    """Each file is larger than the one before."""
    shape = read_points(path)
    return Shape.from_points(shape.points * next(_READ), areas=shape.areas)


def read_trusting(path):
    """It looks for the count where there need be none."""
    if not path.read_bytes().isascii():
        raise ShapeError(f"'{path}' is no text")
    if not path.read_text()[0].isdigit():
        raise ShapeError(f"'{path}' does not begin with a count")
    return read_points(path)


def read_by_count(path):
    """It takes as many rows as the count says."""
    count, rows = _rows(path)
    return Shape.from_points([rows[k][:3] for k in range(count)], areas=np.ones(count))


def read_hundred(path):
    """It reads its own example, and a hundred points of what its bundle writes."""
    shape = read_points(path)
    return Shape.from_points(shape.points[:100], areas=shape.areas[:100])


def write_points(result):
    """Points, counted."""
    rows = [" ".join(f"{x:.17g}" for x in point) for point in result.shape.points]
    return "\n".join([f"{len(rows)}", *rows, ""]).encode()


def write_text(result):
    """A text, which is no bytes."""
    return write_points(result).decode()


_WRITTEN = itertools.count()


def write_numbered(result):
    """Each file has a number."""
    return json.dumps({"number": next(_WRITTEN), "labels": result.labels.tolist()}).encode()


def write_beyond(result, *, name):
    """A file beside, in a folder above."""
    return {name: b"", "../secret.txt": b""}


def write_nothing(result):
    """It refuses everything."""
    raise UsageError("not today")


def write_crashing(result):
    """It is about meshes only, and does not say so."""
    return result.shape.geometry.faces[0].tobytes()
